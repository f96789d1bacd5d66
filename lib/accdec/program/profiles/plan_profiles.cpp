#include <accdec/program/profiles/plan_profiles.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include <accdec/program/plan.hpp>
#include <accdec/program/profiles/available.hpp>
#include <accdec/program/profiles/corner.hpp>
#include <accdec/program/profiles/motion.hpp>

namespace accdec {
namespace {

/// Shares of what the limits leave, lowered by repair.
struct Shares {
  std::vector<float> acceleration;  ///< by place: 2 b for leg b, 2 b + 1 for the corner after it
  std::vector<float> speed;         ///< by corner
  explicit Shares(std::size_t blocks) : acceleration(2 * blocks, 1.0F), speed(blocks + 1, 1.0F) {}
};

void fill_legs(ProfileChain& chain, const Toolpath& path, const AvailableAcceleration& available, const Shares& shares,
               std::vector<double>& units) {
  const std::size_t n = path.dimensions(), blocks = path.blocks();
  const auto levels = static_cast<std::size_t>(chain.levels);
  chain.length.resize(blocks);
  chain.feed.resize(blocks);
  chain.ramp.resize(blocks * levels);
  units.resize(blocks * n);
  for (std::size_t b = 0; b < blocks; ++b) {
    const double* p = path.point(b);
    double length2 = 0.0;
    for (std::size_t a = 0; a < n; ++a) length2 += (p[n + a] - p[a]) * (p[n + a] - p[a]);
    const double length = std::sqrt(length2);
    double* u = units.data() + b * n;
    for (std::size_t a = 0; a < n; ++a) u[a] = (p[n + a] - p[a]) / length;
    chain.length[b] = length;
    chain.feed[b] = available.feed(u, n, length / path.duration[b]);
    for (std::size_t k = 0; k < levels; ++k) {
      const double speed = chain.feed[b] * static_cast<double>(k + 1) / static_cast<double>(levels);
      chain.ramp[b * levels + k] = static_cast<double>(shares.acceleration[2 * b]) * available.along(u, n, speed);
    }
  }
}

void fill_corners(ProfileChain& chain, const Toolpath& path, const AvailableAcceleration& available, const Shares& shares,
                  const std::vector<double>& units) {
  const std::size_t n = path.dimensions(), blocks = path.blocks(), levels = static_cast<std::size_t>(chain.levels);
  chain.speed_max.assign(blocks + 1, 0.0);
  chain.stretch.assign(blocks + 1, 0.0);
  chain.coast.assign(blocks + 1, 0.0);
  for (std::size_t c = 1; c < blocks; ++c) {
    if (path.joint[c - 1] == Joint::stop) continue;
    CornerLegs legs;
    legs.in = units.data() + (c - 1) * n;
    legs.out = units.data() + c * n;
    legs.ramp_in = chain.ramp[(c - 1) * levels];
    legs.ramp_out = chain.ramp[c * levels];
    legs.feed = std::min(chain.feed[c - 1], chain.feed[c]);
    legs.room = std::min(chain.length[c - 1], chain.length[c]);
    legs.tolerance = path.tolerance[c - 1];
    legs.scale = static_cast<double>(shares.acceleration[2 * c - 1]);
    const CornerPass pass = corner_pass(available, n, legs);
    chain.speed_max[c] = pass.speed_max * static_cast<double>(shares.speed[c]);
    chain.stretch[c] = pass.stretch;
    chain.coast[c] = pass.coast;
  }
}

ProfileChain make_chain(const Toolpath& path, const AvailableAcceleration& available, const Shares& shares) {
  ProfileChain chain;
  chain.levels = available.depends_on_speed() ? 16 : 1;
  std::vector<double> units;
  fill_legs(chain, path, available, shares, units);
  // Between speeding up and braking an axis would change its acceleration by twice what it has.
  for (std::size_t a = 0; a < path.dimensions(); ++a) {
    if (2.0 * available.of_axis(a, 0.0) > available.swing(a) * (1.0 + 1e-9)) chain.peak_coast = available.window();
  }
  fill_corners(chain, path, available, shares, units);
  look_ahead(chain);
  return chain;
}

/// Lowers the shares where samples broke something.
class Repair {
 public:
  Repair(const Toolpath& path, const AvailableAcceleration& available, Shares& shares)
      : path_(path), available_(available), shares_(shares), old_(shares) {
    for (std::size_t a = 0; a < path.dimensions() && available.any(); ++a) {
      const double swing = available.swing(a);
      if (swing < unlimited) jerk_floor_ = std::min(jerk_floor_, 0.5 * swing / available.of_axis(a, 0.0));
    }
  }

  void limit(std::int64_t first, std::int64_t last, LimitKind kind, double ratio) {
    const auto most = static_cast<std::int64_t>(shares_.acceleration.size()) - 1;
    const double factor = std::max(0.6, 0.995 / ratio);
    // With half the swing no change can be too large.
    const double floor = kind == LimitKind::jerk ? std::min(1.0, jerk_floor_) : 0.0;
    for (std::int64_t p = std::clamp<std::int64_t>(first, 0, most); p <= std::min(last, most); ++p) {
      const auto i = static_cast<std::size_t>(p);
      const double old = static_cast<double>(old_.acceleration[i]);
      const double lowered = std::max(old * factor, std::min(old, floor * 0.999));
      shares_.acceleration[i] = std::min(shares_.acceleration[i], static_cast<float>(lowered));
    }
  }

