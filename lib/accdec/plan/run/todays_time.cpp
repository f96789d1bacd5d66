#include <utility>

#include <accdec/plan/feeds/control_delay.hpp>
#include <accdec/plan/filters/effort.hpp>
#include <accdec/plan/filters/settings_for_program.hpp>
#include <accdec/plan/run/todays_time.hpp>

namespace accdec {

Feeds feeds_of(const Task& task, Feeds asked) {
  return task.settings && waits_at_ends(control_of(*task.settings, 0.0)) ? Feeds::keep : asked;
}

TodaysTime todays_time(Toolpath path, const Task& task, Feeds feeds, const Deadline& width, const Deadline& plan) {
  const Filter filter = make_filter(*todays_filter(task));
  mark_waits(path, control_of(*task.settings, 0.0));
  // A time limit changes no work, so that whoever has none finds the same.
  const Effort effort(usual_seconds(path.blocks()), width);
  give_control(path,
               planned_control(*task.settings, width_for_program(path, task, filter, feeds == Feeds::keep, effort)));
  const ProgramResult planned = run_program({"", std::move(path), task, feeds, plan}, filter);
  return {planned.verification.feasible ? planned.cycle_time : unlimited, plan.over() || effort.ended_by_clock()};
}

}  // namespace accdec
