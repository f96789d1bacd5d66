#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include <accdec/machine/limits.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/plan/filters/program_settings.hpp>
#include <accdec/plan/report/leg_error.hpp>
#include <accdec/plot/figure_style.hpp>
#include <accdec/plot/path_follower.hpp>
#include <accdec/plot/program_motion.hpp>
#include <accdec/simulate/command_stream.hpp>
#include <accdec/simulate/simulate.hpp>

namespace accdec {
namespace {

constexpr std::array<double, 7> turns{0.0, 5.0, 20.0, 45.0, 75.0, 105.0, 180.0};

double turn_at(const Toolpath& path, std::size_t b) {
  const std::size_t n = path.dimensions();
  const double* p = path.point(b);
  double dot = 0.0, in2 = 0.0, out2 = 0.0;
  for (std::size_t a = 0; a < n; ++a) {
    const double u = p[n + a] - p[a], w = p[2 * n + a] - p[n + a];
    dot += u * w;
    in2 += u * u;
    out2 += w * w;
  }
  return std::acos(std::clamp(dot / std::sqrt(in2 * out2), -1.0, 1.0)) * 180.0 / std::numbers::pi;
}

/// The limit that is used most, if it is used to 98 % or more.
struct MostUsed {
  int limit = -1;  ///< as in `VelocityVisitor`
  double use = 0.98;
};

/// The limits of one machine, and how much of each a sample uses.
class Uses {
 public:
  /// @param loads, others  which limits are looked at
  Uses(const Machine& machine, double period, bool loads, bool others)
      : machine_(machine), period_(period), loads_(loads), others_(others) {
    for (const Axis& axis : machine.axes) axes_.push_back({&axis, AxisSampler(axis, period, standing_speed(period))});
  }
  /// The next sample. @param most  of it and of what was looked at before
  void next(const double* v, MostUsed& most) {
    double power = 0.0;  // W, of all axes
    for (Followed& followed : axes_) {
      const AxisState state = followed.sampler.next(*v, (*v - followed.velocity) / period_);
      for (std::size_t i = 0; i < axis_limits.size(); ++i) {
        if (!(axis_limits[i].load ? loads_ : others_)) continue;
        look(i, axis_limits[i].value(state) / (followed.axis->*axis_limits[i].bound), most);
      }
      followed.velocity = *v++, power += state.motoring;
    }
    if (!loads_) return;
    for (std::size_t i = 0; i < supply_limits.size(); ++i) {
      const double drawn = supply_limits[i].kind == LimitKind::power_total ? power : -power;
      look(axis_limits.size() + i, drawn / (machine_.*supply_limits[i].bound), most);
    }
  }

 private:
  struct Followed {
    const Axis* axis;
    AxisSampler sampler;
    double velocity = 0.0;  ///< m/s, of the last sample
  };
  static void look(std::size_t limit, double use, MostUsed& most) {
    if (use > most.use) most = {static_cast<int>(limit), use};
  }

  const Machine& machine_;
  double period_;
  bool loads_, others_;
  std::vector<Followed> axes_;
};

/// Uses of the loads behind a servo, along with the samples of the command.
class UsesBehind {
 public:
  UsesBehind(const Machine& machine, const Plan& plan, double period)
      : uses_(machine, period, true, false), behind_(plan, period, true) {
    more_ = behind_.next(sample_);
  }
  /// The most used of the samples since the last call up to number k. Steady motion has none there: then that of the
  /// last call.
  MostUsed up_to(std::int64_t k) {
    if (more_ && sample_.number <= k) most_ = {};
    while (more_ && sample_.number <= k) {
      uses_.next(sample_.velocity.data(), most_);
      behind_.pass_steady();
      more_ = behind_.next(sample_);
    }
    return most_;
  }

 private:
  Uses uses_;
  Motion behind_;
  Sample sample_;
  bool more_;
  MostUsed most_;
};

/// The dwells of a program: time at rest that it asks for, so that none of it is lost.
class ProgrammedRests {
 public:
  ProgrammedRests(const Toolpath& path, double period) {
    left_[-1] = samples(path.dwell_first, period);
    for (const auto& [block, time] : path.dwell) left_[static_cast<std::ptrdiff_t>(block)] += samples(time, period);
  }
  /// How many of these samples at rest in a joint the program asks for.
  std::int64_t take(std::ptrdiff_t joint, std::int64_t rested) {
    const auto at = left_.find(joint);
    if (at == left_.end()) return 0;
    const std::int64_t taken = std::min(at->second, rested);
    at->second -= taken;
    return taken;
  }

