#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include <accdec/plan/feeds/feed_march.hpp>
#include <accdec/plan/feeds/feed_window.hpp>
#include <accdec/simulate/command_stream.hpp>

// Internal to the march: the path in the order of its walk, and the limits on changes of its velocity. Templates,
// because their loops over axes are the march's innermost.

namespace accdec {

/// The pieces of a path in the order in which they are walked.
template <std::size_t axes>
class WalkedPath {
 public:
  /// References are kept.
  WalkedPath(const FeedPath& path, std::span<const FeedPiece> caps, Walk walk)
      : path_(path), caps_(caps), backward_(walk == Walk::backward) {}

  bool backward() const { return backward_; }
  std::size_t pieces() const { return caps_.size(); }
  const FeedPiece& piece(std::size_t i) const { return backward_ ? caps_[caps_.size() - 1 - i] : caps_[i]; }
  /// At rest after piece i in the direction of the walk.
  double rest(std::size_t i) const {
    if (!backward_) return caps_[i].rest;
    const std::size_t at = caps_.size() - 1 - i;
    return at > 0 ? caps_[at - 1].rest : 0.0;
  }
  /// Velocities of the axes at speed v in the direction of the walk.
  AxisRow<axes> velocity(std::uint32_t block, double v) const {
    AxisRow<axes> row{};
    const double* u = direction(block);
    const double s = backward_ ? -v : v;
    for (std::size_t a = 0; a < dimensions(); ++a) row[a] = s * u[a];
    return row;
  }
  std::size_t dimensions() const { return axes > 0 ? axes : path_.dimensions; }
  /// Unit vector of a block, forwards.
  const double* direction(std::uint32_t block) const { return path_.direction.data() + block * dimensions(); }
  float margin(std::uint32_t block) const { return path_.margin[block]; }

 private:
  const FeedPath& path_;
  std::span<const FeedPiece> caps_;
  bool backward_;
};

/// A stretch of the command at one velocity.
template <std::size_t axes>
struct FeedSegment {
  double end;  ///< s
  double speed;
  float margin;
  AxisRow<axes> velocity;
};

inline constexpr double sum_slack = 1e-6;     // relative; sums of times and lengths differ by rounding
inline constexpr double full_change = 0.999;  // of what is allowed: no more is worth a search

/// How a speed uses the limits.
struct FeedVerdict {
  double use = full_change;  ///< largest part of what is allowed, if more than this
  double try_next = 0.0;     ///< a lower speed that may do; 0: unknown
  bool full = false;         ///< a higher speed would use more than is allowed
  double until = unlimited;  ///< s, when more is first used than allowed
};

/// Judges changes of the velocity inside one window by its limits.
template <std::size_t axes>
class ChangeJudge {
 public:
  using Segment = FeedSegment<axes>;
  /// The reference is kept. @param dimensions  of the path  @param backward  walked from its end
  ChangeJudge(const FeedWindow& window, std::size_t dimensions, bool backward)
      : window_(window), dimensions_(dimensions), backward_(backward) {
    for (std::size_t a = 0; a < n(); ++a)
      change_[a] = window.acceleration_change(a), jerk_change_[a] = window.jerk_change(a);
  }

  /// Changes to be judged are those to this segment, until the next one is named.
  void to(const Segment& at) {
    if (at.margin == margin_) return;
    margin_ = at.margin;
    const auto margin = static_cast<double>(at.margin);
    for (std::size_t a = 0; a < n(); ++a) {
      allowed_[a] = change_[a] * margin, jerk_allowed_[a] = jerk_change_[a] * margin;
      passed_[a] = allowed_[a] * full_change, jerk_passed_[a] = jerk_allowed_[a] * full_change;
    }
  }

