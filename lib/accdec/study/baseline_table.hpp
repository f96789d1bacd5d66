#pragma once

#include <optional>
#include <string>
#include <vector>

#include <accdec/design/baselines.hpp>
#include <accdec/design/design.hpp>

namespace accdec::study {

/// A task's design beside the filters that controllers have, at one sample period.
struct BaselineTable {
  DesignResult design;                   ///< the task's own filter, if any, left aside
  std::vector<BaselineResult> families;  ///< in the order of `baselines()`
  std::optional<DesignResult>
      own;  ///< the task's [baseline] or [filter] with its smallest delays; at the task's period

  /// The family of the least objective; null when none holds.
  const BaselineResult* best() const;
  /// Share of the best family's objective that the design saves; nothing without both.
  std::optional<double> saving() const;
};

/// Within options.time_limit: half of it for the design, what is left for the families.
BaselineTable compare_with_baselines(const Task& task, const DesignOptions& options);
/// The same with a design of the task that is there, without [filter].
BaselineTable compare_with_baselines(const DesignResult& design, const Task& task, const DesignOptions& options);
/// A design that is there beside what families come to within so many seconds.
BaselineTable compare_with_baselines(const DesignResult& design, double seconds);

/// The same task at a sample period that many times shorter: bounds on orders and given delays keep their times.
Task at_shorter_period(Task task, int times);

/// Tables at the task's sample period and at a quarter of it, and what is saved at both. What a saving loses at the
/// shorter period is the rounding of orders and delays to whole samples, and is named so.
std::string baseline_text(const BaselineTable& table, const BaselineTable& quarter);
/// The table at the task's sample period alone.
std::string baseline_text(const BaselineTable& table);

/// One line: the design beside the filter in use today, with its smallest delays under the same limits, and what is
/// saved; or why that filter has none.
/// @param design  with a filter
std::string saving_text(const FilterSpec& today, const DesignResult& design);

}  // namespace accdec::study
