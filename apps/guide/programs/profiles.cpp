#include <cstdio>

#include <accdec/program.hpp>
#include <accdec/task.hpp>

int main() {
  using namespace accdec;
  const Task task = read_task("problems/program/mill.toml", {.require_corners = false});
  ProgramFileOptions options;
  options.plan = PlanKind::profiles;  // or one filter, if that is faster
  const ProgramFile read = read_program_file("problems/program/zigzag.ngc", task, options, {});
  const ProgramResult fastest = run_program_file(read, task, options, {});
  std::printf("%s: %.4f s\n", fastest.plan.name(), fastest.cycle_time);
  for (const PlanTime& other : fastest.candidates) std::printf("%s: %.4f s\n", other.plan.c_str(), other.time);
}
