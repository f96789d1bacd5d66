#include "interrupt.hpp"

#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace accdec::python {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds look_every{20}, leave_after{60};

/// State that both threads share and own together.
struct Shared {
  std::function<void(const Work&)> work;
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<std::string> lines;
  bool done = false;
  std::exception_ptr thrown;
  std::atomic<bool> cancelled{false};
};

/// Computations that nobody waits for any more.
std::atomic<int> left_running{0};

void carry_out(Shared& shared) {
  const std::function<void(const std::string&)> tell = [&](const std::string& line) {
    const std::lock_guard lock(shared.mutex);
    shared.lines.push_back(line);
    shared.changed.notify_one();
  };
  std::exception_ptr thrown;
  try {
    shared.work({shared.cancelled, tell});
  } catch (...) {
    thrown = std::current_exception();
  }
  const std::lock_guard lock(shared.mutex);
  shared.thrown = thrown;
  shared.done = true;
  shared.changed.notify_one();
}

/// The lines said since the last look, and whether all is done; waits for either, but not for long.
std::pair<std::vector<std::string>, bool> look(Shared& shared) {
  const py::gil_scoped_release release;
  std::unique_lock lock(shared.mutex);
  shared.changed.wait_for(lock, look_every, [&] { return shared.done || !shared.lines.empty(); });
  return {std::exchange(shared.lines, {}), shared.done};
}

/// Before the library's objects go: what was left must have ended.
void wait_for_what_was_left() {
  while (left_running > 0) {
    {
      const py::gil_scoped_release release;
      std::this_thread::sleep_for(look_every);
    }
    if (PyErr_CheckSignals() != 0) std::_Exit(130);
  }
}

void wait_at_exit() {
  static bool registered = false;
  if (registered) return;
  registered = true;
  py::module_::import("atexit").attr("register")(py::cpp_function(&wait_for_what_was_left));
}

void leave(std::thread worker, const std::shared_ptr<Shared>& shared) {
  wait_at_exit();
  ++left_running;
  worker.detach();
  std::thread([shared] {
    std::unique_lock lock(shared->mutex);
    shared->changed.wait(lock, [&] { return shared->done; });
    lock.unlock();
    shared->work = nullptr;
    --left_running;
  }).detach();
}

}  // namespace

void run_interruptibly(const std::function<void(const Work&)>& work, const py::object& progress) {
  const auto shared = std::make_shared<Shared>();
  shared->work = work;
  std::exception_ptr raised;  // by Python code
  Clock::time_point raised_at;
  std::thread worker([shared] { carry_out(*shared); });
  for (bool done = false; !done;) {
    auto [lines, ended] = look(*shared);
    done = ended;
    if (raised) {
      if (done || Clock::now() - raised_at < leave_after) continue;
      leave(std::move(worker), shared);
      std::rethrow_exception(raised);
    }
    try {
      if (!progress.is_none()) {
        for (const std::string& line : lines) progress(line);
      }
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    } catch (...) {
      raised = std::current_exception();
      raised_at = Clock::now();
      shared->cancelled = true;
    }
  }
  {
    const py::gil_scoped_release release;
    worker.join();
  }
  if (raised) std::rethrow_exception(raised);
  if (shared->thrown) std::rethrow_exception(shared->thrown);
}

}  // namespace accdec::python
