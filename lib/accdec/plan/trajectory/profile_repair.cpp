#include <algorithm>
#include <cmath>

#include <accdec/plan/trajectory/profile_repair.hpp>
#include <accdec/simulate/profile_motion.hpp>
#include <accdec/simulate/sample_check.hpp>

namespace accdec {
namespace {

std::vector<float> part(const std::vector<float>& values, std::size_t first, std::size_t end) {
  return {values.begin() + static_cast<std::ptrdiff_t>(first), values.begin() + static_cast<std::ptrdiff_t>(end)};
}

/// About how long leg b takes, s.
double leg_time(const ProfileChain& chain, std::size_t b) {
  return chain.length[b] / std::max(1e-9, std::max({chain.peak[b], chain.speed[b], chain.speed[b + 1]}));
}

/// Sorted ranges, with touching ones merged.
std::vector<LegRange> merged(std::vector<LegRange> legs) {
  std::sort(legs.begin(), legs.end(), [](const LegRange& a, const LegRange& b) { return a.first < b.first; });
  std::vector<LegRange> result;
  for (const LegRange& range : legs) {
    if (!result.empty() && range.first <= result.back().last + 1) {
      result.back().last = std::max(result.back().last, range.last);
    } else {
      result.push_back(range);
    }
  }
  return result;
}

}  // namespace

std::vector<LegRange> ProfileRepair::touched() const {
  return merged(touched_);
}

ProfileRepair::ProfileRepair(const Toolpath& path, const AvailableAcceleration& available, ProfileShares& shares,
                             LegRange range, int round)
    : path_(path),
      available_(available),
      shares_(shares),
      range_(range),
      old_acceleration_(part(shares.acceleration, 2 * range.first, 2 * range.last + 2)),
      old_speed_(part(shares.speed, range.first, range.last + 2)),
      round_(round) {
  for (std::size_t a = 0; a < path.dimensions() && available.any(); ++a) {
    const double swing = available.swing(a);
    if (swing < unlimited) jerk_floor_ = std::min(jerk_floor_, 0.5 * swing / available.of_axis(a, 0.0));
  }
}

void ProfileRepair::limit(std::int64_t first, std::int64_t last, LimitKind kind, double ratio) {
  const auto least = 2 * static_cast<std::int64_t>(range_.first), most = 2 * static_cast<std::int64_t>(range_.last) + 1;
  first = std::max(first, least);
  last = std::min(last, most);
  if (first > last) return;
  const double factor = lowering(ratio);
  // With half the swing, no change is too large.
  const double floor = kind == LimitKind::jerk ? std::min(1.0, jerk_floor_) : 0.0;
  for (std::int64_t p = first; p <= last; ++p) {
    const double old = static_cast<double>(old_acceleration_[static_cast<std::size_t>(p - least)]);
    const double lowered = std::max(old * factor, std::min(old, floor * 0.999));
    float& share = shares_.acceleration[static_cast<std::size_t>(p)];
    share = std::min(share, static_cast<float>(lowered));
  }
  const LegRange legs{static_cast<std::size_t>(first / 2), static_cast<std::size_t>(last / 2)};
  if (!touched_.empty() && legs.first <= touched_.back().last + 1 && legs.first >= touched_.back().first) {
    touched_.back().last = std::max(touched_.back().last, legs.last);
  } else {
    touched_.push_back(legs);
  }
}

void ProfileRepair::errors(const ProfileChain& chain, const std::vector<double>& errors, LegRange judged) {
  const double reach = 0.5 * available_.window();
  for (std::size_t b = judged.first; b <= judged.last && b + 1 < path_.blocks(); ++b) {
    if (path_.joint[b] == Joint::stop || accdec::holds(errors[b], path_.tolerance[b])) continue;
    const double factor = std::max(0.5, 0.995 * std::sqrt(path_.tolerance[b] / errors[b]));
    lower_speed(chain, b + 1, factor);
    double time = 0.0;
    for (std::size_t c = b + 1; c-- > range_.first + 1 && time < reach;) {
      time += chain.length[c] / std::max(1e-9, std::max(chain.peak[c], chain.speed[c]));
      if (time < reach) lower_speed(chain, c, factor);
    }
    time = 0.0;
    for (std::size_t c = b + 2; c <= range_.last && time < reach; ++c) {
      time += chain.length[c - 1] / std::max(1e-9, std::max(chain.peak[c - 1], chain.speed[c]));
      if (time < reach) lower_speed(chain, c, factor);
    }
  }
}

/// Lowers in small steps where rounds are cheap. If the same place breaks a limit again and again, because its
/// neighbours also change, the steps are larger.
double ProfileRepair::lowering(double ratio) const {
  const bool large = path_.blocks() > 50'000;
  if (round_ >= (large ? 12 : 60)) return 0.5;
  if (large) return std::clamp(std::pow(0.995 / ratio, 1.0 + 0.25 * round_), 0.5, 0.98);
  return std::clamp(0.995 / ratio, 0.6, 0.995);
}

void ProfileRepair::lower_speed(const ProfileChain& chain, std::size_t c, double factor) {
  if (!(chain.speed_max[c] > 0.0) || c <= range_.first || c > range_.last) return;
  // Starts from the driven speed, which may be below the corner's own limit.
  const double share =
      static_cast<double>(old_speed_[c - range_.first]) * factor * std::min(1.0, chain.speed[c] / chain.speed_max[c]);
  shares_.speed[c] = std::min(shares_.speed[c], static_cast<float>(share));
  touched_.push_back({c - 1, c});
}

namespace {

/// Parts of a program, each made, sampled and judged by itself.
class PartRepair {
 public:
  PartRepair(const Toolpath& path, const Machine& machine, const AvailableAcceleration& available,
             ProfileShares& shares, ChainMaker& maker, std::vector<double>& errors, std::vector<double>& phases)
      : path_(path),
        machine_(machine),
        available_(available),
        shares_(shares),
        maker_(maker),
        errors_(errors),
        phases_(phases) {}

