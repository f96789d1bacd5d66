#include <cstdio>

#include <accdec/program.hpp>

int main() {
  accdec::TaskOptions whole;
  whole.require_corners = false;
  whole.axes = 9;  // a single [[axis]] table stands for so many
  const accdec::Task task = accdec::read_task("problems/program/mill.toml", whole);
  const accdec::ProgramFileOptions options;
  const char* name = "problems/program/pocket.ngc";
  const accdec::ProgramFile file = accdec::read_program_file(name, task, options, {});
  const accdec::ProgramResult result = accdec::run_program_file(file, task, options, {});
  std::printf("%s: %.3f s\n", accdec::to_string(result.status).data(), result.cycle_time);

  accdec::Motion motion(result.plan, result.sample_period);
  accdec::Sample sample;
  long samples = 0;
  while (motion.next(sample)) ++samples;  // position and velocity of every axis
  std::printf("%ld samples\n", samples);
}
