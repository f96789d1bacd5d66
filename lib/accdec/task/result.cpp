#include <accdec/result.hpp>

namespace accdec {

std::string_view to_string(StopReason reason) {
  switch (reason) {
    case StopReason::finished: return "finished";
    case StopReason::gap_reached: return "gap reached";
    case StopReason::time_limit: return "time limit";
    case StopReason::interrupted: return "interrupted";
  }
  return "finished";
}

std::string_view to_string(Status status) {
  switch (status) {
    case Status::optimal: return "optimal";
    case Status::feasible: return "feasible";
    case Status::infeasible: return "infeasible";
    case Status::failed: return "failed";
  }
  return "?";
}

}  // namespace accdec
