#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <accdec/design/design_settings.hpp>
#include <accdec/design/taps_of_kinds.hpp>
#include <accdec/plan/feeds/control_delay.hpp>
#include <accdec/plan/filters/representative_task.hpp>
#include <accdec/plan/filters/settings_for_program.hpp>
#include <accdec/plan/filters/settings_members.hpp>
#include <accdec/plan/filters/settings_trials.hpp>
#include <accdec/task/not_of_control.hpp>
#include <accdec/task/settings_text.hpp>

namespace accdec {
namespace {

/// Times of members that are guessed, each once. Keeps the reference.
class MemberGuesses {
 public:
  explicit MemberGuesses(const SettingsTrials& trials) : trials_(trials) {}

  /// Samples, with delays of any number of samples.
  /// @param enough  more may be returned as any such number, also later
  double any(const SettableMember& member, double enough = unlimited) {
    const auto [at, fresh] = any_.try_emplace(member.key(), unlimited);
    if (fresh) at->second = trials_.any(make_filter(member.spec), enough);
    return at->second;
  }

  /// With the control's delays.
  const TimedSetting& of(const SettableMember& member) {
    const auto [at, fresh] = all_.try_emplace(member.key(), std::pair{member, TimedSetting{}});
    TimedSetting& time = at->second.second;
    // The width that suits a tolerance depends little on the filter.
    if (fresh) time = trials_.guess(make_filter(member.spec), any(member), best_.width);
    if (time.samples < best_.samples) best_ = time, best_order_ = member.order();
    return time;
  }

  /// Members all over the families, outwards from the best guess until they only lose. Then steps around the best
  /// guesses that are halved.
  /// @param first  the best plan's so far; null: none
  void spread(const SettableMembers& members, const SettableMember* first, const Effort& until) {
    std::vector<SettableMember> spread = members.spread();
    if (first != nullptr) of(*first);
    // Few orders, far apart, show where the others begin: smooth members, which suit most limits.
    for (const auto& [apart, most_losses] : {std::pair(1.6, 1), {1.0, 8}}) {
      const int middle = best_order_;
      const auto place = [&, smooth = apart > 1.0](const SettableMember& m) {
        return std::pair(std::abs(std::log((m.order() + 1.0) / (middle + 1.0))),
                         smooth ? std::ranges::max(m.lengths) : 0);
      };
      std::ranges::stable_sort(spread, {}, place);
      std::array<int, 2> losses{};  // of the shorter and the longer ones
      std::array<double, 2> next{middle / apart, middle * apart};
      for (const SettableMember& member : spread) {
        if (until.over() && !all_.empty()) break;
        const bool longer = member.order() >= middle;
        if (losses[longer] >= most_losses || (longer ? member.order() < next[1] : member.order() > next[0])) continue;
        next[longer] = longer ? member.order() * apart : member.order() / apart;
        losses[longer] = of(member).samples > clearly_slower * best_.samples ? losses[longer] + 1 : 0;
      }
    }
    std::vector<std::pair<double, SettableMember>> best;
    for (const auto& [key, guessed] : all_) best.emplace_back(guessed.second.samples, guessed.first);
    const auto shorter = [](const auto& a, const auto& b) { return a.first < b.first; };
    std::stable_sort(best.begin(), best.end(), shorter);
    best.resize(std::min(best.size(), starts));
    for (auto& [samples, start] : best) {
      for (int step = members.coarse_step(start); step >= 1; step /= 2) {
        for (bool better = true; better && !until.over();) {
          better = false;
          for (const SettableMember& near : members.around(start, step)) {
            if (until.over()) break;
            const double time = of(near).samples;
            if (time < samples) samples = time, start = near, better = true;
          }
        }
      }
    }
  }

  using Guessed = std::map<std::vector<int>, std::pair<SettableMember, TimedSetting>>;
  /// By their keys.
  const Guessed& all() const { return all_; }
  /// Adds the keys of all members whose time was guessed, be it with any delays.
  void add_to(std::set<std::vector<int>>& keys) const {
    for (const auto& [key, samples] : any_) keys.insert(key);
  }

