#pragma once

#include <optional>
#include <vector>

#include <accdec/filter.hpp>
#include <accdec/machine.hpp>
#include <accdec/plan/command/choose_feeds.hpp>
#include <accdec/plan/filters/effort.hpp>
#include <accdec/plan/filters/pairwise_times.hpp>
#include <accdec/plan/filters/settings_members.hpp>
#include <accdec/plan/filters/width_choices.hpp>
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
  /// @param effort  counts the work, and ends it
  SettingsTrials(const Toolpath& path, const Task& task, bool keep, Effort& effort);

  /// Samples that no plan with a filter of this order undercuts: way over feed, and the filter once a run.
  double least(int order) const { return moving_ + (stops_ + 1.0) * order + 1.0; }

  /// The members that start and stop at the program's highest feed within the weakest axis' limits.
  std::vector<SettableMember> at_feed(const SettableMembers& members) const;

  /// Samples guessed, with delays of any number of samples. At the programmed feeds every corner is by itself; else it
  /// is the first schedule of chosen feeds. A plan also mends what is broken where moves overlap. That takes longer,
  /// and makes the program slower.
  /// @param enough  more may be returned as any such number
  double any(const Filter& set, double enough = unlimited) const;
  /// The same with the delays of the control, at the width that suits it best.
  /// @param any    of the same filter
  /// @param width  m, near which it is looked for; 0: all widths are
  TimedSetting guess(const Filter& set, double any, double width) const;

  /// Planned with a width.
  /// @param thorough  if this width does not do, widths of all sizes are planned, and the best of them counts; at the
  ///                  programmed feeds, the widest that does
  /// @param than      samples; at the programmed feeds, widths whose guess takes as many are passed over
  TimedSetting plan(const Filter& set, double width, bool thorough, double than) const;
  /// The same with the best of the widths around that of a plan.
  TimedSetting refined(const Filter& set, const TimedSetting& planned) const;

 private:
  double planned(const Filter& filter, const ControlDelays& control, const Deadline& until) const;
  double scheduled(const Filter& filter, const ControlDelays& control) const;
  /// `any` at the programmed feeds.
  double kept(const Filter& filter, double enough) const;
  /// The filter of the command, behind the control's own smoothing; none if it excites a mode too much.
  std::optional<Filter> command(const Filter& set) const;
  bool has_widths() const;
  bool guesses_kept() const;  ///< at the programmed feeds, too
  bool by_axis() const;
  /// All that differ at the programmed feeds.
  std::vector<WidthChoice> widths_of(const Filter& filter) const;
  double try_width(const Filter& filter, double width, TimedSetting& best) const;
  void try_guesses(const Filter& filter, const std::vector<WidthChoice>& widths, int most, double than,
                   TimedSetting& best) const;
  template <class Time>
  void search_width(const std::vector<WidthChoice>& widths, int from, int step, int finest, const Time& time,
                    TimedSetting& best) const;

  const Toolpath& path_;
  const Task& task_;
  Machine machine_;
  bool keep_;
  Effort& effort_;
  mutable KnownBySpread lost_;  // samples, by lower feeds on curves
  double feed_step_;            // see corner_feed_step_of
  double moving_ = 0.0, stops_ = 0.0;
  std::vector<HeldJoint> joints_;  // corners as programmed
  double fastest_ = 0.0;           // m/s, programmed
};

}  // namespace accdec
