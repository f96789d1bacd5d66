#include <cstdio>

#include <accdec/formats/task_reader.hpp>
#include <accdec/program/write/fastest_plan.hpp>

int main() {
  using namespace accdec;
  const std::string name = "problems/program/zigzag.ngc";
  const Task task = read_task("problems/program/mill.toml", {.require_corners = false});
  const ProgramFileOptions options;
  ProgramFile read = read_program_file(name, task, options, {});
  const auto fastest = run_fastest_plan(name, read, task, options, {});
  if (const auto* profiles = std::get_if<ProfileResult>(&fastest)) {
    std::printf("profiles: %.4f s\n", profiles->cycle_time);
    for (const PlanTime& other : profiles->candidates) std::printf("%s: %.4f s\n", other.plan.c_str(), other.time);
  } else {
    std::printf("another plan: %.4f s\n", std::get<ProgramResult>(fastest).cycle_time);
  }
}
