#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <accdec/files/refused_key.hpp>
#include <accdec/machine.hpp>
#include <accdec/machine/considered_by.hpp>
#include <accdec/machine/limit_unit.hpp>
#include <accdec/machine/limits.hpp>

namespace accdec {

std::string_view to_string(Event event) {
  switch (event) {
    case Event::start: return "start";
    case Event::blend: return "blend";
    case Event::stop: return "stop";
    case Event::none: return "none";
  }
  return "?";
}

double utilisation_of(LimitKind kind, double value, double bound) {
  const double used = kind == LimitKind::speed_min ? bound : value;
  const double allowed = kind == LimitKind::speed_min ? value : bound;
  if (used <= 0.0) return 0.0;
  return allowed > 0.0 ? used / allowed : unlimited;
}

namespace {

/// Speeds and taps of one axis during one event. The start is a blend from rest, the stop a blend to rest. So all three
/// are v = in (1 - B_k) + out B_{k-d}, with in or out zero.
struct AxisEvent {
  Event event;
  double in, out;  ///< axis components of the two leg velocities, m/s
  int delay;
};

void require_period(double sample_period) {
  if (!(sample_period > 0.0) || !std::isfinite(sample_period)) {
    throw std::invalid_argument(fmt::format("sample period must be positive and finite, got {} s", sample_period));
  }
}

/// Keeps the worst use of a limit over the samples seen.
class Worst {
 public:
  Worst(LimitKind kind, double bound) : use_{} {
    use_.kind = kind;
    use_.bound = bound;
  }
  bool wanted() const { return use_.bound < unlimited; }
  void offer(double value, Event event, int sample) {
    if (seen_ && !(value > use_.value)) return;
    seen_ = true;
    use_.value = value;
    use_.event = event;
    use_.sample = sample;
  }
  LimitUse finish(const std::string& axis, const std::string& corner) {
    use_.axis = axis;
    use_.corner = corner;
    use_.value = std::max(use_.value, 0.0);
    use_.utilisation = utilisation_of(use_.kind, use_.value, use_.bound);
    return use_;
  }

 private:
  LimitUse use_;
  bool seen_ = false;
};

/// Uses of the shared supply. @param power  W, by event and sample  @param first  k of a blend's first sample
void supply_uses(const std::array<std::vector<double>, 3>& power, int first, const Machine& machine,
                 const std::string& corner, std::vector<LimitUse>& uses) {
  Worst motoring(LimitKind::power_total, machine.power_total_max);
  Worst braking(LimitKind::regeneration_total, machine.regeneration_total_max);
  for (const Event event : {Event::start, Event::blend, Event::stop}) {
    const std::vector<double>& values = power[static_cast<std::size_t>(event)];
    for (std::size_t i = 0; i < values.size(); ++i) {
      const int k = static_cast<int>(i) + (event == Event::blend ? first : 0);
      motoring.offer(values[i], event, k);
      braking.offer(-values[i], event, k);
    }
  }
  for (Worst* worst : {&motoring, &braking}) {
    if (worst->wanted()) uses.push_back(worst->finish("", corner));
  }
}

}  // namespace

bool has_dry_friction(const Machine& machine) {
  return std::any_of(machine.axes.begin(), machine.axes.end(), [](const Axis& axis) { return axis.coulomb > 0.0; });
}

bool has_force_curve(const Machine& machine) {
  return std::any_of(machine.axes.begin(), machine.axes.end(),
                     [](const Axis& axis) { return axis.force_speed_max < unlimited; });
}

void require_no_shared_loads(const Machine& machine, const char* what, std::string_view instead) {
  using Keys = std::vector<std::string>;
  Keys keys = machine.power_total_max < unlimited          ? Keys{"power_total_max_W"}
              : machine.regeneration_total_max < unlimited ? Keys{"regeneration_total_max_W"}
              : has_dry_friction(machine)                  ? Keys{"coulomb_N", "coulomb_N_m"}
              : has_force_curve(machine)                   ? Keys{"force_speed_N", "torque_speed_N_m"}
              : has_mode_of_axis(machine)                  ? Keys{"residual_max_um"}
                                                           : Keys{};
  if (keys.empty()) return;
  // The key that the first such axis most likely has: an axis that turns may have either.
  const auto loaded = std::find_if(machine.axes.begin(), machine.axes.end(), [&](const Axis& axis) {
    return has_dry_friction(machine) ? axis.coulomb > 0.0 : axis.force_speed_max < unlimited;
  });
  if (keys.size() == 2 && is_rotary(loaded->name)) std::swap(keys[0], keys[1]);
  throw RefusedKey(fmt::format("{} does not consider `{}`; {}", what, keys.front(), instead), keys);
}

void require_no_modes_of_axes(const Machine& machine, const char* what) {
  if (!has_mode_of_axis(machine)) return;
  throw RefusedKey(fmt::format("{} does not consider `residual_max_um`; {}", what, considered_by), {"residual_max_um"});
}

std::vector<LimitUse> axis_utilisation(const Filter& filter, const Corner& corner, int delay, double sample_period,
                                       const Machine& machine, const std::string& corner_name) {
  if (corner.axes() != static_cast<Eigen::Index>(machine.axes.size())) {
    throw std::invalid_argument(fmt::format("corner has {} axes, the machine {}", corner.axes(), machine.axes.size()));
  }
  require_period(sample_period);
  std::vector<LimitUse> uses;
  const double still = still_part * std::max(corner.feed_in, corner.feed_out);
  std::array<std::vector<double>, 3> power;  // of all axes together, by event and sample
  for (std::size_t a = 0; a < machine.axes.size(); ++a) {
    const Axis& axis = machine.axes[a];
    std::vector<Worst> worst;
    for (const AxisLimit& limit : axis_limits) worst.emplace_back(limit.kind, axis.*limit.bound);
    const auto index = static_cast<Eigen::Index>(a);
    const double in = corner.feed_in * corner.direction_in[index], out = corner.feed_out * corner.direction_out[index];
    for (const AxisEvent& e : {AxisEvent{Event::start, 0.0, in, 0}, AxisEvent{Event::blend, in, out, delay},
                               AxisEvent{Event::stop, out, 0.0, 0}}) {
      AxisSampler sampler(axis, sample_period, still);
      const int last = filter.order() + settling + (e.event == Event::blend ? std::max(e.delay, 0) : 0);
      std::vector<double>& together = power[static_cast<std::size_t>(e.event)];
      together.resize(static_cast<std::size_t>(last - std::min(0, e.delay)) + 1, 0.0);
      for (int k = std::min(0, e.delay); k <= last; ++k) {
        const double v = e.in * filter.remaining(k) + e.out * filter.cumulative(k - e.delay);
        const double acc = (e.out * filter.tap(k - 1 - e.delay) - e.in * filter.tap(k - 1)) / sample_period;
        const AxisState state = sampler.next(v, acc);
        for (std::size_t i = 0; i < axis_limits.size(); ++i) worst[i].offer(axis_limits[i].value(state), e.event, k);
        together[static_cast<std::size_t>(k - std::min(0, e.delay))] += state.motoring;
      }
    }
    for (Worst& w : worst) {
      if (w.wanted()) uses.push_back(w.finish(axis.name, corner_name));
    }
  }
  supply_uses(power, std::min(0, delay), machine, corner_name, uses);
  return uses;
}

}  // namespace accdec
