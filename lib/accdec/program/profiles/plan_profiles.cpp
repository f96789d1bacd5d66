#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>

#include <accdec/program/plan/plan.hpp>
#include <accdec/program/profiles/available.hpp>
#include <accdec/program/profiles/corner.hpp>
#include <accdec/program/profiles/motion.hpp>
#include <accdec/program/profiles/plan_profiles.hpp>

namespace accdec {
namespace {

/// Shares of what the limits leave, lowered by repair.
struct Shares {
  std::vector<float> acceleration;  ///< by place: 2 b for leg b, 2 b + 1 for the corner after it
  std::vector<float> speed;         ///< by corner
  explicit Shares(std::size_t blocks) : acceleration(2 * blocks, 1.0F), speed(blocks + 1, 1.0F) {}
};

/// Makes the chain of a path, and makes it again where shares have changed.
class ChainMaker {
 public:
  ChainMaker(const Toolpath& path, const AvailableAcceleration& available)
      : path_(path), available_(available), n_(path.dimensions()) {
    const std::size_t blocks = path.blocks();
    chain_.levels = available.depends_on_speed() ? 16 : 1;
    chain_.length.resize(blocks);
    chain_.feed.resize(blocks);
    chain_.ramp.resize(blocks * levels());
    chain_.speed_max.assign(blocks + 1, 0.0);
    chain_.stretch.assign(blocks + 1, 0.0);
    chain_.coast.assign(blocks + 1, 0.0);
    units_.resize(blocks * n_);
    for (std::size_t b = 0; b < blocks; ++b) measure(b);
    // Between speeding up and braking an axis would change its acceleration by twice what it has.
    for (std::size_t a = 0; a < n_; ++a) {
      if (2.0 * available.of_axis(a, 0.0) > available.swing(a) * (1.0 + 1e-9)) chain_.peak_coast = available.window();
    }
  }

  const ProfileChain& make(const Shares& shares) {
    const std::size_t blocks = path_.blocks();
    const auto changed = [&](std::size_t place) {
      return !made_ || made_->acceleration[place] != shares.acceleration[place];
    };
    for (std::size_t b = 0; b < blocks; ++b) {
      if (changed(2 * b)) set_ramp(b, static_cast<double>(shares.acceleration[2 * b]));
    }
    for (std::size_t c = 1; c < blocks; ++c) {
      if (path_.joint[c - 1] == Joint::stop) continue;
      if (changed(2 * c - 2) || changed(2 * c - 1) || changed(2 * c) || made_->speed[c] != shares.speed[c]) {
        set_corner(c, static_cast<double>(shares.acceleration[2 * c - 1]), static_cast<double>(shares.speed[c]));
      }
    }
    made_ = shares;
    look_ahead(chain_);
    return chain_;
  }
  ProfileChain take() { return std::move(chain_); }

 private:
  std::size_t levels() const { return static_cast<std::size_t>(chain_.levels); }
  const double* unit(std::size_t b) const { return units_.data() + b * n_; }

  void measure(std::size_t b) {
    const double* p = path_.point(b);
    double length2 = 0.0;
    for (std::size_t a = 0; a < n_; ++a) length2 += (p[n_ + a] - p[a]) * (p[n_ + a] - p[a]);
    const double length = std::sqrt(length2);
    for (std::size_t a = 0; a < n_; ++a) units_[b * n_ + a] = (p[n_ + a] - p[a]) / length;
    chain_.length[b] = length;
    chain_.feed[b] = available_.feed(unit(b), n_, length / path_.duration[b]);
  }

  void set_ramp(std::size_t b, double share) {
    for (std::size_t k = 0; k < levels(); ++k) {
      const double speed = chain_.feed[b] * static_cast<double>(k + 1) / chain_.levels;
      chain_.ramp[b * levels() + k] = share * available_.along(unit(b), n_, speed);
    }
  }

