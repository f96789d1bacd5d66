#pragma once

#include <cstddef>
#include <vector>

#include <accdec/bounds/leg_plane.hpp>

namespace accdec {

/// Legs from rest to rest as weighted_time sees them. Vectors have one entry for every axis in `axes`.
struct WeightedSection {
  struct AxisLimits {
    double velocity = unlimited, acceleration = unlimited, jerk = unlimited;
  };
  struct Leg {
    AxisVector way{};          ///< m, from joint to joint
    double radius = 0.0;       ///< m, how far from the leg a motion may be
    double tolerance = 0.0;    ///< m, from the joint at its end; of the last one 0
    double feed = unlimited;   ///< m/s, of the whole velocity
    double guess = 0.0;        ///< s, for what it takes
    double reach = unlimited;  ///< s from a joint after which motions are simple
  };
  std::vector<AxisLimits> axes;
  std::vector<Leg> legs;

  bool jerk() const;
  double before(std::size_t leg) const { return leg == 0 ? 0.0 : legs[leg - 1].tolerance; }
  /// The highest speed on a leg. Beside its joints the motion may be as fast as on the next legs.
  double feed(std::size_t leg) const;
};

/// Weights of a motion's acceleration (K, s^2/m), of its jerk (M, s^3/m) and of its ways (p, s^2/m).
///
/// Each leg is cut into pieces at shares of its time. K and M have values at their ends and are linear between them.
/// The joint between two legs has one value for both. p has a value for each piece. A leg has a guess of its time, too.
/// All stand in one vector, in an order that keeps neighbours close.
class MotionWeights {
 public:
  /// @param shares  of every leg, from 0 to 1
  MotionWeights(std::size_t axes, bool jerk, std::vector<std::vector<double>> shares);

  std::size_t axes() const { return axes_; }
  bool jerk() const { return jerk_; }
  std::size_t legs() const { return shares_.size(); }
  std::size_t pieces(std::size_t leg) const { return shares_[leg].size() - 1; }
  double length(std::size_t leg, std::size_t piece) const { return shares_[leg][piece + 1] - shares_[leg][piece]; }
  /// Indices of the first axis' K and M at the beginning of a piece, or the end of the last one.
  std::size_t k(std::size_t leg, std::size_t piece) const {
    return begin_[leg] + piece * (node() + axes_) + (2 * piece > pieces(leg) ? 1 : 0);
  }
  std::size_t m(std::size_t leg, std::size_t piece) const { return k(leg, piece) + axes_; }
  /// Index of the first axis' p.
  std::size_t p(std::size_t leg, std::size_t piece) const { return k(leg, piece) + node(); }
  /// Index of the leg's time, in its middle.
  std::size_t time(std::size_t leg) const { return p(leg, pieces(leg) / 2) + axes_; }
  /// Entries of a piece's end.
  std::size_t node() const { return jerk_ ? 2 * axes_ : axes_; }
  std::vector<double> value;

 private:
  std::size_t axes_;
  bool jerk_;
  std::vector<std::vector<double>> shares_;
  std::vector<std::size_t> begin_;
};

/// A time that no motion over the legs undercuts, s, whatever the weights are; -unlimited if they say nothing.
///
/// The motion x passes joint i at t_i, within its tolerance e. Leg i takes h = t_i+1 - t_i. K, M and p are functions of
/// the share s of that time. The velocity is continuous and zero at both ends, under a jerk limit the acceleration is,
/// too. So
///     0 = sum over legs of (integral of K x'' dt + 1/h integral of K' x' dt).
///
/// K is (K + M'/h) - M'/h. The integral of the first part is at least that of -A |K + M'/h|. The second part becomes
/// M x''' after another integration by parts, at least -J |M|.
///
/// K' is p + (K' - p). The second part gives at least -F |K' - p|. The first part gives p . (x - x before)/h for every
/// piece. At the ends of a leg x is in the joint, but for e. Inside, x is within R of the leg. Let d be a change of p
/// between two pieces. So the pieces give at least
///     ((p_first + p_last) . way/2 - sum of (|d . way|/2 + R |d|))/h.
///
/// Let q and g be p and h of the next leg. The joint between both gives at least -e |p_last/h - q_first/g|. Let f be
/// that vector for the times guessed. Its length is at most half of |f + 2 p_last (1/h - 1/h_guessed)|, and as much of
/// the next leg.
///
/// All of this is a sum over legs. So the times of all legs are at least the sum of the least values, over h, of
///     h + ways/h - F |K' - p| - integral of (A |h K + M'| + J h |M|) ds - halves of both joints.
/// Here h is at least the way over the highest speed. The least value is bounded from step to step of h. The integral
/// is convex in h and the joints are convex in 1/h, so both are below their chords. For long times a straight M is
/// better.
double weighted_time(const WeightedSection& section, const MotionWeights& weights);

}  // namespace accdec
