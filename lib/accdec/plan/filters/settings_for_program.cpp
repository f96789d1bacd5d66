#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <accdec/families/settable_search.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/plan/command/choose_feeds.hpp>
#include <accdec/plan/command/program_plan.hpp>
#include <accdec/plan/feeds/control_delay.hpp>
#include <accdec/plan/filters/program_settings.hpp>
#include <accdec/plan/filters/settings_for_program.hpp>
#include <accdec/plan/filters/settings_members.hpp>
#include <accdec/task/settings_text.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// Programs of at most so many blocks are planned at the programmed feeds, too, and repaired to the end.
constexpr std::size_t small_program = 2'000;

/// A plan's time in samples, and its width.
struct Timed {
  double samples = unlimited;
  double width = 0.0;
};

/// Plans a program with one filter after another.
class Trials {
 public:
  Trials(const Toolpath& path, const Task& task, bool keep, const Deadline& deadline)
      : path_(path), task_(task), machine_(program_machine(task.machine, path)), keep_(keep), deadline_(deadline) {
    double time = 0.0;
    for (std::size_t b = 0; b < path.blocks(); ++b) {
      time += path.duration[b];
      if (path.joint[b] == Joint::stop && b + 1 < path.blocks()) ++stops_;
      if (b + 1 == path.blocks() || path.joint[b] != Joint::corner) continue;
      double length = 0.0;
      for (std::size_t a = 0; a < path.dimensions(); ++a)
        length = std::hypot(length, path.point(b + 1)[a] - path.point(b)[a]);
      step_ = std::max(step_, length / path.duration[b] * task.sample_period);
    }
    constexpr double snapped = 1e-5;  // more than durations are lowered by
    moving_ = std::floor(time * (1.0 - snapped) / task.sample_period);
  }

  /// Samples that no plan with a filter of this order undercuts: way over feed, and the filter once a run.
  double least(int order) const { return moving_ + (stops_ + 1.0) * order + 1.0; }

  /// With the width that suits it best. Delays of any number of samples are planned first: if the program takes `below`
  /// samples even so, the delays of the control are not tried.
  Timed with(const Filter& set, double below) const {
    const Filter filter = Response(task_.machine, task_.sample_period).command(set);
    for (const LimitUse& use : vibration_utilisation(filter, task_.sample_period, machine_)) {
      if (use.utilisation > 1.0 + verification_tolerance) return {};
    }
    const ControlDelays control = control_of(*task_.settings, 0.0);
    const double any = samples(filter, {});
    if (control.any() || !(any < below)) return {any, 0.0};
    Timed best{samples(filter, control), 0.0};
    if (!control.names(DelayKind::in_position) || !(step_ > 0.0)) return best;
    const auto offer = [&](int delay) {
      if (delay < 0 || delay > filter.order() || deadline_.over()) return false;
      // In the middle of the widths that give this delay at the fastest corner.
      const double more = delay > 0 ? filter.remaining_moment(delay - 1) : filter.remaining_moment(0) + 1.0;
      const double width = 0.5 * step_ * (filter.remaining_moment(delay) + more);
      const double time = samples(filter, control_of(*task_.settings, width));
      if (!(time < best.samples)) return false;
      best = {time, width}, middle_ = delay;
      return true;
    };
    middle_ = filter.order() / 2;
    const int coarse = std::max(1, filter.order() / 8);
    for (int delay = 0; delay <= filter.order(); delay += coarse) offer(delay);
    for (int step = coarse / 2; step >= 1; step /= 2) {
      const int around = middle_;
      offer(around - step), offer(around + step);
    }
    return best;
  }

 private:
  double samples(const Filter& filter, const ControlDelays& control) const {
    Toolpath path = path_;
    path.control = control;
    double best = unlimited;
    const auto take = [&](const Toolpath& planned, ProgramPlan plan) {
      settle_delays(planned, filter, task_.sample_period, machine_, plan);
      if (all_holds(plan)) best = std::min(best, static_cast<double>(plan.simulation.samples));
    };
    const bool small = path.blocks() <= small_program;
    if (!keep_) {
      const ScheduledPlan chosen =
          schedule_feeds(path, filter, task_.sample_period, machine_, small ? 40 : 3, deadline_);
      take(chosen.path, chosen.plan);
    }
    if (keep_ || small) {
      limit_rapids(path, filter, task_.sample_period, machine_);
      snap_durations(path, filter, task_.sample_period, machine_);
      ProgramPlan plan = plan_program(path, filter, task_.sample_period, machine_, false, deadline_);
      take(path, std::move(plan));
    }
    return best;
  }

  const Toolpath& path_;
  const Task& task_;
  Machine machine_;
  bool keep_;
  const Deadline& deadline_;
  double moving_ = 0.0, stops_ = 0.0;
  double step_ = 0.0;  // m, of the fastest corner
  mutable int middle_ = 0;
};

