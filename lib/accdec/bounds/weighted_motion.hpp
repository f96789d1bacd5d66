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
  const std::vector<double>& shares(std::size_t leg) const { return shares_[leg]; }
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
/// The derivation, and what the code calls ways and joints, is in THEORY.md, "Weights of a whole motion".
double weighted_time(const WeightedSection& section, const MotionWeights& weights);

}  // namespace accdec
