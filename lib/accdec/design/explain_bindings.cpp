#include <string_view>
#include <unordered_map>

#include <accdec/design.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/task/simulation.hpp>

namespace accdec {
namespace {

/// A bound of 0 that holds counts as used to the full, whatever its utilisation.
bool full(const LimitUse& use) {
  return use.utilisation >= full_use || use.bound == 0.0;
}

struct Span {
  Event event;
  int zero, last;  ///< rows: k = 0, and the last row of the event
};

void axis_bindings(const SampledResponse& sampled, double period, const Axis& axis, Eigen::Index a,
                   const std::string& corner, std::vector<Binding>& out) {
  const SampledMotion& m = sampled.command;
  const Span spans[] = {{Event::start, m.start, m.cruise_in},
                        {Event::blend, m.corner, m.cruise_out},
                        {Event::stop, m.stop, static_cast<int>(m.velocity.rows()) - 1}};
  const double still = still_part * std::max(m.velocity.row(m.cruise_in).norm(), m.velocity.row(m.cruise_out).norm());
  const std::vector<AxisState> states = axis_states(sampled, axis, a, period, still);
  for (const AxisLimit& limit : axis_limits) {
    const double bound = axis.*limit.bound;
    if (bound >= unlimited) continue;
    for (const Span& span : spans) {
      Binding binding{limit.kind, axis.name, corner, span.event, {}, bound, 0.0};
      for (int row = span.zero; row <= span.last; ++row) {
        if (limit.value(states[static_cast<std::size_t>(row)]) >= full_use * bound)
          binding.samples.push_back(row - span.zero);
      }
      if (!binding.samples.empty()) out.push_back(std::move(binding));
    }
  }
}

}  // namespace

std::vector<Binding> find_bindings(const DesignResult& design) {
  std::vector<Binding> found;
  if (!design.filter) return found;
  const Task& task = design.task;
  std::unordered_map<std::string_view, std::vector<const LimitUse*>> of_corner;  // without limits of axes
  for (const LimitUse& use : design.limits) {
    if (use.axis.empty() && full(use)) of_corner[use.corner].push_back(&use);
  }
  for (std::size_t j = 0; j < task.corners.size(); ++j) {
    const TaskCorner& corner = task.corners[j];
    const CornerResult& measured = design.corners[j];
    const SampledResponse sampled = simulate_response(*design.filter, corner.geometry(), measured.delay,
                                                      task.sample_period, task.machine, measured.feed_part);
    for (std::size_t a = 0; a < task.machine.axes.size(); ++a)
      axis_bindings(sampled, task.sample_period, task.machine.axes[a], static_cast<Eigen::Index>(a), corner.name,
                    found);
    for (const LimitUse* use : of_corner[corner.name])
      found.push_back({use->kind, "", use->corner, use->event, {static_cast<int>(use->sample)}, use->bound, 0.0});
  }
  for (const LimitUse& use : design.limits) {
    if (of_mode(use.kind) && full(use))
      found.push_back({use.kind, use.axis, use.corner, use.event, {}, use.bound, use.frequency, use.damping});
  }
  return found;
}

}  // namespace accdec
