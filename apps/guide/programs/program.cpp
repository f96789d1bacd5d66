#include <iostream>

#include <accdec/program.hpp>
#include <accdec/task.hpp>

int main() {
  using namespace accdec;
  const std::string name = "problems/program/zigzag.ngc";
  const Task task = read_task("problems/program/mill.toml", {.require_corners = false});
  ToolpathOptions reading;
  reading.clamp_feeds = true;  // feeds are upper bounds
  LineSource source{std::filesystem::path(name)};
  const Toolpath path = read_toolpath(source, task.machine, reading);
  const Filter filter = make_filter(task.filter.value());
  const ProgramResult result = run_program(name, path, filter, task, false, Feeds::choose);
  std::cout << to_string(result.status) << ": " << result.cycle_time << " s, with exact stops "
            << result.cycle_time_exact_stop.value() << " s\n";
}
