#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>

#include <accdec/plan/along/leg_program.hpp>
#include <accdec/plan/free/cone_program.hpp>

namespace accdec {
namespace {

/// Bounds of the program are narrower than those of the check by this part.
constexpr double inside = 1.0 - 1e-7;
constexpr std::size_t unknowns_max = 20'000;

/// Along the leg, m/s, m/s^2, m/s^3, without those of force.
struct LegLimits {
  double speed, acceleration = unlimited, jerk = unlimited;
};

LegLimits limits_along(const FreePath& free, const StraightLeg& leg) {
  LegLimits limits{.speed = leg.feed};
  for (std::size_t a = 0; a < free.dimensions(); ++a) {
    const Axis& axis = free.machine.axes[a];
    const double part = std::abs(leg.direction[a]);
    limits.speed = std::min(limits.speed, axis.velocity_max / part);
    limits.acceleration = std::min(limits.acceleration, axis.acceleration_max / part);
    limits.jerk = std::min(limits.jerk, axis.jerk_max / part);
  }
  return limits;
}

/// A step that stands for `more` + 1 equal ones.
struct Held {
  std::size_t step = 0, more = 0;
};

class LegProgram {
 public:
  LegProgram(const FreePath& free, const StraightLeg& leg, const LegStart& start, std::size_t count, const Held& held)
      : free_(free),
        leg_(leg),
        start_(start),
        limits_(limits_along(free, leg)),
        held_(held),
        unit_(1e-3 * leg.length),
        program_(count - held.more, 1, free.border()) {
    for (std::size_t i = 1; i <= count - held.more; ++i) {
      // Three equal steps are as many as a difference sees.
      const std::size_t times = i == held.step ? std::min<std::size_t>(held.more, 2) + 1 : 1;
      steps_.insert(steps_.end(), times, i);
    }
    add_speed();
    for (std::size_t p = 0; p <= steps_.size() + 1; ++p) {
      if (p < 2 && !start.rest) {
        for (std::size_t a = 0; a < free.dimensions(); ++a) add_axis(p, a);
      } else {
        add_line(p);
      }
      if (p > steps_.size()) continue;
      for (std::size_t a = 0; a < free.dimensions(); ++a) add_force(p, a);
    }
  }

  /// @param way  m, of every unknown: the guess; becomes the answer, which ends at the length, or beyond it
  bool solve(std::vector<double>& way) {
    for (double& z : way) z /= unit_;
    if (!program_.solve(way, true)) return false;
    for (double& z : way) z *= unit_;
    return way.back() >= leg_.length;
  }

 private:
  /// Adds a multiple of a step, which follows as many others; in the axis, m, if it is one of those before.
  void add(LinearForm& form, std::ptrdiff_t p, double factor, std::size_t axis) const {
    if (p >= static_cast<std::ptrdiff_t>(steps_.size())) return;
    if (p < 0) {
      const std::size_t row = static_cast<std::size_t>(-1 - p) * free_.dimensions();
      if (!start_.rest) form.constant += factor * start_.steps[row + axis];
      return;
    }
    const std::size_t i = steps_[static_cast<std::size_t>(p)];
    const double share = factor * unit_ / (i == held_.step ? static_cast<double>(held_.more + 1) : 1.0);
    form.add(static_cast<int>(i) - 1, share);
    if (i > 1) form.add(static_cast<int>(i) - 2, -share);
  }
  /// Bounds a sum of the steps p, p - 1, p - 2. @param part  of the leg's direction in the axis
  void bound(std::size_t p, const std::array<double, 3>& factors, std::size_t axis, double part) {
    LinearForm form;
    for (std::ptrdiff_t i = 0; i < 3; ++i) {
      const std::ptrdiff_t k = static_cast<std::ptrdiff_t>(p) - i;
      const double factor = factors[static_cast<std::size_t>(i)];
      if (factor != 0.0) add(form, k, k < 0 ? factor : factor * part, axis);
    }
    if (form.count == 0) return;
    // The steps before may use all of a limit, which is more than the program's bound.
    const double most = std::max(1.0, std::abs(form.constant));
    form.constant /= most;
    for (int i = 0; i < form.count; ++i) form.coefficient[static_cast<std::size_t>(i)] /= most;
    program_.bound(form);
  }

