#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <accdec/exact/search.hpp>

namespace accdec::comparison {

/// What is left to refute: filters whose cumulative response holds `path`, at instants low .. high (delay questions).
struct Part {
  std::vector<exact::SumBound> path;
  double low = 0.0, high = 0.0;
  int depth = 0;  ///< splits so far
};

/// Least value of a question (an error scale, a delay) over the filters of one order: a bracket, narrowed by branch and
/// bound.
///
/// To refute a value, linear programs with tangent cuts and chords (exact::Relaxation) refute part after part, each
/// by its checked multipliers; a part whose linear program has a solution is split on a cumulative response until that
/// solution holds every limit, which makes it the new best. What was refuted for a value stays so for smaller ones.
class ReferenceSearch {
 public:
  /// @param task  limits, tolerances; kept by reference, a question may change its tolerances
  /// @param delays  at which the limits on the blends hold, per corner
  ReferenceSearch(const Task& task, int order, const std::vector<int>& delays, std::function<bool()> late);
  virtual ~ReferenceSearch() = default;
  /// @param trial  where to begin while nothing is known to hold the limits; doubled until something does
  /// @param tolerance  width of the bracket at a given upper end at which to stop
  void run(double trial, const std::function<double(double)>& tolerance);

  double lower = 0.0;          ///< nothing is below
  std::optional<Filter> best;  ///< with value `upper`
  double upper;                ///< infinite before `best`
  long linear_programs() const { return relaxation_.linear_programs(); }

 protected:
  /// Sets the cones of a part so that they hold for nothing above `value`.
  virtual void place(const Part& part, double value, exact::Box& box) = 0;
  /// Value of a filter that holds the limits; infinite if it does not.
  virtual double value_of(const Filter& filter, const Part& part) = 0;
  /// What multipliers that refute a part at `box` leave of it.
  virtual std::vector<Part> left(const exact::Multipliers& y, const exact::Box& box, const Part& part);
  exact::Outcome solve(const exact::Box& box, bool strongest) { return relaxation_.solve(box, symmetric(), strongest); }
  virtual std::vector<Part> all() const { return {Part{}}; }
  /// Where to look for something better than `best`, with its own response as a guide.
  virtual Part around_best() const { return {}; }
  /// Whether the excess over the tolerances is the value itself, so that smaller steps lead where large ones do.
  virtual bool approach_is_enough() const { return false; }

  bool symmetric() const { return model_.task().design.symmetric; }
  int order() const { return box_.order; }
  const exact::LimitModel& model() const { return model_; }
  /// To be called where `place` changes tolerances of the task.
  void follow_tolerances() { model_.follow_tolerances(); }

 private:
  enum class Answer { refuted, better, unknown };
  /// Refutes every value up to `value`, which becomes `lower`, or finds a better filter. With a gap > 0 it goes on from
  /// there, with a value that much below the new best.
  Answer below(double value, double gap);
  bool offer(const Filter& filter, const Part& part);
  /// Better filters near `best`, as long as they gain `least`.
  void descend(double least);

  exact::LimitModel model_;
  std::function<bool()> late_;
  exact::Relaxation relaxation_;
  exact::Box box_;
};

}  // namespace accdec::comparison
