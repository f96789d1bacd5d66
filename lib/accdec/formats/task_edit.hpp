#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <toml++/toml.h>

// Internal to the room: setting values of a task tree by dotted key, for studies.

namespace accdec {

/// A place in a task: "sample_period_ms", "filter.order", "corner.A.error_max_um", "axis.*.jerk_max_mm_s3",
/// "mode.0.frequency_Hz". In [[axis]], [[corner]] and [[mode]] the middle part is a name, a number counted from 0, or *
/// for all.
class TaskKey {
 public:
  /// @throws std::invalid_argument if the key is none of a task file, with a suggestion
  explicit TaskKey(const std::string& dotted);

  /// Sets it; a missing [filter], [design], [program], a first [[axis]] and the [[mode]] behind the last are made.
  /// Numbers of keys that take whole numbers are written as such.
  /// @throws std::invalid_argument if the tree has no such axis, corner or mode
  void set(toml::table& task, const toml::node& value) const;
  void set(toml::table& task, double value) const;

  const std::string& key() const { return parts_.back(); }

 private:
  std::string dotted_;
  std::vector<std::string> parts_;
  bool whole_ = false;  ///< takes whole numbers
};

/// A regular expression that matches the keys which TaskKey takes, as a string of JSON, quoted.
std::string task_key_pattern();

/// The first of some lists of keys that sets the value, or anything in the table, at a JSON pointer of a task
/// ("/corner/0/angle_deg"). None for the whole task, "".
/// @param lists  keys that the task has places for
std::optional<std::size_t> setter_of(const toml::table& task, const std::vector<std::vector<TaskKey>>& lists,
                                     const std::string& pointer);

}  // namespace accdec
