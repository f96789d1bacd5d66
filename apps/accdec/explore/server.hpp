#pragma once

#include <atomic>
#include <functional>
#include <string>

namespace accdec::explore {

/// Serves the page on a free port of 127.0.0.1 until its last window has been closed for a few seconds, or `stop`.
///
/// Every request needs the random token of the address, the Host that the page was opened with and, where the browser
/// names an origin, this one. Nothing is read from or written to any file. A question of the same kind from the same
/// page cancels the one before.
/// @param start  what GET start answers, JSON
/// @param ready  called with the address as soon as it answers
/// @throws std::runtime_error if there is no port or no random number
void serve(const std::string& start, const std::function<void(const std::string& address)>& ready,
           const std::atomic<bool>& stop);

}  // namespace accdec::explore