class MemberSearch {
 public:
  MemberSearch(const Task& task, const Trials& trials, const Deadline& deadline,
               const std::function<void(const std::string&)>& tell)
      : task_(task), trials_(trials), deadline_(deadline), tell_(tell), members_(task) {}

  /// @param today  null if there is none
  std::optional<ProgramSettings> run(const FilterSpec* today) {
    if (today != nullptr) {
      for (const SettableMember& member : members_.like(*today)) offer(member);
    }
    for (const SettableMember& member : members_.spread()) offer(member);
    if (best_) {
      for (int step = members_.coarse_step(*best_); step >= 1; step /= 2) {
        for (bool better = true; better && !late();) {
          better = false;
          for (const SettableMember& near : members_.around(*best_, step)) better = offer(near) || better;
        }
      }
    }
    const std::vector<SettableMember>& all = members_.all();
    bool passed = true;
    for (const SettableMember& member : all) passed = (seen_.contains(member.key()) || look(member)) && passed;
    if (!best_) return std::nullopt;
    ProgramSettings result{.chosen = members_.chosen(*best_), .width = time_.width};
    result.members = static_cast<long>(all.size());
    result.tried = static_cast<long>(seen_.size());
    result.complete = passed && members_.listed();
    return result;
  }

 private:
  bool late() const { return best_ && deadline_.over(); }

  /// Whether the member is known not to be better, or has been planned.
  bool look(const SettableMember& member) {
    if (trials_.least(member.order()) >= time_.samples) return true;
    if (late()) return false;
    offer(member);
    return true;
  }

  bool offer(const SettableMember& member) {
    if (late() || trials_.least(member.order()) >= time_.samples || !seen_.insert(member.key()).second) return false;
    const Timed time = trials_.with(make_filter(member.spec), time_.samples);
    if (!(time.samples < time_.samples)) return false;
    time_ = time;
    best_ = member;
    if (tell_)
      tell_(
          fmt::format("{}: {:.4f} s", settings_in_words(members_.chosen(member)), time.samples * task_.sample_period));
    return true;
  }

  const Task& task_;
  const Trials& trials_;
  const Deadline& deadline_;
  const std::function<void(const std::string&)>& tell_;
  SettableMembers members_;
  std::set<std::vector<int>> seen_;
  std::optional<SettableMember> best_;
  Timed time_;
};

}  // namespace

SettingsForProgram settings_for_program(const Toolpath& path, const Task& task, bool keep, const Deadline& deadline,
                                        const std::function<void(const std::string&)>& tell) {
  const Trials trials(path, task, keep, deadline);
  SettingsForProgram result;
  const std::optional<FilterSpec>& today = task.filter ? task.filter : task.baseline;
  result.best = MemberSearch(task, trials, deadline, tell).run(today ? &*today : nullptr);
  if (!today) return result;
  const Timed time = Trials(path, task, keep, {}).with(make_filter(*today), unlimited);
  if (!(time.samples < unlimited)) return result;
  ProgramSettings now{.chosen = {.filter = *today}, .width = time.width};
  result.today = std::move(now);
  return result;
}

namespace {

std::string beside_free_taps(double free, double time) {
  const double less = time - free;
  if (!(less > 1e-9 * time)) return " With free taps, no faster plan was found.";
  return fmt::format(" Free taps would take {:.6g} s ({:.1f} % less) or less.", free, 100.0 * less / time);
}

}  // namespace

std::string program_settings_answer(const ProgramSettings& settings, double time, bool has_today) {
  std::string text = fmt::format("Set these: {}", settings_in_words(settings.chosen));
  if (settings.chosen.width) text += "; " + width_in_words(*settings.chosen.width);
  for (const DelayKindName& kind : delay_kinds) {
    const auto count = std::count(settings.chosen.delays.begin(), settings.chosen.delays.end(), kind.kind);
    if (count > 0 && kind.kind != DelayKind::continuous)
      text += fmt::format("; {} at {} joint{}", kind.name, count, count == 1 ? "" : "s");
  }
  text += fmt::format(". {:.6g} s for this program, ", time);
  text += settings.complete
              ? fmt::format("no other of {} settings is planned faster.", settings.members)
              : fmt::format("the fastest of {} settings planned, of {}{}.", settings.tried, settings.members,
                            settings.members >= SettableMembers::most ? " or more" : "");
  if (settings.free_taps) text += beside_free_taps(*settings.free_taps, time);
  if (settings.today) {
    const double saved = *settings.today - time;
    text += fmt::format(" Today's setting takes {:.6g} s; ", *settings.today);
    text += saved > 1e-9 * *settings.today
                ? fmt::format("retuning saves {:.4g} s ({:.1f} %).", saved, 100.0 * saved / *settings.today)
                : "retuning saves nothing.";
  } else if (has_today) {
    text += " No plan with today's setting holds all limits.";
  }
  return text + "\n";
}

}  // namespace accdec