  /// Steps go forward, and no faster than axes and feed allow.
  void add_speed() {
    const double longest = limits_.speed * free_.period * inside;
    for (std::size_t p = 0; p < steps_.size(); ++p) {
      if (p > 0 && steps_[p] == steps_[p - 1]) continue;
      LinearForm form;
      form.constant = -1.0;
      add(form, static_cast<std::ptrdiff_t>(p), 2.0 / longest, 0);
      program_.bound(form);
    }
  }
  void add_differences(std::size_t p, double acceleration, double jerk, std::size_t axis, double part) {
    const double second = free_.period * free_.period * inside, third = second * free_.period;
    if (acceleration < unlimited && p <= steps_.size())
      bound(p, {1.0 / (acceleration * second), -1.0 / (acceleration * second), 0.0}, axis, part);
    const double f = 1.0 / (jerk * third);
    if (jerk < unlimited) bound(p, {f, -2.0 * f, f}, axis, part);
  }
  /// Differences behind rest, or far enough from the beginning, of all axes at once.
  void add_line(std::size_t p) { add_differences(p, limits_.acceleration, limits_.jerk, 0, 1.0); }
  /// Those that see the steps before.
  void add_axis(std::size_t p, std::size_t a) {
    if (leg_.direction[a] == 0.0) return;
    const Axis& axis = free_.machine.axes[a];
    add_differences(p, axis.acceleration_max, axis.jerk_max, a, leg_.direction[a]);
  }
  void add_force(std::size_t p, std::size_t a) {
    const Axis& axis = free_.machine.axes[a];
    if (!(axis.force_max < unlimited) || leg_.direction[a] == 0.0) return;
    const double rate = 1.0 / (free_.period * axis.force_max * inside), m = axis.mass * rate / free_.period;
    bound(p, {m + axis.damping * rate, -m, 0.0}, a, leg_.direction[a]);
  }

