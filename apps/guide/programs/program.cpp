#include <iostream>

#include <accdec/program.hpp>
#include <accdec/task.hpp>

int main() {
  using namespace accdec;
  PlanningProblem problem;
  problem.program = "problems/program/zigzag.ngc";
  problem.task = read_task("problems/program/mill.toml", {.require_corners = false});
  ToolpathOptions reading;
  reading.clamp_feeds = true;  // feeds are upper bounds
  LineSource source{std::filesystem::path(problem.program)};
  problem.path = read_toolpath(source, problem.task.machine, reading);
  problem.feeds = Feeds::choose;
  const ProgramResult result = run_program(problem, make_filter(problem.task.filter.value()));
  std::cout << to_string(result.status) << ": " << result.cycle_time << " s, with exact stops "
            << result.cycle_time_exact_stop.value() << " s\n";
}
