#include <system_error>

#include <accdec/solvers/watched_call.hpp>

namespace accdec::solvers {

void* WatchedCall::enter(void* self) {
  auto& watched = *static_cast<WatchedCall*>(self);
  // A loop without callbacks has no cancellation point. Only a thread that was silent for a while is cancelled, so no
  // allocation is interrupted.
  pthread_setcanceltype(PTHREAD_CANCEL_ASYNCHRONOUS, nullptr);
  (*watched.call_)();
  pthread_setcancelstate(PTHREAD_CANCEL_DISABLE, nullptr);
  const std::lock_guard lock(watched.mutex_);
  watched.done_ = true;
  watched.ended_.notify_one();
  return nullptr;
}

bool WatchedCall::run(const std::function<void()>& call, double time_limit, const std::atomic<bool>* cancel) {
  using Clock = std::chrono::steady_clock;
  call_ = &call;
  pthread_t thread{};
  if (const int error = pthread_create(&thread, nullptr, enter, this); error != 0) {
    throw std::system_error(error, std::generic_category(), "thread for a solver");
  }
  const Clock::time_point began = Clock::now();
  Clock::time_point heard = began;
  std::int64_t callbacks = 0;
  std::unique_lock lock(mutex_);
  // The end is noticed at once, so the polling interval adds nothing to the time of a solve.
  while (!ended_.wait_for(lock, std::chrono::milliseconds(5), [this] { return done_; })) {
    const Clock::time_point now = Clock::now();
    if (const std::int64_t count = callbacks_.load(std::memory_order_relaxed); count != callbacks) {
      callbacks = count;
      heard = now;
    }
    const bool over =
        std::chrono::duration<double>(now - began).count() > time_limit || (cancel != nullptr && cancel->load());
    if (over && now - heard > patience) {
      pthread_cancel(thread);
      break;
    }
  }
  lock.unlock();
  void* ending = nullptr;
  pthread_join(thread, &ending);
  return ending != PTHREAD_CANCELED;
}

}  // namespace accdec::solvers
