#include <algorithm>

#include <fmt/format.h>

#include <accdec/machine/mode_text.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/plan/emit/emit.hpp>
#include <accdec/plan/report/feed_override.hpp>
#include <accdec/simulate/simulate.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

FeedOverride overridden(Toolpath path, double factor, const Filter& filter, double sample_period,
                        const Machine& machine, const std::vector<int>& delays) {
  for (std::size_t b = 0; b < path.blocks(); ++b) path.duration[b] /= stands_as_rapid(path, b, machine) ? 1.0 : factor;
  std::vector<double> errors(path.blocks(), 0.0);
  SimulationOptions options;
  if (!machine.axes.empty()) options.machine = &machine;
  options.whole_windows = true;
  const FilterBehind behind(filter, machine, sample_period);
  options.motion = behind.servo();
  const Simulation simulation =
      simulate_program(CommandTiming(path, sample_period, delays), filter, 0, path.blocks() - 1, errors, options);
  FeedOverride result;
  result.factor = factor;
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
    if (!(path.tolerance[b] < unlimited)) continue;
    const double error = errors[b] <= position_floor ? 0.0 : errors[b];
    const double use = utilisation_of(LimitKind::corner_error, error, path.tolerance[b]);
    result.worst_error = std::max(result.worst_error, error);
    if (use <= result.worst_utilisation && result.worst_line != 0) continue;
    result.worst_utilisation = use;
    result.worst_line = path.line[b];
  }
  for (const LimitUse& use : simulation.limits) {
    if (use.utilisation <= result.limit_utilisation) continue;
    result.limit_utilisation = use.utilisation;
    result.limit = limit_and_axis(use);
  }
  return result;
}

}  // namespace

std::vector<FeedOverride> feed_overrides(const Toolpath& path, const Filter& filter, double sample_period,
                                         const Machine& machine, const std::vector<int>& delays) {
  std::vector<FeedOverride> result;
  for (const double factor : {0.5, 0.8, 1.2}) {
    result.push_back(overridden(path, factor, filter, sample_period, machine, delays));
  }
  return result;
}

}  // namespace accdec
