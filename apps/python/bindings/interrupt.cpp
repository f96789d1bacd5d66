#include "interrupt.hpp"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace accdec::python {
namespace {

constexpr std::chrono::milliseconds look_every{20};

/// What both threads share.
struct Shared {
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<std::string> lines;
  bool done = false;
  std::exception_ptr thrown;
  std::atomic<bool> cancelled{false};
};

void carry_out(const std::function<void(const Work&)>& work, Shared& shared) {
  const std::function<void(const std::string&)> tell = [&](const std::string& line) {
    const std::lock_guard lock(shared.mutex);
    shared.lines.push_back(line);
    shared.changed.notify_one();
  };
  std::exception_ptr thrown;
  try {
    work({shared.cancelled, tell});
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

}  // namespace

void run_interruptibly(const std::function<void(const Work&)>& work, const py::object& progress) {
  Shared shared;
  std::exception_ptr raised;  // by Python code
  std::thread worker(carry_out, std::cref(work), std::ref(shared));
  for (bool done = false; !done;) {
    auto [lines, ended] = look(shared);
    done = ended;
    if (raised) continue;
    try {
      if (!progress.is_none()) {
        for (const std::string& line : lines) progress(line);
      }
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    } catch (...) {
      raised = std::current_exception();
      shared.cancelled = true;
    }
  }
  {
    const py::gil_scoped_release release;
    worker.join();
  }
  if (raised) std::rethrow_exception(raised);
  if (shared.thrown) std::rethrow_exception(shared.thrown);
}

}  // namespace accdec::python
