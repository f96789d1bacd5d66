#include "drawn_program.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <accdec/machine/limit_unit.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/machine/signed_value.hpp>
#include <accdec/plan/report/samples.hpp>
#include <accdec/plot/program_motion.hpp>
#include <accdec/simulate/simulate.hpp>

namespace accdec::explore {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::int64_t most_points = 12'000;  ///< of a motion, as drawn

double rounded_to(double x, double step) {
  return std::round(x / step) * step;
}

double to_thousandths(double x) {
  return std::round(1e3 * x) / 1e3;
}

/// The value of the largest magnitude among those of many samples.
class Peak {
 public:
  void look(double value) {
    if (std::abs(value) > std::abs(most_)) most_ = value;
  }
  double take() { return std::exchange(most_, 0.0); }

 private:
  double most_ = 0.0;
};

/// Acceleration and jerk of one axis from its velocities, the largest since they were taken last.
class Differences {
 public:
  explicit Differences(double period) : period_(period) {}
  void add(double velocity, bool rested) {
    const double acceleration = (velocity - velocity_) / period_;
    most_jerk_.look((acceleration - (rested ? 0.0 : acceleration_)) / period_);
    most_acceleration_.look(acceleration);
    velocity_ = velocity, acceleration_ = acceleration;
  }
  double take_acceleration() { return rounded_to(mm * most_acceleration_.take(), 0.1); }
  double take_jerk() { return rounded_to(mm * most_jerk_.take(), 1.0); }

 private:
  double period_, velocity_ = 0.0, acceleration_ = 0.0;
  Peak most_acceleration_, most_jerk_;
};

/// Force or power over time: of one axis, or of all.
struct LoadCurve {
  LimitKind kind;
  std::string axis;  ///< empty: of all
  std::string_view unit;
  double factor;     ///< from SI
  double high, low;  ///< bounds above and below zero, in the unit; not finite where there is none
  Peak peak{};
  std::vector<double> values{};
};

/// The loads of the motion, which is that behind a servo: a plan is judged by them.
class Loads {
 public:
  Loads(const Toolpath& path, const Machine& machine, double period) : machine_(machine), period_(period) {
    for (std::size_t a = 0; a < machine.axes.size(); ++a) {
      const Axis& axis = machine.axes[a];
      if (axis.mass > 0.0 || axis.damping > 0.0 || axis.coulomb > 0.0) add(axis, path.axis_name(a), a);
    }
    before_.resize(machine.axes.size(), 0.0);
    if (!loaded_.empty() && limits_supply(machine))
      curves_.push_back({LimitKind::power_total, "", limit_name(LimitKind::power_total).unit, 1.0,
                         machine.power_total_max, -machine.regeneration_total_max});
  }

  /// @param drawn  numbers of the samples that have a point
  Json json(const ProgramResult& result, const std::vector<std::int64_t>& drawn) {
    if (!loaded_.empty() && !drawn.empty()) visit(result, drawn);
    Json json = Json::array();
    for (const LoadCurve& curve : curves_) {
      json.push_back({{"kind", limit_word(curve.kind, curve.axis)},
                      {"axis", curve.axis},
                      {"unit", curve.unit},
                      {"bounds", {bound(curve.high), bound(curve.low)}},
                      {"values", curve.values}});
      if (curve.kind != LimitKind::force) continue;
      for (const AxisLoad& load : result.loads) {
        if (load.axis != curve.axis) continue;
        json.back()["peak"] = rounded(curve.factor * load.peak);
        json.back()["rms"] = rounded(curve.factor * load.rms);
        json.back()["rating"] = bound(curve.factor * load.rms_max);
      }
    }
    return json;
  }

 private:
  void add(const Axis& axis, const std::string& name, std::size_t dimension) {
    loaded_.push_back(dimension);
    const auto curve = [&](LimitKind kind, double high, double low) {
      const LimitUnit unit = limit_unit(kind, name);
      curves_.push_back({kind, name, unit.name, unit.per_si, high * unit.per_si, low * unit.per_si});
    };
    curve(LimitKind::force, axis.force_max, -axis.force_max);
    curve(LimitKind::power, axis.power_max, -axis.regeneration_max);
    if (axis.force_speed_max < unlimited)
      curves_.push_back({LimitKind::force_speed, name, "%", 100.0 / axis.force_speed_max, 100.0, -unlimited});
  }