  void set_corner(std::size_t c, double acceleration, double speed) {
    CornerLegs legs;
    legs.in = unit(c - 1);
    legs.out = unit(c);
    legs.ramp_in = chain_.ramp[(c - 1) * levels()];
    legs.ramp_out = chain_.ramp[c * levels()];
    legs.feed = std::min(chain_.feed[c - 1], chain_.feed[c]);
    legs.room = std::min(chain_.length[c - 1], chain_.length[c]);
    legs.tolerance = path_.tolerance[c - 1];
    legs.scale = acceleration;
    const CornerPass pass = corner_pass(available_, n_, legs);
    chain_.speed_max[c] = pass.speed_max * speed;
    chain_.stretch[c] = pass.stretch;
    chain_.coast[c] = pass.coast;
  }

  const Toolpath& path_;
  const AvailableAcceleration& available_;
  const std::size_t n_;
  ProfileChain chain_;
  std::vector<double> units_;
  std::optional<Shares> made_;
};

/// Lowers the shares where samples broke something.
class Repair {
 public:
  Repair(const Toolpath& path, const AvailableAcceleration& available, Shares& shares, int round)
      : path_(path), available_(available), shares_(shares), old_(shares), round_(round) {
    for (std::size_t a = 0; a < path.dimensions() && available.any(); ++a) {
      const double swing = available.swing(a);
      if (swing < unlimited) jerk_floor_ = std::min(jerk_floor_, 0.5 * swing / available.of_axis(a, 0.0));
    }
  }

  void limit(std::int64_t first, std::int64_t last, LimitKind kind, double ratio) {
    const auto most = static_cast<std::int64_t>(shares_.acceleration.size()) - 1;
    const double factor = lowering(ratio);
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
  /// Little by little where rounds are cheap; where the same place breaks a limit again and again, because its
  /// neighbours change, too, by more.
  double lowering(double ratio) const {
    const bool large = path_.blocks() > 50'000;
    if (round_ >= (large ? 6 : 60)) return 0.5;
    if (large) return std::clamp(std::pow(0.995 / ratio, 1.0 + 0.5 * round_), 0.5, 0.98);
    return std::clamp(0.995 / ratio, 0.6, 0.995);
  }
  void lower_speed(const ProfileChain& chain, std::size_t c, double factor) {
    if (!(chain.speed_max[c] > 0.0)) return;
    // From the speed driven, which may be below what the corner alone allows.
    const double share =
        static_cast<double>(old_.speed[c]) * factor * std::min(1.0, chain.speed[c] / chain.speed_max[c]);
    shares_.speed[c] = std::min(shares_.speed[c], static_cast<float>(share));
  }

  const Toolpath& path_;
  const AvailableAcceleration& available_;
  Shares& shares_;
  const Shares old_;
  const int round_;
  double jerk_floor_ = unlimited;
};

ProfilePlan plan_with_taps(const Toolpath& path, const Machine& machine, double sample_period, int taps) {
  const AvailableAcceleration available(machine, sample_period, taps);
  Shares shares(path.blocks());
  ProfilePlan plan;
  plan.taps = taps;
  plan.errors.resize(path.blocks());
  ChainMaker maker(path, available);
  constexpr int rounds_max = 100;
  for (plan.rounds = 0;; ++plan.rounds) {
    const ProfileChain& chain = maker.make(shares);
    Repair repair(path, available, shares, plan.rounds);
    SampleChecker checker(path, machine, sample_period, plan.errors,
                          [&](std::int64_t first, std::int64_t last, LimitKind kind, double ratio) {
                            repair.limit(first, last, kind, ratio);
                          });
    ProfileMotion motion(path, chain, sample_period, taps);
    while (motion.next()) checker.look(motion.position(), motion.place_first(), motion.place_last());
    plan.check = checker.finish();
    if (plan.holds() || plan.rounds == rounds_max) break;
    if (!plan.check.errors_hold) repair.errors(chain, plan.errors);
  }
  plan.chain = maker.take();
  return plan;
}

/// Lengths of the last boxcar to try, taps.
std::vector<int> boxcars(const Machine& machine, double sample_period) {
  const std::optional<double> jerk_time = longest_jerk_time(machine);
  if (!jerk_time) return {1};
  std::vector<int> taps;
  for (const double factor : {0.35, 0.5, 0.7, 0.85, 1.0, 1.15, 1.3, 1.5, 2.0}) {
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
    ChainMaker maker(path, available);
    const ProfileChain& chain = maker.make(Shares(path.blocks()));
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
