#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <accdec/comparison/refutation_tree.hpp>
#include <accdec/exact/search.hpp>

namespace accdec::comparison {

/// A part left to refute: filters whose cumulative response holds `path`, at instants low .. high (delay questions).
struct Part {
  std::vector<exact::SumBound> path;
  double low = 0.0, high = 0.0;
  int depth = 0;  ///< splits so far
  int node = 0;   ///< of the tree that records the refutation
};

/// Least value of a question (an error scale, a delay) over the filters of one order: a bracket, narrowed by branch and
/// bound.
///
/// To refute a value, linear programs with tangent cuts and chords (exact::Relaxation) refute part after part, each by
/// its checked multipliers. A part whose linear program has a solution is split on a cumulative response until the
/// solution holds every limit. Then it is the new best. Parts refuted for a value stay refuted for smaller values.
class ReferenceSearch {
 public:
  /// @param task  limits, tolerances; kept by reference, a question may change its tolerances
  /// @param delays  at which the limits on the blends hold, per corner
  ReferenceSearch(const Task& task, int order, const std::vector<int>& delays, std::function<bool()> late);
  virtual ~ReferenceSearch() = default;
  /// @param trial  first value while no filter is known to hold the limits; doubled until one does
  /// @param tolerance  width of the bracket at which to stop, for a given upper end
  void run(double trial, const std::function<double(double)>& tolerance);

  double lower = 0.0;          ///< nothing is below
  std::optional<Filter> best;  ///< with value `upper`
  double upper;                ///< infinite before `best`
  /// Why nothing is up to `lower`; null while nothing is refuted.
  const std::shared_ptr<const Certificate>& proof() const { return proof_; }
  long linear_programs() const { return relaxation_.linear_programs(); }

 protected:
  /// Sets the cones of a part so that nothing above `value` holds them.
  virtual void place(const Part& part, double value, exact::Box& box) = 0;
  /// Value of a filter that holds the limits; infinite if it does not.
  virtual double value_of(const Filter& filter, const Part& part) = 0;
  /// Records that multipliers refuted a part at `box`. @return the parts that are left of it
  virtual std::vector<Part> left(const exact::Multipliers& y, const exact::Box& box, const Part& part);
  exact::Outcome solve(const exact::Box& box, bool strongest) { return relaxation_.solve(box, symmetric(), strongest); }
  virtual std::vector<Part> all() const { return {Part{}}; }
  /// The part in which to look for a filter better than `best`, with its own response as a guide.
  virtual Part around_best() const { return {}; }
  /// Whether the excess over the tolerances is the value itself, so that small steps lead to the same result as large
  /// ones.
  virtual bool approach_is_enough() const { return false; }

  bool symmetric() const { return model_.task().design.symmetric; }
  int order() const { return box_.order; }
  RefutationTree& record() { return record_; }
  const exact::LimitModel& model() const { return model_; }
  /// Call when `place` changes tolerances of the task.
  void follow_tolerances() { model_.follow_tolerances(); }

 private:
  enum class Answer { refuted, better, unknown };
  /// Refutes every value up to `value`, which becomes `lower`, or finds a better filter. With a gap > 0 it continues
  /// with a value that much below the new best.
  Answer below(double value, double gap);
  bool offer(const Filter& filter, const Part& part);
  /// Better filters near `best`, as long as they gain `least`.
  void descend(double least);

  RefutationTree record_;
  std::shared_ptr<const Certificate> proof_;
  exact::LimitModel model_;
  std::function<bool()> late_;
  exact::Relaxation relaxation_;
  exact::Box box_;
};

}  // namespace accdec::comparison