  /// The change from an earlier segment to the one that was named last.
  /// @param v  speed on trial: where a segment of this speed is too fast, the verdict names a lower one
  void pair(const Segment& at, const Segment& before, double v, FeedVerdict& verdict) const {
    const double scale = backward_ && before.speed > at.speed ? at.speed / before.speed : 1.0;
    if (window_.supply()) supply(at, before, scale, v, verdict);
    bool passed = !window_.loads();  // without a branch for every axis: most changes are allowed
    for (std::size_t a = 0; a < n(); ++a) passed &= std::abs(at.velocity[a] - before.velocity[a] * scale) <= passed_[a];
    if (passed) return;
    for (std::size_t a = 0; a < n(); ++a) {
      const double old = before.velocity[a] * scale, now = at.velocity[a];
      if (!window_.loads() && std::abs(now - old) <= passed_[a]) continue;
      const double allowed =
          window_.loads() ? window_.change(a, now, old, backward_) * static_cast<double>(at.margin) : allowed_[a];
      judge(now, now - old, allowed, at.speed, v, verdict);
    }
  }

  /// The third difference between four segments.
  void jerk(const Segment& at, const Segment& one, const Segment& two, const Segment& both, double v,
            FeedVerdict& verdict) const {
    const auto scale = [&](const Segment& s) { return backward_ && s.speed > at.speed ? at.speed / s.speed : 1.0; };
    const double s1 = scale(one), s2 = scale(two), s3 = scale(both);
    AxisRow<axes> change;
    bool passed = true;
    for (std::size_t a = 0; a < n(); ++a) {
      change[a] = at.velocity[a] - s1 * one.velocity[a] - s2 * two.velocity[a] + s3 * both.velocity[a];
      passed &= std::abs(change[a]) <= jerk_passed_[a];
    }
    if (passed) return;
    for (std::size_t a = 0; a < n(); ++a) {
      if (std::abs(change[a]) > jerk_passed_[a])
        judge(at.velocity[a], change[a], jerk_allowed_[a], at.speed, v, verdict);
    }
  }

 private:
  std::size_t n() const { return axes > 0 ? axes : dimensions_; }
  void supply(const Segment& at, const Segment& before, double scale, double v, FeedVerdict& verdict) const {
    AxisRow<axes> old = before.velocity;
    for (std::size_t a = 0; a < n(); ++a) old[a] *= scale;
    const double use =
        window_.supply_use({at.velocity.data(), n()}, {old.data(), n()}, backward_) / static_cast<double>(at.margin);
    verdict.use = std::max(verdict.use, use);
    if (use <= 1.0 + sum_slack || at.speed != v) return;
    // The power falls at least as fast as the speed.
    const double lower = v / use;
    verdict.try_next = verdict.try_next > 0.0 ? std::min(verdict.try_next, lower) : lower;
  }
  void judge(double now, double change, double allowed, double speed, double v, FeedVerdict& verdict) const {
    const double size = std::abs(change);
    if (size > allowed * verdict.use) verdict.use = allowed > 0.0 ? size / allowed : 1e30;
    if (size <= allowed * full_change || speed != v || now == 0.0) return;
    verdict.full = verdict.full || change * now > 0.0;
    if (size <= allowed * (1.0 + sum_slack)) return;
    // change = now - old; by how much now, in proportion to v, has to shrink
    const double excess = (size - allowed) * (change * now > 0.0 ? 1.0 : -1.0);
    const double lower = v * (1.0 - excess / std::abs(now));
    if (lower > 0.0 && lower < v) verdict.try_next = verdict.try_next > 0.0 ? std::min(verdict.try_next, lower) : lower;
  }

  const FeedWindow& window_;
  std::size_t dimensions_;
  bool backward_;
  float margin_ = -1.0F;                      // of the segment named last
  AxisRow<axes> change_{}, jerk_change_{};    // m/s, without loads
  AxisRow<axes> allowed_{}, jerk_allowed_{};  // of them, to the segment named last
  AxisRow<axes> passed_{}, jerk_passed_{};    // up to these no verdict changes
};

}  // namespace accdec
