#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <utility>

#include <accdec/exact/designs.hpp>
#include <accdec/exact/proof_draft.hpp>
#include <accdec/exact/relaxation.hpp>

namespace accdec::exact {

/// The outcome for a box.
enum class BoxState {
  closed,   ///< refuted
  found,    ///< it holds what was looked for
  stopped,  ///< by the caller, or as no more linear programs are allowed
  open      ///< rounding decides
};

/// All steps of a search work with this: the linear programs, the designs found, the target they must be below, and
/// the proof that there are none. Keeps the reference to the task.
class Workbench {
 public:
  explicit Workbench(const Task& task, std::function<bool()> stop, BoxKind kind = BoxKind::budget);

  const Task& task() const { return model_.task(); }
  const LimitModel& model() const { return model_; }
  ProofDraft& draft() { return draft_; }
  const ProofDraft& draft() const { return draft_; }
  Relaxation& relaxation() { return *relaxation_; }
  /// Prepares linear programs of boxes up to this order.
  void size_for(int order);
  long linear_programs() const;

  /// In samples of the task's objective.
  double target() const { return target_; }
  void set_target(double target) { target_ = target; }
  /// Begins a proof for a target.
  void aim(double target);
  bool below_target() const { return designs.any_below(target_); }
  /// All designs.
  Box root() const;
  /// Cuts the box by the target and shrinks its tube where it is needed. False: nothing is left.
  bool narrow(Box& box, proof::Node* why = nullptr) const;

  /// As the caller says.
  bool told_to_stop() const { return stop_(); }
  bool stopped() const { return stop_() || linear_programs() > last_program_; }
  /// From now on at most so many linear programs, until `allow_all`.
  void allow(long more) { last_program_ = linear_programs() + more; }
  void allow_all() { last_program_ = std::numeric_limits<long>::max(); }

  BoxState leave(proof::Node leaf);
  BoxState close_by(int multipliers);
  BoxState undecided() const { return stopped() ? BoxState::stopped : BoxState::open; }

  Designs designs;
  int smallest_order = 0;  ///< that holds the limits not tied to a tolerance, as far as is known

 private:
  LimitModel model_;
  ProofDraft draft_;
  std::function<bool()> stop_;
  BoxKind kind_;
  std::unique_ptr<Relaxation> relaxation_;
  int sized_ = -1;
  long earlier_programs_ = 0;  ///< of relaxations for other orders
  double target_ = 0.0;
  long last_program_ = std::numeric_limits<long>::max();
};

/// Refutes two parts; the second only if the first leaves something to look for.
template <typename Second>
BoxState both(BoxState first, const Second& second) {
  if (first == BoxState::found || first == BoxState::stopped) return first;
  const BoxState state = second();
  return state == BoxState::closed ? first : state;
}

}  // namespace accdec::exact
