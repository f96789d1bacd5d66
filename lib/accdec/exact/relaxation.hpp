#pragma once

#include <functional>
#include <memory>
#include <optional>

#include <accdec/exact/limit_model.hpp>
#include <accdec/task/verifier.hpp>

namespace accdec::exact {

/// What the linear program says of a box.
struct Outcome {
  enum Kind { refuted, feasible, unresolved } kind = unresolved;
  Multipliers multipliers;              ///< refuted
  double excess = 0.0;                  ///< of the last linear program over the cones; their own where it is below 0
  std::vector<double> delays, samples;  ///< feasible: d - d1 and k - k1 of each corner, where it is a range
  std::optional<Filter> filter;  ///< feasible: holds all convex limits of the relaxed box, and the chords of the others
};

/// Margin for where limits as written leave nothing but what verification grants does: as much of that as a filter may
/// use and still verify in spite of its own rounding.
inline constexpr double almost_granted = -0.6 * verification_tolerance;

/// What the boxes of one linear program have in common.
enum class BoxKind {
  budget,    ///< any; of several corners the target may bound the delays together
  together,  ///< several corners without a target
  window     ///< windows of exactly the largest order, see window.hpp
};

/// The limits of a box as a linear program (Clp, dual simplex), cut until it is refuted or its solution holds
/// them. One object serves a whole search: tangent cuts and the basis are kept from box to box.
class Relaxation {
 public:
  /// @param largest_order  of all boxes to come
  /// @param stop  polled during a linear program, which then ends unresolved; may be empty
  /// @param margin  not 0: limits are asked for with this relative margin, so that a solution holds them in spite of
  /// its
  ///                rounding; what is refuted is refuted without it
  Relaxation(const LimitModel& model, int largest_order, const std::function<bool()>& stop = {}, double margin = 0.0,
             BoxKind kind = BoxKind::budget);
  ~Relaxation();
  /// @param symmetric  only symmetric filters of the box's order (no shorter ones)
  /// @param strongest  multipliers that refute by as much as further cuts give, for boxes beside this one
  Outcome solve(const Box& box, bool symmetric, bool strongest = false);
  /// A filter of a box of single delays and samples that holds all limits, from one that holds some; none if this way
  /// leads nowhere.
  std::optional<Filter> repair(const Box& box, bool symmetric, const Filter& start);
  /// A filter of such a box that holds all limits but the tolerances, which it comes as close to as this way leads,
  /// from one that holds the limits.
  std::optional<Filter> approach(const Box& box, bool symmetric, const Filter& start);
  long linear_programs() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace accdec::exact
