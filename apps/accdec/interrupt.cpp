#include "interrupt.hpp"

#include <csignal>

namespace accdec::cli {
namespace {

std::atomic<bool> interrupted{false};

extern "C" void ask_to_stop(int) {
  interrupted.store(true);
  std::signal(SIGINT, SIG_DFL);
}

}  // namespace

Interrupt::Interrupt() : before_(std::signal(SIGINT, ask_to_stop)) {}
Interrupt::~Interrupt() {
  std::signal(SIGINT, before_);
}
const std::atomic<bool>& Interrupt::asked() {
  return interrupted;
}

}  // namespace accdec::cli
