#include "interruptible_plan.hpp"

#include <cstdio>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "interrupt.hpp"
#include "status_line.hpp"

namespace accdec::cli {

ProgramResult interruptible_plan(const ProgramFileOptions& options, bool quiet, ProgramFile file, const Task& task) {
  const Interrupt interrupt;
  std::optional<StatusLine> status;
  status.emplace(quiet, StatusLine::Lines::none, options.time_limit.value_or(0.0));
  std::string last, far;
  ProgramFileOptions asked = options;
  asked.deadline.end_when(Interrupt::asked());
  asked.free.progress = [&](const FreeProgress& at) {
    if (Interrupt::asked() && at.share == 0.0) return;  // stages that only end
    far = at.stage;
    if (at.share > 0.0 || at.gained > 0.0)
      far += fmt::format(", {:.0f} % done, {:.3f} s gained", 100.0 * at.share, at.gained);
    status->tell(far);
  };
  ProgramResult result = run_program_file(std::move(file), task, asked, [&](const std::string& line) {
    last = line;
    status->tell(line);
  });
  status.reset();
  const bool other = !result.plan.empty() && result.plan.name() != std::string("free");
  if (other && result.verification.feasible && !last.empty()) std::fprintf(stderr, "%s\n", last.c_str());
  if (Interrupt::asked() && result.verification.feasible) {
    fmt::print(stderr, "Ctrl-C ended the search during: {}. The answer is the best plan so far, plan {} of {:.4g} s\n",
               far, result.plan.name(), result.cycle_time);
  }
  return result;
}

}  // namespace accdec::cli
