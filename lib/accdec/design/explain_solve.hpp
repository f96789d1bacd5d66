#pragma once

#include <algorithm>
#include <chrono>
#include <ctime>

#include <accdec/design.hpp>
#include <accdec/files.hpp>
#include <accdec/verify.hpp>

// Internal to this folder: the single solves of an explanation, counted and rechecked.

namespace accdec {

struct Solved {
  DesignResult result;
  bool designed = false;  ///< a design, verified by simulation
  bool refuted = false;   ///< there is no design; proof rechecked
  double bound = 0.0;     ///< s, lower bound; proof rechecked, 0 without one
};

/// Ratio of wall time to processor time, 1 to 8: other programs take the rest.
inline double slowdown(double wall_seconds, double processor_seconds) {
  constexpr double worth_measuring = 0.2, most = 8.0;
  if (wall_seconds < worth_measuring) return 1.0;
  return std::clamp(wall_seconds / std::max(1e-9, processor_seconds), 1.0, most);
}

class ExplainSolver {
 public:
  /// @param shared  all designs together have the time limit of one, because nothing can be proved of them: each of
  /// them would search until its time is over
  ExplainSolver(const ExplainOptions& options, Explanation& explanation, bool shared = false)
      : options_(options),
        explanation_(explanation),
        time_limit_(shared ? std::min(options.time_limit, options.design.time_limit) : options.time_limit),
        of_each_(shared ? first_share * time_limit_ : options.design.time_limit) {
    if (shared) explanation_.shared = time_limit_;
  }

  /// @param any  stop at the first design: only its existence is asked, not how short it is
  Solved operator()(const Task& task, bool any = false) {
    if (options_.progress && explanation_.solves > 0) options_.progress(explanation_.solves, std::max(total_, done()));
    ++explanation_.solves;
    DesignOptions design = options_.design;
    design.progress = nullptr;
    constexpr double least = 0.3;  // s: in less, a local search finds nothing
    if (explanation_.shared > 0.0 && total_ > 0)
      of_each_ = std::max(least, left() / std::max(1, total_ - explanation_.solves + 1));
    design.time_limit = of_each_;
    if (any) design.exact.gap = 0.999;
    Solved solved;
    solved.result = designed(task, design);
    solved.designed = solved.result.filter.has_value();
    // Settings of a control are as short as their family allows, whatever free taps would do.
    const std::optional<double>& bound =
        solved.result.settings ? solved.result.family_bound : solved.result.lower_bound;
    const bool asks_proof = solved.designed ? !any && bound.has_value() : solved.result.status == Status::infeasible;
    if (asks_proof && verify_result(solved.result, [this] { return cancelled(); }).accepted) {
      solved.refuted = !solved.designed;
      if (solved.designed) solved.bound = *bound;
    }
    if (cancelled()) explanation_.complete = false;
    return solved;
  }

  /// Cancelled by the user or by the end of the time.
  bool cancelled() const {
    return left() <= 0.0 || (options_.design.cancel != nullptr && options_.design.cancel->load());
  }
  /// How many more solves are expected from now.
  void expect(int more) { total_ = explanation_.solves + more; }

 private:
  using Clock = std::chrono::steady_clock;

  /// The limit of a single design is processor time, so that its answer depends little on other programs. The wall time
  /// limit is extended by the time lost so far. A design that ended early for this reason is repeated.
  DesignResult designed(const Task& task, DesignOptions design) {
    const double limit = design.time_limit;
    for (bool again = false;; again = true) {
      const bool alone = explanation_.shared == 0.0;
      design.time_limit = std::max(1e-3, std::min(alone ? limit * slowdown_ : limit, left()));
      const std::clock_t processor = std::clock();
      const Clock::time_point began = Clock::now();
      DesignResult result = design_task(task, design);
      const double used = static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC;
      slowdown_ = slowdown(std::chrono::duration<double>(Clock::now() - began).count(), used);
      const bool cut_short = alone && result.stop == StopReason::time_limit && used < 0.9 * limit;
      if (!cut_short || again || cancelled()) return result;
    }
  }

  int done() const { return explanation_.solves + 1; }
  double left() const { return time_limit_ - seconds_since(began_); }

  static constexpr double first_share = 0.25;  // for the task as it is
  const ExplainOptions& options_;
  Explanation& explanation_;
  double time_limit_, of_each_;  // s
  int total_ = 0;
  double slowdown_ = 1.0;
  Clock::time_point began_ = Clock::now();
};

/// Fills cause and remedies of a task that has no design. In explain_remedies.cpp.
void find_remedies(const Task& task, ExplainSolver& solve, Explanation& explanation);

}  // namespace accdec
