#pragma once

#include <algorithm>
#include <chrono>

#include <accdec/design/explain.hpp>
#include <accdec/design/verify_result.hpp>
#include <accdec/files/seconds_since.hpp>

// Internal to the room: single solves of an explanation, counted, none taken at its word.

namespace accdec {

struct Solved {
  DesignResult result;
  bool designed = false;  ///< a design, verified by simulation
  bool refuted = false;   ///< there is none; proof rechecked
  double bound = 0.0;     ///< s, nothing is shorter; proof rechecked, 0 without one
};

class ExplainSolver {
 public:
  ExplainSolver(const ExplainOptions& options, Explanation& explanation)
      : options_(options), explanation_(explanation) {}

  /// @param any  the first design will do: whether there is one is asked, not how short it is
  Solved operator()(const Task& task, bool any = false) {
    if (options_.progress && explanation_.solves > 0) options_.progress(explanation_.solves, std::max(total_, done()));
    ++explanation_.solves;
    DesignOptions design = options_.design;
    design.progress = nullptr;
    design.time_limit = std::max(1e-3, std::min(design.time_limit, left()));
    if (any) design.gap = 0.999;
    Solved solved;
    solved.result = design_task(task, design);
    solved.designed = solved.result.filter.has_value();
    const bool asks_proof =
        solved.designed ? !any && solved.result.lower_bound.has_value() : solved.result.status == Status::infeasible;
    if (asks_proof && verify_result(solved.result, [this] { return cancelled(); }).accepted) {
      solved.refuted = !solved.designed;
      if (solved.designed) solved.bound = *solved.result.lower_bound;
    }
    if (cancelled()) explanation_.complete = false;
    return solved;
  }

  /// By the user, or by the end of the time.
  bool cancelled() const {
    return left() <= 0.0 || (options_.design.cancel != nullptr && options_.design.cancel->load());
  }
  /// How many more solves are expected from now.
  void expect(int more) { total_ = explanation_.solves + more; }

 private:
  using Clock = std::chrono::steady_clock;
  int done() const { return explanation_.solves + 1; }
  double left() const { return options_.time_limit - seconds_since(began_); }

  const ExplainOptions& options_;
  Explanation& explanation_;
  int total_ = 0;
  Clock::time_point began_ = Clock::now();
};

/// Fills cause and remedies of a task that has no design. In explain_remedies.cpp.
void find_remedies(const Task& task, ExplainSolver& solve, Explanation& explanation);

}  // namespace accdec
