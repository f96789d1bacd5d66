// Any bytes are a program that is read, planned and simulated, or refused with a position; nothing else may happen.

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include <accdec/filter.hpp>
#include <accdec/gcode/read_error.hpp>
#include <accdec/plan/command/program_plan.hpp>

namespace {

accdec::Machine machine() {
  accdec::Machine m;
  for (const char* name : {"x", "y", "z", "a"}) {
    accdec::Axis axis;
    axis.name = name;
    axis.velocity_max = 1.0;
    axis.acceleration_max = 20.0;
    m.axes.push_back(axis);
  }
  return m;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  static const accdec::Filter filter = accdec::trapezoid(12, 3);
  // The first byte chooses the format by the file's name.
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  accdec::LineSource source(data[0] % 2 == 0 ? "fuzz.ngc" : "fuzz.csv", text);
  accdec::ToolpathOptions options;
  options.read.arc_tolerance = 1e-5;
  options.error_max = 1e-5;
  try {
    accdec::Toolpath path = accdec::read_toolpath(source, machine(), options);
    double duration = path.dwell_first;
    for (const double d : path.duration) duration += d;
    for (const auto& [block, dwell] : path.dwell) duration += dwell;
    if (path.blocks() > 2000 || duration > 100.0) return 0;  // right, but slow
    const accdec::ProgramPlan plan = accdec::plan_program(path, filter, 1e-3, accdec::program_machine(machine(), path));
    if (!plan.errors_hold) std::abort();
    const accdec::CommandTiming timing(path, 1e-3, plan.delays);
    if (plan.simulation.samples != timing.command_samples() + filter.order() + 1) std::abort();
  } catch (const accdec::ReadError&) {
  }
  return 0;
}
