#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>

#include <accdec/solvers/solver.hpp>
#include <accdec/task/result.hpp>
#include <accdec/task/task.hpp>

namespace accdec {

enum class Method {
  exact,  ///< branch on (N, d, k) with linear programs: proves the shortest corner
  nlp     ///< smooth relaxation, rounding and repair with any registered solver: verified, nothing proved
};

struct DesignOptions {
  Method method = Method::exact;
  std::string solver = "ipopt";                      ///< registry name, for Method::nlp
  solvers::Options solver_options;                   ///< tolerance, seed, native options of every single solve
  double time_limit = 600.0;                         ///< s, for the whole design
  double gap = 0.0;                                  ///< exact: ends once (best - bound)/best is at most this
  const std::atomic<bool>* cancel = nullptr;         ///< ends the search early with the best verified design so far
  std::function<void(const std::string&)> progress;  ///< one line a step; nothing is told when empty
  /// Method::nlp: told of every verified design that is shorter than the one before, with the calls so far.
  std::function<void(double objective, const nlp::Counts& so_far)> improved;
  std::optional<Filter> start;  ///< Method::nlp: where to start from at its order; else, and elsewhere, a trapezoid
  std::optional<bool>
      reduced;              ///< Method::nlp: positions substituted into their bounds; else where the solver needs it
  bool certificate = true;  ///< exact: keep the proof in the result
  int threads = 1;          ///< exact: for the proof of several corners; the answer does not depend on it
};

/// Chooses what the task leaves open (filter, order, delays) for the least cycle time within all limits.
/// The result is verified by simulation, or its status is infeasible or failed and it carries no filter.
/// @throws std::invalid_argument for an unknown solver or native option.
DesignResult design_task(const Task& task, const DesignOptions& options = {});

/// The filter given, delays free (fixed where the task gives them): for every corner the smallest delay at which its
/// error bound and all limits hold. Exhaustive from the smallest delay the corner error allows, so the result is the
/// optimum.
DesignResult design_delays(const Task& task, const DesignOptions& options = {});

/// Filter and delays by nonlinear programming, see Method::nlp. In nlp_search.cpp.
DesignResult design_nlp(const Task& task, const DesignOptions& options = {});

}  // namespace accdec