  const FreePath& free_;
  const StraightLeg& leg_;
  const LegStart& start_;
  const LegLimits limits_;
  const Held held_;
  const double unit_;  // m, of the unknowns, so that the length is a thousand
  std::vector<std::size_t> steps_;
  ConeProgram program_;
};

/// Way of a motion between its samples.
double way_at(const std::vector<double>& way, double k) {
  const double floor = std::floor(std::clamp(k, 0.0, static_cast<double>(way.size() - 1)));
  const auto i = static_cast<std::size_t>(floor);
  return i + 1 < way.size() ? way[i] + (k - floor) * (way[i + 1] - way[i]) : way.back();
}

/// The middle of a stretch at the leg's full speed, as far as it is longer than what the ends may need.
Held held_steps(const FreePath& free, const StraightLeg& leg, const std::vector<double>& way, std::size_t count) {
  constexpr std::size_t near = 24;     // samples of full speed that stay beside it
  constexpr double full = 1.0 - 1e-5;  // of the largest speed
  const double most = limits_along(free, leg).speed;
  const auto fast = [&](std::size_t k) { return way[k] - way[k - 1] >= full * most * free.period; };
  std::size_t head = 1, tail = way.size() - 1;
  while (head < tail && !fast(head)) ++head;
  while (tail > head && !fast(tail)) --tail;
  const std::size_t ends = head + (way.size() - tail) + 2 * near;
  if (!(head < tail) || ends >= count) return {};
  return {head + near, count - ends};
}

/// Whole numbers of at least 1 whose excess over the ratio is no rounding.
std::size_t at_least(double ratio) {
  return static_cast<std::size_t>(std::max(1.0, std::ceil(ratio * (1.0 - 1e-11))));
}

/// Samples of three averages.
struct Lengths {
  std::size_t first = 0, second = 0, third = 0;
  std::size_t steps() const { return first + second + third - 2; }
};

/// The shortest averages that make a step as long as the leg a motion within the limits.
std::optional<Lengths> averages_of(const FreePath& free, const StraightLeg& leg) {
  constexpr std::size_t longer = 400, most = 2'000'000;  // samples of the first average
  for (std::size_t a = 0; a < free.dimensions(); ++a) {
    if (leg.direction[a] != 0.0 && free.machine.axes[a].force_max < unlimited) return {};
  }
  const auto [speed, acceleration, jerk] = limits_along(free, leg);
  if (!(leg.length / (speed * free.period) < static_cast<double>(most))) return {};
  const std::size_t least = at_least(leg.length / (speed * free.period));
  std::optional<Lengths> best;
  for (std::size_t first = least; first <= least + longer; ++first) {
    const double steepest = leg.length / (static_cast<double>(first) * free.period * free.period);
    const std::size_t second = at_least(steepest / acceleration);
    const std::size_t third = at_least(steepest / (static_cast<double>(second) * free.period * jerk));
    // Else two changes of the acceleration overlap.
    if (second > first || third > second || (third > 1 && second + third > first)) continue;
    const Lengths lengths{first, second, third};
    if (!best || lengths.steps() < best->steps()) best = lengths;
  }
  return best;
}

}  // namespace

std::optional<std::vector<double>> averaged_leg(const FreePath& free, const StraightLeg& leg) {
  const std::optional<Lengths> n = averages_of(free, leg);
  if (!n) return {};
  // Whole numbers, so that differences are those of the averages and not of rounding.
  std::vector<std::int64_t> sum(n->steps() + 4, 0);
  const auto add = [&](std::size_t k, std::int64_t sign) {
    if (k < sum.size()) sum[k] += sign;
  };
  for (const std::size_t i : {std::size_t{0}, n->first}) {
    for (const std::size_t j : {std::size_t{0}, n->second}) {
      for (const std::size_t k : {std::size_t{0}, n->third})
        add(i + j + k, (i > 0 ? -1 : 1) * (j > 0 ? -1 : 1) * (k > 0 ? -1 : 1));
    }
  }
  for (int times = 0; times < 4; ++times) std::partial_sum(sum.begin(), sum.end(), sum.begin());
  const double whole = static_cast<double>(n->first) * static_cast<double>(n->second) * static_cast<double>(n->third);
  std::vector<double> done{0.0};
  for (std::size_t k = 0; k < n->steps(); ++k) done.push_back(static_cast<double>(sum[k]) / whole);
  return done;
}

std::optional<std::vector<double>> leg_in(const FreePath& free, const StraightLeg& leg, const LegStart& start,
                                          const std::vector<double>& way, std::size_t count) {
  const Held held = held_steps(free, leg, way, count);
  const std::size_t unknowns = count - held.more;
  if (count < 1 || unknowns > unknowns_max) return {};
  const double pace = static_cast<double>(way.size() - 1) / static_cast<double>(count);
  const auto sample = [&](std::size_t i) { return i >= held.step && held.more > 0 ? i + held.more : i; };
  std::vector<double> z(unknowns);
  for (std::size_t i = 1; i <= unknowns; ++i) z[i - 1] = way_at(way, pace * static_cast<double>(sample(i)));
  if (!LegProgram(free, leg, start, count, held).solve(z)) return {};
  std::vector<double> done{0.0};
  for (std::size_t i = 1; i <= unknowns; ++i) {
    const double before = i > 1 ? z[i - 2] : 0.0;
    const std::size_t steps = i == held.step ? held.more + 1 : 1;
    for (std::size_t k = 1; k < steps; ++k)
      done.push_back((before + (z[i - 1] - before) * static_cast<double>(k) / static_cast<double>(steps)) / z.back());
    done.push_back(z[i - 1] / z.back());
  }
  return done;
}

}  // namespace accdec
