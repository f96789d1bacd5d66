#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>

#include <pthread.h>

namespace accdec::solvers {

/// Runs a library call that may loop for ever between two callbacks, as COBYLA does because of rounding. There, neither
/// the library's own limits nor the evaluator can stop it. The call runs in its own thread. The thread is cancelled
/// when the time limit has passed, or cancellation was requested, and no callback has come for `patience`. Memory that
/// the library had allocated by then is lost.
class WatchedCall {
 public:
  static constexpr std::chrono::milliseconds patience{500};

  /// While an object of this class lives on the call's thread, the thread is not cancelled. Every callback needs one,
  /// around our own code.
  class Callback {
   public:
    explicit Callback(WatchedCall* call) : call_(call) {
      if (call_ == nullptr) return;
      pthread_setcancelstate(PTHREAD_CANCEL_DISABLE, &before_);
      call_->callbacks_.fetch_add(1, std::memory_order_relaxed);
    }
    ~Callback() {
      if (call_ != nullptr) pthread_setcancelstate(before_, nullptr);
    }
    Callback(const Callback&) = delete;
    Callback& operator=(const Callback&) = delete;

   private:
    WatchedCall* call_;
    int before_ = PTHREAD_CANCEL_ENABLE;
  };

  /// @param call  plain C below: its frames are unwound wherever they are. Must not throw.
  /// @param time_limit  s
  /// @return whether the call ended by itself
  /// @throws std::system_error if no thread can be had
  bool run(const std::function<void()>& call, double time_limit, const std::atomic<bool>* cancel);

 private:
  static void* enter(void* self);
  const std::function<void()>* call_ = nullptr;
  std::atomic<std::int64_t> callbacks_{0};
  std::mutex mutex_;
  std::condition_variable ended_;
  bool done_ = false;  // under the mutex
};

}  // namespace accdec::solvers
