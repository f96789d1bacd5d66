#pragma once

#include <optional>
#include <vector>

#include <accdec/files.hpp>
#include <accdec/filter.hpp>
#include <accdec/machine.hpp>
#include <accdec/plan/command/program_plan.hpp>
#include <accdec/plan/filters/settings_members.hpp>
#include <accdec/simulate.hpp>
#include <accdec/task.hpp>

namespace accdec {

/// A plan's time in samples, and its in-position width.
struct TimedSetting {
  double samples = unlimited;
  double width = 0.0;  ///< m; 0: none
};

/// The time of a program with one setting of a control after another: guessed for little work, or planned.
class SettingsTrials {
 public:
  /// References are kept.
  /// @param task  with settings  @param keep  at the programmed feeds; else feeds are chosen
  SettingsTrials(const Toolpath& path, const Task& task, bool keep, const Deadline& deadline);

  /// Samples that no plan with a filter of this order undercuts: way over feed, and the filter once a run.
  double least(int order) const { return moving_ + (stops_ + 1.0) * order + 1.0; }

  /// The members that start and stop at the program's highest feed within the weakest axis' limits.
  std::vector<SettableMember> at_feed(const SettableMembers& members) const;

  struct Guess {
    double any = unlimited;  ///< samples, with delays of any number of samples
    TimedSetting best{};     ///< with the delays of the control, at the width that suits it best
  };
  /// Every corner by itself at the programmed feeds, or the first schedule of chosen feeds. A plan also mends what is
  /// broken where moves overlap. That takes a hundred times as long, and makes the program slower.
  Guess guess(const Filter& set) const;

  /// Planned with the guess's width and those around it.
  /// @param thorough  if the guess's width does not do, widths of all sizes are planned
  TimedSetting plan(const Filter& set, const Guess& guess, bool thorough) const;

 private:
  double planned(const Filter& filter, const ControlDelays& control, const Deadline& until) const;
  double scheduled(const Filter& filter, const ControlDelays& control) const;
  /// The filter of the command, behind the control's own smoothing; none if it excites a mode too much.
  std::optional<Filter> command(const Filter& set) const;
  bool has_widths() const;
  /// In the middle of the widths that give this delay at the fastest corner.
  double width_of(const Filter& filter, int delay) const;
  template <class Time>
  void search_width(const Filter& filter, int from, int step, const Time& time, TimedSetting& best) const;

  const Toolpath& path_;
  const Task& task_;
  Machine machine_;
  bool keep_;
  const Deadline& deadline_;
  double feed_step_;  // see corner_feed_step_of
  double moving_ = 0.0, stops_ = 0.0;
  double step_ = 0.0;     // m, of the fastest corner
  double fastest_ = 0.0;  // m/s, programmed
};

}  // namespace accdec
