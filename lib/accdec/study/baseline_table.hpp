#pragma once

#include <optional>
#include <string>
#include <vector>

#include <accdec/design.hpp>
#include <accdec/family.hpp>

namespace accdec::study {

/// A task's design beside the filters that controllers have, at one sample period.
struct BaselineTable {
  DesignResult design;                 ///< the task's own filter, if any, left aside
  std::vector<FamilyResult> families;  ///< in the order of `families()`
  std::optional<DesignResult>
      own;  ///< the task's [baseline] or [filter] with its smallest delays; at the task's period

  /// The best of the family that `own` is of; null where it is of none or that family has none.
  const FamilyResult* best_of_own() const;
  /// Every family was searched to the end.
  bool complete() const;

  /// The family of the least objective; null when none holds.
  const FamilyResult* best() const;
  /// Share of the best family's objective that the design saves; nothing without both.
  std::optional<double> saving() const;
};

/// Takes at most options.time_limit: half of it for the design, the rest for the families.
BaselineTable compare_with_baselines(const Task& task, const DesignOptions& options);
/// The same with an existing design of the task, without [filter].
BaselineTable compare_with_baselines(const DesignResult& design, const Task& task, const DesignOptions& options);
/// A design that is there beside what families come to within so many seconds; 0: beside the task's [baseline] alone.
BaselineTable compare_with_baselines(const DesignResult& design, double seconds);

/// The same task at a sample period that is shorter by this factor: bounds on orders and given delays keep their times.
Task at_shorter_period(Task task, int times);

/// Tables at the task's sample period and at a quarter of it, with the saving at both. The part of a saving that
/// disappears at the shorter period is the rounding of orders and delays to whole samples. The text says so.
std::string baseline_text(const BaselineTable& table, const BaselineTable& quarter);
/// The table at the task's sample period alone.
std::string baseline_text(const BaselineTable& table);

/// The design's savings against the task's own filter, by steps; nothing without both.
std::optional<Savings> savings(const BaselineTable& table);
/// The same for people: the filter in use today with its smallest delays under the same limits, and what the design
/// saves, a line for each step. If that filter has no result, it says why. Empty for a table without such a filter.
std::string savings_text(const BaselineTable& table);

}  // namespace accdec::study
