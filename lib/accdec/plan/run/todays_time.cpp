#include <algorithm>
#include <string>
#include <utility>

#include <fmt/format.h>

#include <accdec/plan/feeds/control_delay.hpp>
#include <accdec/plan/filters/effort.hpp>
#include <accdec/plan/filters/settings_for_program.hpp>
#include <accdec/plan/run/todays_time.hpp>

namespace accdec {

Feeds feeds_of(const Task& task, Feeds asked) {
  return task.settings && waits_at_ends(control_of(task, 0.0)) ? Feeds::keep : asked;
}

std::string breaks_at_feed(const std::vector<SlowedFeeds>& too_fast) {
  const auto slowest = std::ranges::min_element(too_fast, {}, &SlowedFeeds::factor);
  if (slowest == too_fast.end()) return "";
  // Lower feeds keep all that a delay of the control breaks.
  std::string limit = slowest->limit;
  if (limit.starts_with("all limits")) limit.replace(0, 10, "a limit");
  return fmt::format("{} in line {}", limit, slowest->line);
}

TodaysTime todays_time(Toolpath path, const Task& task, Feeds asked, const Deadline& width, const Deadline& plan) {
  const Feeds feeds = feeds_of(task, asked);
  const Filter filter = make_filter(*todays_filter(task));
  mark_waits(path, control_of(task, 0.0));
  // A time limit changes no work, so that whoever has none finds the same.
  const Effort effort(usual_seconds(path.blocks()), width);
  give_control(path, planned_control(task, width_for_program(path, task, filter, feeds == Feeds::keep, effort)));
  const ProgramResult planned = run_program({"", std::move(path), task, feeds, plan}, filter);
  TodaysTime today{.cut = plan.over() || effort.ended_by_clock()};
  if (!planned.verification.feasible) return today;
  if (asked == Feeds::keep) today.breaks = breaks_at_feed(planned.too_fast);
  if (today.breaks.empty()) today.time = planned.cycle_time;
  return today;
}

}  // namespace accdec