  /// Corners whose error is too large; with a boxcar at the end their neighbours within it, too.
  void errors(const ProfileChain& chain, const std::vector<double>& errors) {
    for (std::size_t b = 0; b + 1 < path_.blocks(); ++b) {
      if (path_.joint[b] == Joint::stop || accdec::holds(errors[b], path_.tolerance[b])) continue;
      const double factor = std::max(0.5, 0.995 * std::sqrt(path_.tolerance[b] / errors[b]));
      lower_speed(chain, b + 1, factor);
      const double reach = 0.5 * available_.window();
      double time = 0.0;
      for (std::size_t c = b + 1; c-- > 1 && time < reach;) {
        time += chain.length[c] / std::max(1e-9, std::max(chain.peak[c], chain.speed[c]));
        if (time < reach) lower_speed(chain, c, factor);
      }
      time = 0.0;
      for (std::size_t c = b + 2; c < path_.blocks() && time < reach; ++c) {
        time += chain.length[c - 1] / std::max(1e-9, std::max(chain.peak[c - 1], chain.speed[c]));
        if (time < reach) lower_speed(chain, c, factor);
      }
    }
  }

 private:
  void lower_speed(const ProfileChain& chain, std::size_t c, double factor) {
    if (!(chain.speed_max[c] > 0.0)) return;
    // From the speed driven, which may be below what the corner alone allows.
    const double share = static_cast<double>(old_.speed[c]) * factor * std::min(1.0, chain.speed[c] / chain.speed_max[c]);
    shares_.speed[c] = std::min(shares_.speed[c], static_cast<float>(share));
  }

  const Toolpath& path_;
  const AvailableAcceleration& available_;
  Shares& shares_;
  const Shares old_;
  double jerk_floor_ = unlimited;
};

ProfilePlan plan_with_taps(const Toolpath& path, const Machine& machine, double sample_period, int taps) {
  const AvailableAcceleration available(machine, sample_period, taps);
  Shares shares(path.blocks());
  ProfilePlan plan;
  plan.taps = taps;
  plan.errors.resize(path.blocks());
  constexpr int rounds_max = 60;
  for (plan.rounds = 0;; ++plan.rounds) {
    plan.chain = make_chain(path, available, shares);
    Repair repair(path, available, shares);
    SampleChecker checker(path, machine, sample_period, plan.errors,
                          [&](std::int64_t first, std::int64_t last, LimitKind kind, double ratio) { repair.limit(first, last, kind, ratio); });
    ProfileMotion motion(path, plan.chain, sample_period, taps);
    while (motion.next()) checker.look(motion.position(), motion.place_first(), motion.place_last());
    plan.check = checker.finish();
    if (plan.holds() || plan.rounds == rounds_max) return plan;
    if (!plan.check.errors_hold) repair.errors(plan.chain, plan.errors);
  }
}

/// Lengths of the last boxcar to try, taps.
std::vector<int> boxcars(const Machine& machine, double sample_period) {
  const std::optional<double> jerk_time = longest_jerk_time(machine);
  if (!jerk_time) return {1};
  std::vector<int> taps;
  for (const double factor : {0.35, 0.5, 0.7, 1.0, 1.4, 2.0}) {
    const double count = std::ceil(*jerk_time * factor / sample_period - 1e-6);
    taps.push_back(static_cast<int>(std::clamp(count, 1.0, 100'000.0)));
  }
  taps.erase(std::unique(taps.begin(), taps.end()), taps.end());
  return taps;
}

}  // namespace

ProfilePlan plan_profiles(const Toolpath& path, const Machine& machine, double sample_period) {
  if (const std::string refusal = profiles_refusal(machine); !refusal.empty()) throw std::invalid_argument(refusal);
  std::vector<std::pair<double, int>> candidates;
  for (const int taps : boxcars(machine, sample_period)) {
    const AvailableAcceleration available(machine, sample_period, taps);
    const ProfileChain chain = make_chain(path, available, Shares(path.blocks()));
    double time = chain_time(chain);
    for (std::size_t c = 1; c <= path.blocks(); ++c) time += chain.stops(c) ? taps * sample_period : 0.0;
    candidates.emplace_back(time, taps);
  }
  std::sort(candidates.begin(), candidates.end());
  ProfilePlan best;
  const std::size_t tried = path.blocks() > 100'000 ? 1 : 3;
  for (std::size_t i = 0; i < std::min(tried, candidates.size()); ++i) {
    ProfilePlan plan = plan_with_taps(path, machine, sample_period, candidates[i].second);
    const bool better = plan.holds() && (!best.holds() || plan.check.samples < best.check.samples);
    if (i == 0 || better) best = std::move(plan);
  }
  return best;
}

}  // namespace accdec
