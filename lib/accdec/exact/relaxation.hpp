#pragma once

#include <functional>
#include <memory>
#include <optional>

#include <accdec/exact/limit_model.hpp>
#include <accdec/verify.hpp>

namespace accdec::exact {

/// Result of the linear program of a box.
struct Outcome {
  enum Kind { refuted, feasible, unresolved } kind = unresolved;
  Multipliers multipliers;              ///< refuted
  double excess = 0.0;                  ///< of the last linear program over the cones; below 0 the cones' own
  std::vector<double> delays, samples;  ///< feasible: d - d1 and k - k1 of each corner, where it is a range
  std::optional<Filter> filter;  ///< feasible: holds all convex limits of the relaxed box, and the chords of the others
};

/// Margin for cases where a design exists only within what verification grants beyond the limits. A filter may use this
/// part of it and still verify despite its own rounding.
inline constexpr double almost_granted = -0.6 * verification_tolerance;

/// Kind of all boxes of one linear program.
enum class BoxKind {
  budget,    ///< any; with several corners the target may bound the delays together
  together,  ///< several corners without a target
  window     ///< windows of exactly the largest order, see window.hpp
};

/// The limits of a box as a linear program. Cuts are added until the box is refuted or the solution holds the limits.
/// One object serves a whole search: tangent cuts and the basis are kept from box to box.
class Relaxation {
 public:
  /// @param largest_order  of all boxes to come
  /// @param stop  polled during a linear program, which then ends unresolved; may be empty
  /// @param margin  not 0: limits get this relative margin, so that a solution holds them despite rounding; refutations
  ///                do without it
  Relaxation(const LimitModel& model, int largest_order, const std::function<bool()>& stop = {}, double margin = 0.0,
             BoxKind kind = BoxKind::budget);
  ~Relaxation();
  /// @param symmetric  only symmetric filters of the box's order (no shorter ones)
  /// @param strongest  multipliers that refute by the largest amount further cuts give, for use in neighbouring boxes
  Outcome solve(const Box& box, bool symmetric, bool strongest = false);
  /// Finds a filter that holds all limits, from one that holds some, in a box of single delays and samples. None if
  /// this fails.
  std::optional<Filter> repair(const Box& box, bool symmetric, const Filter& start);
  /// Finds a filter of such a box that holds all limits except the tolerances, and comes as close to these as this
  /// method can. `start` holds these limits.
  std::optional<Filter> approach(const Box& box, bool symmetric, const Filter& start);
  long linear_programs() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace accdec::exact
