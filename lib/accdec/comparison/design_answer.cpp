#include <cmath>

#include <fmt/format.h>

#include <accdec/comparison/design_answer.hpp>
#include <accdec/design/formulation.hpp>
#include <accdec/exact/exact.hpp>
#include <accdec/verify.hpp>

namespace accdec::comparison {

DesignAnswer judged_design(const Task& task, const instances::Choice& choice, const std::vector<double>& x,
                           double most_violation, double seconds) {
  DesignAnswer answer;
  std::vector<int> delays;
  Task fixed = task;
  for (std::size_t j = 0; j < task.corners.size(); ++j) {
    const double value = choice.delays[j](x), whole = std::round(value);
    if (!(std::abs(value - whole) <= 1e-3) || whole < 0.0 || whole > 1e6) {
      answer.remark = fmt::format("delay of corner {} is not whole: {:g}", task.corners[j].name, value);
      return answer;
    }
    delays.push_back(static_cast<int>(whole));
    fixed.corners[j].delay = delays.back();
  }
  answer.whole = true;
  DesignResult own = assess(task, filter_from(x, task.design.order_max), delays, true);
  answer.violation = own.verification.max_violation;
  if (own.has_design()) {
    answer.design = std::move(own);
    return answer;
  }
  if (!(answer.violation <= most_violation)) {
    answer.remark = fmt::format("its taps break a limit by {:.2g}, which no tolerance explains", answer.violation);
    return answer;
  }
  if (seconds <= 0.0) {
    answer.in_time = false;
    answer.remark = "not judged in time";
    return answer;
  }
  ExactOptions options;
  options.time_limit = seconds;
  options.certificate = false;
  const DesignResult other = design_exact(fixed, options);
  if (!other.has_design()) {
    answer.in_time = other.status == Status::infeasible || other.stop != StopReason::time_limit;
    if (!answer.in_time) {
      answer.remark = "not judged in time";
      return answer;
    }
    answer.remark = fmt::format("no filter found for its delays: {}", other.message);
    return answer;
  }
  answer.remark = fmt::format("its taps break a limit by {:.2g}; others hold at its delays", answer.violation);
  DesignResult held = assess(task, *other.filter, delays, false);
  if (held.has_design()) answer.design = std::move(held);
  return answer;
}

}  // namespace accdec::comparison
