#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <toml++/toml.h>

// Internal to this folder: setting values of a task tree by dotted key, for studies.

namespace accdec {

/// A place in a task: "sample_period_ms", "filter.order", "corner.A.error_max_um", "axis.*.jerk_max_mm_s3",
/// "mode.0.frequency_Hz". In [[axis]], [[corner]] and [[mode]] the middle part is a name, a number counted from 0, or *
/// for all.
class TaskKey {
 public:
  /// @throws std::invalid_argument if a task file has no such key, with a suggestion
  explicit TaskKey(const std::string& dotted);

  /// Sets the value. Creates a missing [filter], [design], [program], a first [[axis]] and the [[mode]] after the last.
  /// Keys that take whole numbers get whole numbers.
  /// @throws std::invalid_argument if the tree has no such axis, corner or mode
  void set(toml::table& task, const toml::node& value) const;
  void set(toml::table& task, double value) const;

  const std::string& key() const { return parts_.back(); }

 private:
  std::string dotted_;
  std::vector<std::string> parts_;
  bool whole_ = false;  ///< takes whole numbers
};

/// A regular expression that matches the keys of TaskKey, as a quoted JSON string.
std::string task_key_pattern();

/// The first of several lists of keys that sets the value at a JSON pointer of a task, or anything in that table None
/// for the whole task, "".
/// @param lists  keys that the task has
std::optional<std::size_t> setter_of(const toml::table& task, const std::vector<std::vector<TaskKey>>& lists,
                                     const std::string& pointer);

}  // namespace accdec
