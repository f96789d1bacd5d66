#include "interrupt.hpp"

#include <csignal>

#include <fmt/format.h>

#include <accdec/files/shown_text.hpp>
#include <accdec/files/temporaries.hpp>

namespace accdec::cli {
namespace {

std::atomic<bool> interrupted{false};
void (*before)(int) = SIG_DFL;  // which removes temporaries

extern "C" void ask_to_stop(int) {
  interrupted.store(true);
  std::signal(SIGINT, before);
}

}  // namespace

Interrupt::Interrupt() {
  before = std::signal(SIGINT, ask_to_stop);
}
Interrupt::~Interrupt() {
  std::signal(SIGINT, before);
}
const std::atomic<bool>& Interrupt::asked() {
  return interrupted;
}

InterruptNote::InterruptNote(const std::string& folder, const char* units, bool fresh, bool quiet) {
  if (quiet) return;
  say_on_signals(
      fmt::format("\nstopped; the {} computed so far are kept in {}; the same command{} goes on with the rest\n", units,
                  printable(folder), fresh ? " without --fresh" : ""));
}
InterruptNote::~InterruptNote() {
  say_on_signals("");
}

}  // namespace accdec::cli