 private:
  static std::int64_t samples(double time, double period) { return whole_samples(time / period); }
  std::map<std::ptrdiff_t, std::int64_t> left_;  // by joint; -1: before the first block
};

/// Goes on to sample x, which steady motion reached in `samples`. How many of these are nearer to the beginning of its
/// block, if x is nearer to the end.
std::int64_t nearer_begin(PathFollower& follower, const double* x, const double* v, std::int64_t samples) {
  const std::size_t block = follower.block();
  const double from = follower.part();
  follower.follow(x, v);
  const double to = follower.part();
  if (samples == 1 || block != follower.block() || !(from < 0.5 && to >= 0.5)) return 0;
  return static_cast<std::int64_t>(std::ceil((0.5 - from) / (to - from) * static_cast<double>(samples))) - 1;
}

}  // namespace

double speed_of(const double* velocity, std::size_t axes) {
  double sum = 0.0;
  for (std::size_t a = 0; a < axes; ++a) sum += velocity[a] * velocity[a];
  return std::sqrt(sum);
}

double block_feed(const Toolpath& path, std::size_t block) {
  std::array<double, program_axis_count> way{};
  const double *p = path.point(block), *q = path.point(block + 1);
  for (std::size_t a = 0; a < path.dimensions(); ++a) way[a] = q[a] - p[a];
  return speed_of(way.data(), path.dimensions()) / path.duration[block];
}

ProgramMotion motion_of(const ProgramResult& result) {
  return {fmt::format("{}: {:.6g} s, plan {}", result.program, result.cycle_time, result.plan.name()),
          result.sample_period,
          result.cycle_time,
          [&result](const SampleVisitor& visit) { visit_samples(result, visit, Steady::passed); },
          bounds_of(result),
          program_answer(result),
          &result.plan,
          leg_error_text(result)};
}

std::int64_t samples_a_point(const ProgramMotion& motion, std::int64_t most) {
  std::int64_t count = 0;
  motion.samples([&](std::int64_t, const double*, const double*) { ++count; });
  return std::max<std::int64_t>(1, (count + most - 1) / most);
}

std::vector<std::int64_t> drawn_samples(const ProgramMotion& motion, std::int64_t most, std::int64_t n) {
  if (n == 0) n = samples_a_point(motion, most);
  const double longest = std::max(1.0, motion.cycle_time / motion.sample_period / static_cast<double>(most));
  std::vector<std::int64_t> drawn;
  std::int64_t before = -1;
  motion.samples([&](std::int64_t k, const double*, const double*) {
    const bool far = static_cast<double>(k - before) > longest;
    if (far && drawn.back() != before) drawn.push_back(before);
    if (far || k % n == 0) drawn.push_back(k);
    before = k;
  });
  if (!drawn.empty() && drawn.back() != before) drawn.push_back(before);
  return drawn;
}

void visit_velocities(const Machine& machine, const ProgramMotion& motion, const VelocityVisitor& visit) {
  const bool servo = has_servo(machine);
  Uses uses(machine, motion.sample_period, !servo, true);
  std::optional<UsesBehind> behind;
  if (servo && motion.plan != nullptr) behind.emplace(machine, *motion.plan, motion.sample_period);
  const auto last = static_cast<std::int64_t>(std::llround(motion.cycle_time / motion.sample_period));
  motion.samples([&](std::int64_t k, const double* position, const double* velocity) {
    MostUsed most;
    // The axes come to rest after the command.
    if (behind) most = behind->up_to(k < last ? k : std::numeric_limits<std::int64_t>::max());
    uses.next(velocity, most);
    visit(k, position, velocity, most.limit);
  });
}

std::string binding_name(int binding) {
  if (binding < 0) return "tolerance or programmed feed";
  const auto i = static_cast<std::size_t>(binding);
  return std::string(
      to_string(i < axis_limits.size() ? axis_limits[i].kind : supply_limits.at(i - axis_limits.size()).kind));
}

std::array<int, binding_limits> binding_styles(const Machine& machine) {
  static_assert(figure_style::baseline_style == figure_style::colours.size() - 1);
  std::array<int, binding_limits> styles{};
  int taken = 0;
  const auto take = [&taken](bool limited) { return limited ? ++taken % figure_style::baseline_style : 0; };
  for (std::size_t i = 0; i < axis_limits.size(); ++i)
    styles[i] = take(
        std::ranges::any_of(machine.axes, [&](const Axis& axis) { return axis.*axis_limits[i].bound < unlimited; }));
  for (std::size_t i = 0; i < supply_limits.size(); ++i)
    styles[axis_limits.size() + i] = take(machine.*supply_limits[i].bound < unlimited);
  return styles;
}

std::vector<CornerLoss> time_lost(const Toolpath& path, const ProgramMotion& motion) {
  std::vector<CornerLoss> classes;
  for (std::size_t i = 0; i + 1 < turns.size(); ++i) classes.push_back({turns[i], turns[i + 1], false, 0, 0.0});
  classes.push_back({0.0, 180.0, true, 0, 0.0});
  std::vector<std::uint8_t> of_joint(path.blocks(), 0);
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    std::size_t i = classes.size() - 1;
    if (path.joint[b] != Joint::stop) {
      const double turn = turn_at(path, b);
      i = 0;
      while (i + 2 < turns.size() && turn > turns[i + 1]) ++i;
    }
    of_joint[b] = static_cast<std::uint8_t>(i);
    ++classes[i].count;
  }
  PathFollower follower(path);
  ProgrammedRests rests(path, motion.sample_period);
  constexpr double at_rest = 1e-9;  // m/s
  const auto lose = [&](std::ptrdiff_t joint, double slower, std::int64_t samples) {
    const std::size_t i = joint < 0 ? classes.size() - 1 : of_joint[static_cast<std::size_t>(joint)];
    classes[i].time += slower * static_cast<double>(samples) * motion.sample_period;
  };
  std::int64_t before = 0;
  motion.samples([&](std::int64_t k, const double* x, const double* v) {
    std::int64_t passed = k - std::exchange(before, k);
    if (k == 0) return;
    const std::int64_t early = nearer_begin(follower, x, v, passed);
    const double speed = speed_of(v, path.dimensions());
    const double slower = 1.0 - speed / block_feed(path, follower.block());
    const std::ptrdiff_t joint = follower.joint();
    lose(joint - 1, slower, early);
    passed -= early;
    if (speed < at_rest) passed -= rests.take(joint, passed);
    lose(joint, slower, passed);
  });
  // Rounding of speeds is no time lost.
  for (CornerLoss& loss : classes) {
    if (std::abs(loss.time) < 1e-6 * motion.sample_period) loss.time = 0.0;
  }
  return classes;
}

std::string class_name(const CornerLoss& loss) {
  return loss.stop ? "stops, start and end" : fmt::format("{:g} to {:g} degrees", loss.turn_from, loss.turn_to);
}

}  // namespace accdec
