// Proofs of lower bounds as data, and their checker in interval arithmetic.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <accdec/machine.hpp>
#include <accdec/result.hpp>
#include <accdec/task.hpp>
#include <accdec/verify.hpp>

namespace accdec {

/// The parts of proofs. A proof only names limits of the task and parts of the search. The checker sets up their
/// content itself, so it need not trust anything here.
namespace proof {

// ---- Rows: a limit at one place, in the form "value/bound - 1 <= 0" that holds for every design. Samples, axes,
// corners and modes are counted as in the task; sign -1 is the lower side of a two-sided limit.

/// A limit on differences of the acceleration at start and stop of the fastest leg. It is a limit on tap `sample` and
/// those before it: on two taps for the jerk.
struct TapDifference {
  int sample = 0, sign = 1;
  LimitKind limit = LimitKind::jerk;
  bool operator==(const TapDifference&) const = default;
};
/// Force of one axis at the start along leg 1 or the stop along leg 2: below `force_max`, or below one line of the
/// force-speed curve.
struct EventForce {
  bool stop = false;
  int axis = 0, sample = 0;
  int line = -1;  ///< of the curve, from its first; -1: force_max
  bool operator==(const EventForce&) const = default;
};
/// A limit of one axis while the legs overlap: of the acceleration, of differences of it, or of the force.
struct Blend {
  LimitKind limit = LimitKind::acceleration;
  int corner = 0, axis = 0, sample = 0, sign = 1;
  int line = 0;       ///< of LimitKind::force_speed: as above
  int direction = 1;  ///< of LimitKind::force_speed: sign of the speed that counts
  bool operator==(const Blend&) const = default;
};
/// The corner error seen in one direction.
struct Error {
  int corner = 0;
  double angle = 0.0;  ///< rad, from leg 1's direction
  bool operator==(const Error&) const = default;
};
/// The point at which a cut over ranges touches a leg's distance, a convex function of the sample.
struct Tangent {
  int at = 0;          ///< sample a
  bool after = false;  ///< slope at a + 1 instead of a
  bool high = false;   ///< the product uses the upper bound on the slope, else the lower one
  bool operator==(const Tangent&) const = default;
};
/// The corner error over ranges of delays and samples.
struct RangeError {
  int corner = 0;
  double angle = 0.0;  ///< rad, from leg 1's direction
  Tangent in{}, out{};
  bool operator==(const RangeError&) const = default;
};
/// A corner's path changes from leg 1's strip to leg 2's at a time in a range. Distance left of leg 1 at the last of
/// these times, or gone of leg 2 at the first. It is at most the contour tolerance over sin(theta).
struct Contour {
  int corner = 0;
  bool out = false;  ///< leg 2's
  bool operator==(const Contour&) const = default;
};
/// An axis with dry friction that reverses at a corner: at this sample it moves as along leg 2 (sign 1), or not yet.
struct Reversal {
  int corner = 0, axis = 0, sample = 0, sign = 1;
  bool operator==(const Reversal&) const = default;
};
/// The bound that the target puts on all delays together.
struct Budget {
  bool operator==(const Budget&) const = default;
};
/// Residual vibration of a mode, seen at one phase. A mode of an axis is bounded at starts and stops, or at one blend.
struct Vibration {
  int mode = 0;
  double frequency = 0.0;  ///< Hz
  double angle = 0.0;      ///< rad
  double damping = 0.0;    ///< damping ratio
  int corner = -1;         ///< of a mode of an axis: whose blend; -1: the starts and stops
  bool operator==(const Vibration&) const = default;
};
/// Chord of the power of one axis at the start, or of its regeneration at the stop, over the speeds low .. high (m/s).
struct EventPower {
  bool stop = false;
  int axis = 0, sample = 0;
  double low = 0.0, high = 0.0;
  bool operator==(const EventPower&) const = default;
};
/// The same while the legs overlap; sign: direction of travel.
struct BlendPower {
  bool regeneration = false;
  int corner = 0, axis = 0, sample = 0, sign = 1;
  double low = 0.0, high = 0.0;
  bool operator==(const BlendPower&) const = default;
};
/// Smallest speed: chord of its circle over the directions low .. high (rad from leg 1's).
struct Speed {
  int corner = 0, sample = 0;
  double low = 0.0, high = 0.0;
  bool operator==(const Speed&) const = default;
};
/// Bound on the response B_sample from splits and limits.
struct Response {
  int sample = 0, sign = 1;
  bool operator==(const Response&) const = default;
};

/// One in-position width for all corners. After its longest delay, leg 1 of corner `within` has at most so much left.
/// One sample before its shortest delay, leg 1 of corner `before` has more left.
struct Width {
  int within = 0, before = 0;  ///< corners
  bool operator==(const Width&) const = default;
};

using Row = std::variant<TapDifference, EventForce, Blend, Error, RangeError, Budget, Vibration, EventPower, BlendPower,
                         Speed, Response, Contour, Reversal, Width>;
struct Term {
  Row row;
  double multiplier = 0.0;  ///< >= 0
  bool operator==(const Term&) const = default;
};
/// Rows that together leave no filter, with their multipliers.
using Multipliers = std::vector<Term>;

// ---- Nodes: a part of all designs, refuted or split in two.

/// Every design in the part takes longer than the bound proved.
struct TooLong {
  bool operator==(const TooLong&) const = default;
};
/// The splits leave no response that the limits on starts and stops can reach.
struct Unreachable {
  bool operator==(const Unreachable&) const = default;
};
/// Refuted by a set of multipliers.
struct Refuted {
  int multipliers = 0;
  bool operator==(const Refuted&) const = default;
};
/// Symmetric filters of the part's order, and of one less where the task allows it (else negative).
struct RefutedSymmetric {
  int multipliers = 0, shorter = 0;
  bool operator==(const RefutedSymmetric&) const = default;
};
/// Symmetric filters: two parts follow, the part's order and, where the task allows it, one less.
struct SymmetricOrders {
  bool operator==(const SymmetricOrders&) const = default;
};
/// Delay or sample of a corner: at most `at` in the first part, above it in the second.
struct Split {
  int corner = 0;
  bool on_delay = false;  ///< else on the sample
  int at = 0;
  bool operator==(const Split&) const = default;
};
/// Such a time, in samples: at most `at` in the first part, at least `at` in the second.
struct ContourSplit {
  int corner = 0;
  double at = 0.0;
  bool operator==(const ContourSplit&) const = default;
};
/// The first sample at which an axis that reverses at a corner moves as along leg 2: at most `at` in the first part,
/// above it in the second.
struct ReversalSplit {
  int corner = 0, axis = 0, at = 0;
  bool operator==(const ReversalSplit&) const = default;
};
/// Order of the filter: at most `at` in the first part, above it in the second.
struct OrderSplit {
  int at = 0;
  bool operator==(const OrderSplit&) const = default;
};
/// B_sample: at most `level` in the first part, at least `level` in the second.
struct ResponseSplit {
  int sample = 0;
  double level = 0.0;
  bool operator==(const ResponseSplit&) const = default;
};

/// Refuted by a lemma about its delays.
struct ByLemma {
  int lemma = 0;
  bool operator==(const ByLemma&) const = default;
};

/// Instant at which a corner is passed, a real number of samples: at most `at` in the first part, at least `at` in the
/// second. No design has such an instant: only refutations of single problems do.
struct InstantSplit {
  double at = 0.0;
  bool operator==(const InstantSplit&) const = default;
};
/// All instants of a part refuted. The corner's error in one direction is bounded by tangents of both distances: of leg
/// 1's at an instant, of leg 2's so many samples after its start. One set refutes the first instant, one the last.
struct RefutedInstants {
  double in = 0.0, out = 0.0;
  int first = 0, last = 0;  ///< sets
  bool operator==(const RefutedInstants&) const = default;
};

using Node = std::variant<TooLong, Unreachable, Refuted, RefutedSymmetric, SymmetricOrders, Split, OrderSplit,
                          ResponseSplit, ByLemma, ContourSplit, ReversalSplit, InstantSplit, RefutedInstants>;

// ---- Lemmas: no filter has delays of at most these for these corners together, whatever delays the others have. They
// are proved once and used all over a tree.

struct CornerDelay {
  int corner = 0, delay = 0;
  bool operator==(const CornerDelay&) const = default;
};
/// Filters of any order, by their taps 0 .. order. They are shifted so that the anchor's error is bounded at the sample
/// `at`. The first and the last tap stand for all taps at and beyond them.
struct Window {
  int order = 0, anchor = 0, at = 0;
  bool operator==(const Window&) const = default;
};
struct Lemma {
  int order = 0;                 ///< for filters up to this order; not with a window
  std::optional<Window> window;  ///< for filters of any order
  std::vector<CornerDelay> delays;
  std::vector<CornerDelay> from{};  ///< with delays of at least these; others may have any
  std::vector<Node> tree;           ///< for these delays and all samples
  bool operator==(const Lemma&) const = default;
};

// ---- Kinds of proofs.

/// A limit is broken already at constant feed.
struct ConstantFeed {
  bool operator==(const ConstantFeed&) const = default;
};
/// A corner's smallest speed is above what any filter keeps within its error, by a closed form.
struct CornerSpeed {
  bool operator==(const CornerSpeed&) const = default;
};
/// For a given filter, every smaller delay breaks a limit.
struct Enumeration {
  bool operator==(const Enumeration&) const = default;
};
/// Nothing is shorter than a bound: a binary tree over all designs, in preorder.
struct BranchAndBound {
  Objective objective = Objective::cycle;
  double runs = 1.0;                     ///< Objective::cycle
  double tolerance = granted_tolerance;  ///< relative part by which the limits are wider than written
  std::optional<double> bound_samples;   ///< of the objective; none: there is no design at all
  std::vector<std::string> conflict;     ///< where there is no design: the limits in conflict, in words
  /// For tasks where equal corners are merged: the proof's corner for every corner of the task. The proof's corners are
  /// numbered in the order of their first members. Empty: all as in the task.
  std::vector<int> corner_of{};
  /// The proof is about the task's filter and the control's smoothing behind it as one filter, of any taps.
  bool smoothed = false;
  /// The proof is about delays by one in-position width, which are all that the task's control has.
  bool in_position = false;
  std::vector<Multipliers> multipliers;
  std::vector<Lemma> lemmas;
  std::vector<Node> tree;
  bool operator==(const BranchAndBound&) const = default;
};

/// With each corner at its part of the feed, no filter has a lower order.
struct CornerFeedPart {
  /// One per corner, of the step of corner feeds: 0 is an exact stop. The least one that is not below the feed stands
  /// for the feed.
  std::vector<int> multiples;
  BranchAndBound orders{};  ///< of a task of its own, see the page of certificates
  bool operator==(const CornerFeedPart&) const = default;
};
/// A control passes corners at parts of the feed, at feed, or by exact stops. Parts that are not listed are at least as
/// fast as listed ones, and have filters at least as long.
struct CornerFeeds {
  std::optional<double> bound_samples;  ///< of the objective; none: no filter has any way past the corners
  std::vector<CornerFeedPart> parts{};
  bool operator==(const CornerFeeds&) const = default;
};

/// Members of one family that one rule refutes.
struct RefutedMembers {
  std::string family;  ///< as in task files
  std::string rule;    ///< the limit that starts, stops or vibrations break, "delays", or "simulation"
  int members = 0;
  bool operator==(const RefutedMembers&) const = default;
};
/// No member of the families that the task's settings name holds all limits and is shorter. The checker looks at every
/// member itself.
struct FamilyEnumeration {
  std::optional<double> bound_samples;   ///< of the objective; none: no member holds all limits
  std::vector<RefutedMembers> refuted;   ///< all members below the bound
  std::optional<BranchAndBound> taps{};  ///< a bound of free taps and delays
  bool operator==(const FamilyEnumeration&) const = default;
};

}  // namespace proof

/// The reason why nothing is shorter than a result claims, or why there is no design; `accdec.certificate/1` in JSON.
struct Certificate {
  std::variant<proof::ConstantFeed, proof::CornerSpeed, proof::Enumeration, proof::BranchAndBound,
               proof::FamilyEnumeration, proof::CornerFeeds>
      proof;
  bool operator==(const Certificate&) const = default;
};

struct CheckReport {
  bool accepted = false;
  std::string reason;  ///< why not, or what was shown
};

/// Rechecks the bound that a result claims, using only its task and its certificate. The bound is the cycle time if
/// `optimal`, and the lower bound if `feasible`. If `infeasible`, the claim is that there is no design at all. Shares
/// only the model with the exact method. Every row is set up from the task, in interval arithmetic. Every leaf of the
/// proof needs sum_r y_r (row_r - bound_r) > 0 for all filters in the box, with any multipliers y >= 0 (weak duality;
/// Neumaier and Shcherbina, Math. Program. 99, 2004). The tree must cover every order, delay and sample. Designs
/// themselves are checked by `verify_by_simulation`.
/// @param stop  polled; true ends the check, which then has accepted nothing
CheckReport check_certificate(const Task& task, const DesignResult& result, const std::function<bool()>& stop = {});

/// The certificate of a task whose limits contradict each other whatever the filter.
std::shared_ptr<const Certificate> certify_contradiction(const Task& task);

}  // namespace accdec
