#pragma once

#include <atomic>
#include <string>

namespace accdec::cli {

/// While it lives, the first Ctrl-C asks for what has been found so far, the second ends the program. One at a time.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  /// Whether there was one: what a search polls.
  static const std::atomic<bool>& asked();
};

/// While it lives, a signal that ends the program says what is kept of a study or comparison and how it goes on.
class InterruptNote {
 public:
  /// @param units  what is computed one by one: "points"  @param fresh  whether all are computed again
  InterruptNote(const std::string& folder, const char* units, bool fresh, bool quiet);
  ~InterruptNote();
  InterruptNote(const InterruptNote&) = delete;
  InterruptNote& operator=(const InterruptNote&) = delete;
};

}  // namespace accdec::cli
