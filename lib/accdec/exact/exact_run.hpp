#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>

#include <accdec/exact/exact.hpp>
#include <accdec/exact/joint.hpp>
#include <accdec/exact/search.hpp>
#include <accdec/task/objective.hpp>

namespace accdec {

/// The exact method as a search that can be stopped and continued. Keeps the reference to the task.
class ExactRun {
 public:
  explicit ExactRun(const Task& task);
  ExactRun(const ExactRun&) = delete;
  ExactRun& operator=(const ExactRun&) = delete;

  /// @return as `design_exact`; solver time and evaluations are those of all calls together
  DesignResult go_on(const ExactOptions& options);

 private:
  using Answer = exact::Search::Answer;
  using Clock = std::chrono::steady_clock;
  bool stopped() const;
  bool cancelled() const { return options_.cancel != nullptr && options_.cancel->load(); }
  std::optional<DesignResult> refusal() const;
  void first_designs();
  void offer_shapes();
  void sweep_orders();
  void at_once();
  void together();
  void by_targets();
  std::optional<double> next_target();
  void take(Answer answer, double target);
  bool close_enough() const;
  void tell() const;
  DesignResult conclude();
  void explain(DesignResult& result) const;

  const Task& task_;
  ExactOptions options_;
  Clock::time_point until_;
  double wall_time_ = 0.0;  ///< s, of earlier calls
  const LinearCost cost_;
  const bool convex_, several_, jointly_;
  const bool minimises_;  ///< one tree of linear programs finds the shortest design
  const double fixed_;    ///< of given delays
  double step_ = 0.0;
  exact::Search search_;
  std::unique_ptr<exact::Joint> joint_;
  int least_ = -1;  ///< smallest order that may do; -1: not known yet
  bool swept_ = false, tried_at_once_ = false;
  double low_, high_ = unlimited;       ///< samples; bound and shortest known
  double trial_ = 0.0;                  ///< next bound to try where no design is known
  double climb_ = 0.0, climbed_ = 0.0;  ///< the next step up from a bound and where the last one led; 0: there is none
  double open_ = unlimited;             ///< the least target with a part in which rounding decides
  bool proved_ = false, infeasible_ = false;
};

}  // namespace accdec