  /// Time range beside a leg that it affects, with room for the samples that fill the filter: s.
  double reach() const { return 1.5 * available_.window() + 8.0 * available_.period(); }
  /// Legs beside `core` that take `time` at least, and at least two.
  LegRange around(LegRange core, double time, std::size_t least) const {
    const ProfileChain& chain = maker_.chain();
    LegRange wide = core;
    std::size_t count = 0;
    for (double t = 0.0; wide.first > 0 && (t < time || count < least); ++count) t += leg_time(chain, --wide.first);
    count = 0;
    for (double t = 0.0; wide.last + 1 < path_.blocks() && (t < time || count < least); ++count) {
      t += leg_time(chain, ++wide.last);
    }
    return wide;
  }

  /// Makes a part again, samples it and lowers shares where limits break. Returns these places.
  std::vector<LegRange> once(LegRange core, int round) {
    LegRange changed = around(core, 0.5 * reach(), 2);
    for (std::size_t more = 4; !maker_.remake(shares_, changed.first, changed.last, phases_); more *= 2) {
      changed = around(changed, 0.0, more);
    }
    const LegRange judged = around(changed, 0.5 * reach(), 1);
    const LegRange sampled = around(judged, reach(), 2);
    const ProfileChain& chain = maker_.chain();
    ProfileRepair repair(path_, available_, shares_, sampled, round);
    const auto broken = [&](std::int64_t first, std::int64_t last, LimitKind kind, double ratio) {
      repair.limit(first, last, kind, ratio);
    };
    SampleChecker checker(path_, machine_, available_.period(), errors_, broken, sampled.first, sampled.last,
                          sampled.first > 0 ? available_.last().filter().order() + 4 : 0);
    ProfileMotion motion(path_, chain, available_.period(), available_.last().filter(), sampled.first, sampled.last,
                         phases_[sampled.first]);
    motion.note_phases(phases_);
    while (checker.look_on(motion) > 0) {
    }
    checker.finish_part(sampled.last + 1 == path_.blocks());
    repair.errors(chain, errors_, judged);
    return repair.touched();
  }

 private:
  const Toolpath& path_;
  const Machine& machine_;
  const AvailableAcceleration& available_;
  ProfileShares& shares_;
  ChainMaker& maker_;
  std::vector<double>& errors_;
  std::vector<double>& phases_;
};

}  // namespace

void repair_parts(const Toolpath& path, const Machine& machine, const AvailableAcceleration& available,
                  ProfileShares& shares, ChainMaker& maker, std::vector<double>& errors, std::vector<double>& phases,
                  std::vector<LegRange> touched, int round, const Deadline& deadline) {
  PartRepair repair(path, machine, available, shares, maker, errors, phases);
  constexpr int rounds_max = 80;
  for (int i = 0; i < rounds_max && !touched.empty() && !deadline.over(); ++i) {
    std::vector<LegRange> next;
    for (std::size_t k = 0; k < touched.size() && !deadline.over();) {
      LegRange core = touched[k];
      // Parts that affect each other are treated together, as long as there are not too many.
      std::size_t end = repair.around(core, repair.reach(), 2).last;
      for (++k; k < touched.size() && touched[k].first <= end && touched[k].last - core.first < 1000; ++k) {
        core.last = touched[k].last;
        end = repair.around(core, repair.reach(), 2).last;
      }
      const std::vector<LegRange> broken = repair.once(core, round + i);
      next.insert(next.end(), broken.begin(), broken.end());
    }
    touched = merged(std::move(next));
  }
}

}  // namespace accdec