 private:
  static constexpr std::size_t starts = 3;
  static constexpr double clearly_slower = 1.1;

  const SettingsTrials& trials_;
  std::map<std::vector<int>, double> any_;
  Guessed all_;
  TimedSetting best_;
  int best_order_ = 20;  // a usual one as long as nothing is guessed
};

class MemberSearch {
 public:
  MemberSearch(const Task& task, const SettingsTrials& trials, const Effort& effort,
               const std::function<void(const std::string&)>& tell)
      : task_(task), trials_(trials), effort_(effort), tell_(tell), members_(task), guesses_(trials) {}

  /// @param today  null if there is none
  std::optional<ProgramSettings> run(const FilterSpec* today) {
    search(today);
    plan_guessed(guesses_.all().size());
    if (best_) members_.sort_near(*best_);
    const std::vector<SettableMember>& all = members_.all();
    bool passed = true;
    for (const SettableMember& member : all) passed = (planned_.contains(member.key()) || look(member)) && passed;
    if (!best_ && !passed) take_guess();
    if (!best_) return std::nullopt;
    ProgramSettings result{.chosen = members_.chosen(*best_), .width = time_.width};
    result.members = static_cast<long>(all.size());
    before_.insert(planned_.begin(), planned_.end());
    guesses_.add_to(guessed_before_);
    result.tried = static_cast<long>(before_.size());
    result.guessed = static_cast<long>(guessed_before_.size());
    result.complete = passed && members_.listed();
    if (today_) result.today = members_.chosen(*today_);
    return result;
  }

  /// Plans the settings that promise most, and steps around the best of them.
  /// @param today  null if there is none
  void search(const FilterSpec* today) {
    if (today != nullptr) {
      today_ = members_.same(*today);
      if (today_) offer(*today_);
      for (const SettableMember& member : members_.like(*today)) look(member);
    }
    // One that holds at all feeds shows early which others are not faster.
    for (const SettableMember& member : trials_.at_feed(members_)) look(member);
    if (best_) guesses_.of(*best_);
    guesses_.spread(members_, best_ ? &*best_ : nullptr, effort_.within(part_for_guesses));
    plan_guessed(first_planned);
    if (!best_) return;
    if (!refined_) time_ = trials_.refined(make_filter(best_->spec), time_), refined_ = true;
    for (int step = members_.coarse_step(*best_); step >= 1; step /= 2) {
      for (bool better = true; better && !late();) {
        better = false;
        for (const SettableMember& near : members_.around(*best_, step))
          better = (promises(near) && offer(near)) || better;
      }
    }
  }

  /// Begins with the best of a search among fewer kinds of delays.
  void begin_with(const MemberSearch& fewer) {
    best_ = fewer.best_, time_ = fewer.time_, before_ = fewer.planned_;
    fewer.guesses_.add_to(guessed_before_);
  }

 private:
  static constexpr std::size_t first_planned = 4;
  static constexpr int most_late = 8;
  static constexpr double part_for_guesses = 0.3;  ///< of the work

  /// Once the work is done. If none holds by then, a few more are planned.
  bool late() const { return effort_.over() && (best_ || late_ >= most_late); }

  /// A guess for want of a plan that holds: a slower plan with it may. The setting that holds at all feeds does most
  /// likely, else the best guess.
  void take_guess() {
    double least = unlimited;
    for (const SettableMember& member : trials_.at_feed(members_)) {
      const auto at = guesses_.all().find(member.key());
      if (at == guesses_.all().end() || !(at->second.second.samples < unlimited)) continue;
      best_ = member, time_.width = at->second.second.width;
      return;
    }
    for (const auto& [key, guessed] : guesses_.all()) {
      const TimedSetting& time = guessed.second;
      if (time.samples < least) best_ = guessed.first, time_.width = time.width, least = time.samples;
    }
  }

