#pragma once

#include <atomic>
#include <functional>
#include <span>
#include <string>

#include "page.hpp"
#include "requests.hpp"

namespace accdec::explore {

/// The page, and who answers it.
struct Served {
  const std::string& start;         ///< what GET start answers, JSON
  std::span<const PageFile> files;  ///< of the page
  Answer (*answer)(const Question&);
};

/// Serves the page on a free port of 127.0.0.1 until its last window has been closed for a few seconds, or `stop`.
///
/// Every request needs the random token of the address, the Host that the page was opened with and, where the browser
/// names an origin, this one. Nothing is read from or written to any file. A question of the same kind from the same
/// page cancels the one before.
///
/// It stands in a module of its own, accdec-explore.so: binding the HTTP library takes 2 ms, and other commands do
/// without.
/// @param ready  called with the address as soon as it answers
/// @throws std::runtime_error if there is no port or no random number
extern "C" void accdec_explore_serve(const Served& served, const std::function<void(const std::string& address)>& ready,
                                     const std::atomic<bool>& stop);

/// The version of the HTTP library. It stands in the same module.
extern "C" const char* accdec_explore_http_version();

}  // namespace accdec::explore
