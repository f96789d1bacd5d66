#pragma once

#include <atomic>
#include <functional>
#include <string>

#include "bindings.hpp"

namespace accdec::python {

/// The stop flag and the progress function of a long computation.
struct Work {
  const std::atomic<bool>& cancelled;                   ///< set by Ctrl-C, or by an exception from `progress`
  const std::function<void(const std::string&)>& tell;  ///< a line for `progress`; from any thread
};

/// Runs `work` beside the calling thread, without the GIL, so that other Python threads go on. The calling thread
/// looks for signals 50 times a second and hands lines to `progress` (a callable, or None): Python code runs there
/// and nowhere else. Must be called with the GIL.
///
/// Some libraries look at `cancelled` only after seconds. So a cancelled call returns within 0.1 s, whatever `work`
/// does. `work` then ends by itself and its result is ignored. The interpreter waits for it when it exits, unless a
/// second Ctrl-C ends that wait.
/// @param work  owns all it refers to
/// @throws what `work` threw; KeyboardInterrupt, or whatever a signal's handler or `progress` raised.
void run_interruptibly(const std::function<void(const Work&)>& work, const py::object& progress);

}  // namespace accdec::python