  /// So many of those guessed, the best guesses first.
  void plan_guessed(std::size_t most) {
    std::vector<std::pair<double, const SettableMember*>> order;
    for (const auto& [key, guessed] : guesses_.all()) {
      if (!planned_.contains(key)) order.emplace_back(guessed.second.samples, &guessed.first);
    }
    std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (std::size_t i = 0; i < std::min(most, order.size()) && order[i].first < time_.samples; ++i)
      offer(*order[i].second);
  }

  /// Whether the member is known not to be better, or has been planned.
  bool look(const SettableMember& member) {
    if (hopeless(member)) return true;
    if (late()) return false;
    offer(member);
    return true;
  }

  /// Whether it would not be better with any delays.
  bool hopeless(const SettableMember& member) {
    return trials_.least(member.order()) >= time_.samples ||
           (!late() && guesses_.any(member, time_.samples) >= time_.samples);
  }

  /// Whether its guess is better than the best plan.
  bool promises(const SettableMember& member) {
    return !late() && trials_.least(member.order()) < time_.samples && guesses_.of(member).samples < time_.samples;
  }

  bool offer(const SettableMember& member) {
    if (late() || planned_.contains(member.key()) || trials_.least(member.order()) >= time_.samples) return false;
    planned_.insert(member.key());
    if (effort_.over()) ++late_;
    const Filter filter = make_filter(member.spec);
    TimedSetting time = trials_.plan(filter, guesses_.of(member).width, !best_, time_.samples);
    // Only what comes near is worth more plans. The first one is refined behind others.
    constexpr double near = 1.01;
    const bool refines = best_ && time.samples < near * time_.samples;
    if (refines) time = trials_.refined(filter, time);
    if (!(time.samples < time_.samples)) return false;
    time_ = time, refined_ = refines;
    best_ = member;
    if (tell_)
      tell_(
          fmt::format("{}: {:.4f} s", settings_in_words(members_.chosen(member)), time.samples * task_.sample_period));
    return true;
  }

