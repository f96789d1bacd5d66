#include <algorithm>
#include <cmath>

#include <accdec/machine/limits.hpp>
#include <accdec/plan/report/axis_loads.hpp>
#include <accdec/plan/report/samples.hpp>
#include <accdec/simulate/simulate.hpp>

namespace accdec {
namespace {

/// Force of one axis, sample by sample, from rest on.
class Loaded {
 public:
  /// @param samples  of the program: the mean is over their time, and counts the motion of a servo after them, too
  Loaded(const Axis& axis, std::size_t dimension, double period, std::int64_t samples)
      : axis_(&axis), dimension_(dimension), period_(period), samples_(samples) {}

  std::size_t dimension() const { return dimension_; }
  /// A sample; if some before it were passed over, they and the one before them had its velocity, too.
  void look(double velocity, std::int64_t number) {
    const double force =
        axis_state(*axis_, velocity, (velocity - before_) / period_, 0.0, standing_speed(period_)).force;
    before_ = velocity;
    peak_ = std::max(peak_, std::abs(force));
    squares_ += static_cast<long double>(number - number_) * force * force;
    number_ = number;
  }
  AxisLoad finish(const Toolpath& path) {
    look(0.0, number_ + 1);
    const double mean = static_cast<double>(squares_ / static_cast<long double>(std::max<std::int64_t>(samples_, 1)));
    return {path.axis_name(dimension_), peak_, std::sqrt(mean), axis_->force_rms_max};
  }

 private:
  const Axis* axis_;
  std::size_t dimension_;
  double period_, before_ = 0.0, peak_ = 0.0;
  std::int64_t samples_, number_ = 0;
  long double squares_ = 0.0L;
};

}  // namespace

std::vector<AxisLoad> axis_loads(const ProgramResult& result, const Machine& machine) {
  std::vector<Loaded> loaded;
  for (std::size_t a = 0; a < machine.axes.size(); ++a) {
    if (machine.axes[a].mass > 0.0 || machine.axes[a].damping > 0.0 || machine.axes[a].coulomb > 0.0)
      loaded.emplace_back(machine.axes[a], a, result.sample_period, result.check.samples);
  }
  if (loaded.empty() || result.plan.empty()) return {};
  const auto look = [&](std::int64_t k, const double*, const double* velocity) {
    for (Loaded& axis : loaded) axis.look(velocity[axis.dimension()], k);
  };
  visit_samples(result, look, Steady::passed, MotionOf::servo);
  std::vector<AxisLoad> loads;
  for (Loaded& axis : loaded) loads.push_back(axis.finish(result.plan.path));
  return loads;
}

Machine moved_machine(const ProgramResult& result) {
  Machine machine = result.task_machine;
  const Toolpath& path = result.plan.path;
  const std::size_t n = path.dimensions();
  if (result.plan.empty() || n == 0) return machine;
  const std::vector<Axis> axes = program_machine(machine, path).axes;
  machine.axes.clear();
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t i = a; i < path.points.size(); i += n) {
      if (path.points[i] == path.points[a]) continue;
      machine.axes.push_back(axes[a]);
      break;
    }
  }
  return machine;
}

}  // namespace accdec
