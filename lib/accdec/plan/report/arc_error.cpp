#include <accdec/plan/report/arc_error.hpp>
#include <accdec/simulate/arc_points.hpp>

namespace accdec {

std::optional<ArcError> arc_error(const Plan& plan, double sample_period) {
  const bool servo = plan.command() != nullptr && !plan.command()->moved.empty();
  ArcPoints arcs(plan.path, servo);
  if (arcs.empty()) return {};
  Motion motion(plan, sample_period, servo);
  Sample before, now;
  motion.next(before);
  for (std::size_t left = 0; motion.next(now); before = now) {
    const auto [first, last] = motion.blocks();
    arcs.look(before.position.data(), now.position.data(), std::min(left, first), last);
    motion.pass_steady();
    left = first;
  }
  return arcs.worst();
}

}  // namespace accdec