  const Task& task_;
  const SettingsTrials& trials_;
  const Effort& effort_;
  const std::function<void(const std::string&)>& tell_;
  SettableMembers members_;
  MemberGuesses guesses_;
  std::set<std::vector<int>> planned_, before_, guessed_before_;  // before: with fewer kinds of delays
  int late_ = 0;                                                  // planned after the work was done
  std::optional<SettableMember> best_, today_;
  bool refined_ = false;  // whether widths around the best one's were planned
  TimedSetting time_;
};

}  // namespace

std::optional<ProgramSettings> settings_for_program(const Toolpath& path, const Task& task, bool keep, Effort effort,
                                                    const std::function<void(const std::string&)>& tell) {
  const SettingsTrials trials(path, task, keep, effort);
  MemberSearch search(task, trials, effort, tell);
  const ControlDelays narrow = planned_control(task, 0.0);
  if (!task.settings->names(DelayKind::in_position) || narrow.names(DelayKind::in_position))
    return search.run(todays_filter(task));
  // Widths take many plans a member. The settings without any are known first.
  constexpr double part_of_fewer = 0.6;
  Task fewer = task;
  std::erase(fewer.settings->delays, DelayKind::in_position);
  Effort until = effort.within(part_of_fewer);
  const SettingsTrials plain(path, fewer, keep, until);
  MemberSearch first(fewer, plain, until, tell);
  first.search(todays_filter(task));
  search.begin_with(first);
  return search.run(todays_filter(task));
}

const FilterSpec* todays_filter(const Task& task) {
  if (task.filter && task.settings && task.settings->names_family()) return &*task.filter;
  return task.baseline ? &*task.baseline : nullptr;
}

std::string todays_filter_not_had(const Task& task) {
  const FilterSpec* const today = todays_filter(task);
  return today != nullptr && task.settings ? today_not_of_control(*task.settings, *today, task.sample_period) : "";
}

bool is_todays(const Task& task, const Filter& filter) {
  const FilterSpec* const today = todays_filter(task);
  return today != nullptr && same_taps(filter, make_filter(*today));
}

namespace {

/// The least time with a filter and the width that it needs. For want of a plan that holds, the width is a guess: a
/// slower plan with it may.
TimedSetting timed(const SettingsTrials& trials, const Filter& filter) {
  const TimedSetting guess = trials.guess(filter, trials.any(filter), 0.0);
  const TimedSetting time = trials.refined(filter, trials.plan(filter, guess.width, true, unlimited));
  return time.samples < unlimited ? time : TimedSetting{unlimited, guess.width};
}

}  // namespace

ChosenSettings taps_to_set(const Task& task, const Filter& set) {
  ChosenSettings chosen = as_settings(set);
  for (const auto* given : {&task.baseline, &task.filter}) {
    if (*given && same_taps(set, make_filter(**given))) chosen.filter = **given;
  }
  return chosen;
}

double width_for_program(const Toolpath& path, const Task& task, const Filter& filter, bool keep, Effort effort) {
  if (task.settings->any_delay() || !task.settings->names(DelayKind::in_position)) return 0.0;
  return timed(SettingsTrials(path, task, keep, effort), filter).width;
}

void offer_averages(const Toolpath& path, const Task& task, bool keep, Effort effort, ProgramFilter& choice) {
  const SettingsTrials trials(path, task, keep, effort);
  double best = unlimited;
  const auto offer = [&](const Filter& filter, const KnownPlan& plan) {
    const TimedSetting time = timed(trials, filter);
    if (choice.filter && !(time.samples < best)) return;
    best = time.samples;
    choice.filter = filter, choice.plan = plan;
    choice.settings = {.chosen = taps_to_set(task, filter), .width = time.width};
  };
  const auto offer_shape = [&](const FilterSpec& shape) {
    const Filter filter = make_filter(shape);
    if (filter.order() >= task.design.order_min && filter.order() <= task.design.order_max) offer(filter, {});
  };
  if (choice.filter) offer(Filter(*std::exchange(choice.filter, std::nullopt)), KnownPlan(choice.plan));
  if (const FilterSpec* today = todays_filter(task)) offer_shape(*today);
  Task averages = task;
  averages.settings->families = {SettingFamily::averages}, averages.settings->stages.assign(2, {});
  if (const auto found = settings_for_program(path, averages, keep, effort, {})) offer_shape(found->chosen.filter);
}

std::string corner_without_stop(const Toolpath& path, const Task& task) {
  if (!runs_on(control_of(task, 0.0))) return "";
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
    if (path.joint[b] == Joint::corner && !(path.tolerance[b] > 0.0))
      return fmt::format(
          "line {} ends in a corner under G61, which needs a stop, and the control's `delays` run on at "
          "every corner: name one that waits, too (exact-stop, in-position, dwell, timed-axis)",
          path.line[b]);
  }
  return "";
}

ProgramFilter settings_filter(const Toolpath& path, const Task& task, bool keep, const Effort& effort,
                              const std::function<void(const std::string&)>& tell) {
  const auto start = std::chrono::steady_clock::now();
  ProgramFilter result;
  result.message = corner_without_stop(path, task);
  if (!result.message.empty()) return result;
  const std::optional<ProgramSettings> found = settings_for_program(path, task, keep, effort, tell);
  result.solver.method = "settings planned one by one";
  result.solver.name = "families";
  result.solver.wall_time = seconds_since(start);
  if (!found) {
    result.message = fmt::format("no setting of {} that was planned holds all limits of the program",
                                 families_in_words(*task.settings));
    constexpr double seconds = 2.0;
    const std::string why = why_no_setting_holds(representative_task(path, task), seconds);
    if (!why.empty()) result.message += fmt::format("; at programmed feeds, {}", why);
    if (keep && runs_on(control_of(task, 0.0)))
      result.message +=
          "; the control's `delays` hold a tolerance by lower feeds alone, and --feeds keep commands the programmed "
          "feeds: use --feeds choose, or name a kind that waits: exact-stop, in-position, dwell, timed-axis";
    return result;
  }
  result.settings = found;
  if (!found->complete && !effort.ended_by_clock()) result.settings->search_limit = effort.most();
  result.solver.evaluations = found->tried;
  result.filter = make_filter(found->chosen.filter);
  return result;
}

}  // namespace accdec
