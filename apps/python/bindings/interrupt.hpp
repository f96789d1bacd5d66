#pragma once

#include <atomic>
#include <functional>
#include <string>

#include "bindings.hpp"

namespace accdec::python {

/// What a long computation gets to know and to say.
struct Work {
  const std::atomic<bool>& cancelled;                   ///< set by Ctrl-C, or by an exception from `progress`
  const std::function<void(const std::string&)>& tell;  ///< a line for `progress`; from any thread
};

/// What becomes of a computation that is cancelled.
enum class WhenCancelled {
  wait,  ///< it looks at `cancelled` often and ends: it may refer to what the caller owns
  leave  ///< it may take seconds to notice: the call returns within 0.1 s and the computation ends by itself, unheard.
         ///< It must own all it refers to. The interpreter waits for it when it exits; a second Ctrl-C ends that.
};

/// Runs `work` beside the calling thread, without the GIL, so that other Python threads go on. The calling thread
/// looks for signals 50 times a second and hands lines to `progress` (a callable, or None): Python code runs there
/// and nowhere else. Must be called with the GIL.
/// @throws what `work` threw; KeyboardInterrupt, or whatever a signal's handler or `progress` raised.
void run_interruptibly(const std::function<void(const Work&)>& work, const py::object& progress,
                       WhenCancelled when_cancelled = WhenCancelled::wait);

}  // namespace accdec::python
