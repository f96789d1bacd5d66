#pragma once

#include <atomic>

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

 private:
  void (*before_)(int);
};

}  // namespace accdec::cli