  void visit(const ProgramResult& result, const std::vector<std::int64_t>& drawn) {
    auto next = drawn.begin();
    bool seen = false;  // a sample since the last point; a steady motion is not visited
    const auto point = [&] {
      for (LoadCurve& curve : curves_) curve.values.push_back(to_thousandths(curve.peak.take()));
      ++next, seen = false;
    };
    visit_samples(
        result,
        [&](std::int64_t k, const double*, const double* velocity) {
          const std::vector<double> now = loads(velocity);
          while (next != drawn.end() && *next < k) {
            if (!seen) look(now);
            point();
          }
          look(now), seen = true;
          if (next != drawn.end() && *next == k) point();
        },
        Steady::passed, MotionOf::servo);
    while (next != drawn.end()) point();
    // Behind a servo the motion is at rest after the last point.
    look(loads(std::vector<double>(before_.size(), 0.0).data()));
    for (LoadCurve& curve : curves_) {
      const double last = curve.peak.take();
      if (std::abs(last) > std::abs(curve.values.back())) curve.values.back() = to_thousandths(last);
    }
  }

  /// Those of one sample, in the order of the curves.
  std::vector<double> loads(const double* velocity) {
    std::vector<double> values;
    auto curve = curves_.begin();
    double sum = 0.0;
    for (const std::size_t a : loaded_) {
      const AxisState state =
          axis_state(machine_.axes[a], velocity[a], (velocity[a] - before_[a]) / period_, 0.0, standing_speed(period_));
      before_[a] = velocity[a], sum += state.motoring;
      for (const std::string& axis = curve->axis; curve != curves_.end() && curve->axis == axis; ++curve)
        values.push_back(curve->factor * signed_value(state, curve->kind));
    }
    if (curve != curves_.end()) values.push_back(sum);
    return values;
  }
  void look(const std::vector<double>& values) {
    for (std::size_t i = 0; i < values.size(); ++i) curves_[i].peak.look(values[i]);
  }
  static Json bound(double value) { return std::abs(value) < unlimited ? Json(value) : Json(nullptr); }

  const Machine& machine_;
  double period_;
  std::vector<std::size_t> loaded_;
  std::vector<double> before_;
  std::vector<LoadCurve> curves_;
};

}  // namespace

double rounded(double x) {
  return std::round(1e4 * x) / 1e4;
}

std::int64_t common_step(const std::vector<ProgramResult>& plans) {
  std::int64_t most = 1;
  for (const ProgramResult& plan : plans) most = std::max(most, samples_a_point(motion_of(plan), most_points));
  return most;
}

nlohmann::ordered_json motion_json(const Toolpath& programmed, const Machine& machine, const ProgramResult& result,
                                   std::int64_t step) {
  const ProgramMotion motion = motion_of(result);
  const std::vector<std::int64_t> drawn = drawn_samples(motion, most_points, step);
  auto next = drawn.begin();
  std::vector<double> time, speed;
  std::vector<int> bound;
  std::vector<std::vector<double>> places(programmed.dimensions()), velocities(programmed.dimensions());
  std::vector<std::vector<double>> accelerations(programmed.dimensions()), jerks(programmed.dimensions());
  std::vector<Differences> differences(programmed.dimensions(), Differences(motion.sample_period));
  int binding = -1;
  std::int64_t before = -1;
  visit_velocities(machine, motion, [&](std::int64_t k, const double* at, const double* v, int binds) {
    binding = std::max(binding, binds);
    for (std::size_t a = 0; a < differences.size(); ++a) differences[a].add(v[a], k > before + 1);
    before = k;
    if (next == drawn.end() || k != *next) return;
    ++next;
    time.push_back(static_cast<double>(k) * motion.sample_period);
    for (std::size_t a = 0; a < places.size(); ++a) {
      places[a].push_back(rounded(mm * at[a]));
      velocities[a].push_back(rounded(mm * v[a]));
      accelerations[a].push_back(differences[a].take_acceleration());
      jerks[a].push_back(differences[a].take_jerk());
    }
    speed.push_back(rounded(mm * speed_of(v, places.size()))), bound.push_back(binding);
    binding = -1;
  });
  Json json{{"plan", result.plan.name()},
            {"cycle_time_s", result.cycle_time},
            {"t_s", time},
            {"speed_mm_s", speed},
            {"binds", bound},
            {"places_mm", places},
            {"velocities_mm_s", velocities},
            {"accelerations_mm_s2", accelerations},
            {"jerks_mm_s3", jerks},
            {"loads", Loads(programmed, machine, motion.sample_period).json(result, drawn)},
            {"lost", Json::array()},
            {"bounds", bounds_to_json(bounds_of(result))}};
  for (const CornerLoss& loss : time_lost(programmed, motion))
    if (loss.count > 0)
      json["lost"].push_back({{"turn", class_name(loss)}, {"count", loss.count}, {"time_s", loss.time}});
  return json;
}

}  // namespace accdec::explore
