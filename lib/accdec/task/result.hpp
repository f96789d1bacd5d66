#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <accdec/machine/utilisation.hpp>
#include <accdec/nlp/evaluator.hpp>
#include <accdec/task/task.hpp>

namespace accdec {

struct Certificate;  // certificate/certificate.hpp

enum class Status {
  optimal,     ///< verified, and proved that nothing is shorter
  feasible,    ///< verified
  infeasible,  ///< no filter and delays within the task's bounds hold all limits
  failed       ///< no verified answer, for the reason in the message
};
std::string_view to_string(Status status);

/// Why a design ended. After all but `finished` more time might have led further.
enum class StopReason {
  finished,     ///< the method had nothing more to try
  gap_reached,  ///< the gap asked for
  time_limit,
  interrupted  ///< from outside
};
inline constexpr StopReason stop_reasons[] = {StopReason::finished, StopReason::gap_reached, StopReason::time_limit,
                                              StopReason::interrupted};
std::string_view to_string(StopReason reason);

struct CornerResult {
  std::string name;
  int delay = 0;                                                             ///< samples
  double corner_error = 0.0, polyline_error = 0.0, contour_deviation = 0.0;  ///< m, see CornerMeasures
  double speed_min = 0.0;                                                    ///< m/s
  double corner_time = 0.0;                                                  ///< s
};

/// What the independent simulation found.
struct VerificationReport {
  bool performed = false;
  bool feasible = false;
  double max_violation = 0.0;  ///< largest utilisation above 1, minus 1; 0 when feasible to the last bit
  double tolerance = 0.0;      ///< relative violation up to which `feasible` holds
  std::string worst;           ///< the limit in words: "force x: 97.1 % at k = 12 of the stop, corner A"
  bool certificate_checked = false;
  std::string certificate;  ///< what the checker said of the lower bound
};

struct SolverReport {
  std::string method;  ///< "given", "exact", "nlp"
  std::string name;    ///< "ipopt", "clp", ...; empty when nothing was solved
  std::string version;
  std::string claimed;
  long evaluations = 0;
  double wall_time = 0.0;  ///< s
  nlp::Counts counts;      ///< of all single solves together; zero where the method has none
};

/// The answer to a task; `accdec.result/1` in JSON. A result that is neither optimal nor feasible carries no filter,
/// except one made by `evaluate`, which reports a given filter whatever it breaks.
struct DesignResult {
  Task task;
  Status status = Status::failed;
  StopReason stop = StopReason::finished;
  std::optional<Filter> filter;
  std::vector<CornerResult> corners;
  double cycle_time = 0.0;            ///< s, machine time: Objective::cycle of objective.hpp
  double corner_time = 0.0;           ///< s, each corner by itself: Objective::corner
  std::optional<double> lower_bound;  ///< s, proved, of objective()
  std::optional<double> gap;          ///< (objective() - lower_bound)/objective()
  std::vector<LimitUse> limits;
  VerificationReport verification;
  SolverReport solver;
  std::string message;
  std::shared_ptr<const Certificate> certificate;  ///< null when there is none

  /// Whether it holds a filter and delays that were verified.
  bool has_design() const { return status == Status::optimal || status == Status::feasible; }
  /// s; of the two times the one the task asks to minimise.
  double objective() const { return task.design.objective == Objective::cycle ? cycle_time : corner_time; }
};

}  // namespace accdec
