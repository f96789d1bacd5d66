// Any bytes make a machine and a short program of moves. The planner must end. If it claims that limits hold, plain
// differences of its samples must confirm this. So must the distance of every point from the whole motion, and the
// recheck of `accdec verify` must accept the record.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <accdec/filter.hpp>
#include <accdec/formats/task_writer.hpp>
#include <accdec/gcode/read_error.hpp>
#include <accdec/plan/record/check_record.hpp>
#include <accdec/plan/run/fastest_plan.hpp>
#include <accdec/simulate/profile_motion.hpp>
#include <accdec/simulate/sample_check.hpp>
#include <accdec/task.hpp>

namespace {

using namespace accdec;

constexpr double period = 1e-3;

class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}
  bool any() const { return left_ > 0; }
  int next() {
    if (left_ == 0) return 0;
    --left_;
    return *data_++;
  }
  /// From low to high in 256 even steps of its logarithm.
  double between(double low, double high) { return low * std::pow(high / low, next() / 255.0); }

 private:
  const std::uint8_t* data_;
  std::size_t left_;
};

Machine machine_of(Bytes& bytes) {
  Machine machine;
  const int kinds = bytes.next();
  for (const char* name : {"x", "y"}) {
    Axis axis;
    axis.name = name;
    axis.velocity_max = 0.2;
    axis.acceleration_max = bytes.between(0.2, 20.0);
    if (kinds & 1) axis.jerk_max = axis.acceleration_max / bytes.between(0.002, 0.05);
    if (kinds & 2) {
      axis.mass = 10.0;
      axis.damping = bytes.between(1.0, 100.0);
      axis.force_max = 5.0 * axis.acceleration_max + axis.damping * 0.15;
      axis.power_max = 0.1 * axis.force_max;
    }
    machine.axes.push_back(axis);
  }
  return machine;
}

/// Lines, arcs, reversals, points that nearly coincide, stops, tolerances from none to large.
std::string program_of(Bytes& bytes) {
  std::string text = fmt::format("G91 G64 P{:.4f} F{:.0f}\n", bytes.between(1e-3, 0.5), bytes.between(100, 20000));
  const std::array<double, 4> lengths{1e-4, 0.05, 1.0, 10.0};
  for (int blocks = 0; bytes.any() && blocks < 40; ++blocks) {
    const int kind = bytes.next();
    const double length = lengths[static_cast<std::size_t>(kind & 3)] * (1.0 + bytes.next() / 64.0);
    const double heading = bytes.next() * (6.283185307179586 / 256.0);
    if (kind & 64) text += fmt::format("G64 P{:.4f}\n", bytes.between(1e-3, 0.5));
    if ((kind & 24) == 24) text += "G61.1\n";
    const double x = length * std::cos(heading), y = length * std::sin(heading);
    if ((kind & 36) == 36) {
      text += fmt::format("G3 X{:.6f} Y{:.6f} I{:.6f} J{:.6f}\n", 2.0 * x, 2.0 * y, x, y);
    } else {
      text += fmt::format("G1 X{:.6f} Y{:.6f}\n", x, y);
    }
    if ((kind & 24) == 24) text += "G64 P0.05\n";
  }
  return text + "M2\n";
}

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "%s\n", what);
  std::abort();
}

