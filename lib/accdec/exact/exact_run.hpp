#pragma once

#include <memory>

#include <accdec/exact/exact.hpp>
#include <accdec/exact/first_designs.hpp>
#include <accdec/exact/joint.hpp>
#include <accdec/exact/search.hpp>
#include <accdec/exact/targets.hpp>
#include <accdec/files.hpp>

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
  bool stopped() const;
  bool cancelled() const { return options_.cancel != nullptr && options_.cancel->load(); }
  void quick_bound();
  void first_designs();
  void sweep_orders();
  void at_once();
  void together();
  void by_targets();
  void take(exact::Search::Answer answer, double target);
  bool close_enough() const;
  void tell() const;
  DesignResult conclude();
  void explain(DesignResult& result) const;

  const Task& task_;
  ExactOptions options_;
  Deadline until_;
  double wall_time_ = 0.0;  ///< s, of earlier calls
  /// minimises: one tree of linear programs finds the shortest design.
  const struct { bool convex, several, jointly, minimises; } kind_;
  exact::Targets targets_;
  exact::Workbench bench_;
  exact::FirstDesigns first_{bench_};
  exact::Search search_{bench_};
  std::unique_ptr<exact::Joint> joint_;
  int least_ = -1;  ///< smallest order that may do; -1: not known yet
  struct {
    bool quick = false, swept = false, tried_at_once = false, proved = false, infeasible = false;
  } done_;
};

}  // namespace accdec