/// Limits by differences, and the distance of every point from all of the motion: never more than the planner's own,
/// which looks near the point's legs only.
void check_profiles(const Plan& plan, const Machine& machine) {
  const Toolpath& path = plan.path;
  const std::size_t n = path.dimensions();
  std::vector<double> rows(path.point(0), path.point(0) + n);
  for (int i = 0; i < 3; ++i) rows.insert(rows.begin(), path.point(0), path.point(0) + n);
  ProfileMotion motion(path, plan.trajectory()->chain, period, plan.filter());
  while (motion.next()) rows.insert(rows.end(), motion.position(), motion.position() + n);
  for (int i = 0; i < 3; ++i) rows.insert(rows.end(), path.point(path.blocks()), path.point(path.blocks()) + n);
  const std::size_t count = rows.size() / n;
  for (std::size_t k = 3; k < count; ++k) {
    for (std::size_t a = 0; a < n; ++a) {
      const auto x = [&](std::size_t back) { return static_cast<long double>(rows[(k - back) * n + a]); };
      const long double v = (x(0) - x(1)) / period, acceleration = (x(0) - 2 * x(1) + x(2)) / (period * period);
      const long double jerk = (x(0) - 3 * x(1) + 3 * x(2) - x(3)) / (period * period * period);
      const Axis& axis = machine.axes[a];
      const long double force = axis.mass * acceleration + axis.damping * v, size = std::abs(x(0)) + 1e-3L;
      const long double unit = 2.3e-16L * size;  // of rounding of a position
      require(std::abs(v) <= axis.velocity_max * (1 + 1e-7L), "velocity");
      require(std::abs(acceleration) <= axis.acceleration_max * (1 + 1e-7L) + 4 * unit * 1e6L, "acceleration");
      require(std::abs(jerk) <= axis.jerk_max * (1 + 1e-7L) + 8 * unit * 1e9L, "jerk");
      require(std::abs(force) <= axis.force_max * (1 + 1e-6L) + 1e-6L, "force");
      require(force * v <= axis.power_max * (1 + 1e-6L) + 1e-6L, "power");
    }
  }
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
    if (!(path.tolerance[b] < unlimited)) continue;
    double nearest2 = INFINITY;
    for (std::size_t k = 1; k < count; ++k) {
      nearest2 = std::min(nearest2, segment_distance2(&rows[(k - 1) * n], &rows[k * n], path.point(b + 1), n));
    }
    require(std::sqrt(nearest2) <= path.tolerance[b] * (1 + 1e-6) + 1e-10, "tolerance");
  }
}

/// The task of a machine and what a record says of its inputs.
struct Inputs {
  Task task;
  ProgramInputs recorded;
};

Inputs inputs_of(const Machine& machine, const ToolpathOptions& reading) {
  Inputs inputs;
  inputs.task.sample_period = period;
  inputs.task.machine = machine;
  inputs.recorded.program = "fuzz.ngc";
  inputs.recorded.task_path = "fuzz.toml";
  inputs.recorded.task_text = task_to_toml(inputs.task);
  inputs.recorded.reading = reading;
  inputs.task = parse_task(inputs.recorded.task_text, "fuzz.toml", {.require_corners = false, .axes = 9});
  return inputs;
}

void verify(const ProgramResult& result, const Toolpath& path, const Inputs& inputs) {
  if (!result.verification.feasible) return;
  const std::string text = program_to_json(result, inputs.recorded);
  const RecordCheck check = check_program_record(text, parse_program_record(text, "r.json"), path);
  for (const std::string& reason : check.reasons) std::fprintf(stderr, "%s\n", reason.c_str());
  require(check.reasons.empty(), "a true result is refused");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 8 || size > 200) return 0;
  Bytes bytes(data, size);
  const Machine machine = machine_of(bytes);
  const int order = 1 + bytes.next() / 4;
  const std::string text = program_of(bytes);
  try {
    LineSource source("fuzz.ngc", text);
    ToolpathOptions options;
    options.clamp_feeds = true;
    const Toolpath path = read_toolpath(source, machine, options);
    double way = 0.0;
    for (const double d : path.duration) way += d;
    if (path.blocks() > 120 || way > 5.0) return 0;  // right, but slow
    const Inputs inputs = inputs_of(machine, options);
    const ProgramResult profiles = plan_profiles_of({inputs.recorded.program, path, inputs.task});
    if (profiles.verification.feasible) check_profiles(profiles.plan, program_machine(machine, path));
    verify(profiles, path, inputs);
    // Under sanitizers a search may take minutes; the best plan by then must hold, too.
    const Deadline deadline(4.0);
    verify(run_program({inputs.recorded.program, path, inputs.task, Feeds::choose, deadline}, boxcar(order)), path,
           inputs);
  } catch (const ReadError&) {
  }
  return 0;
}
