#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <accdec/files/keys.hpp>
#include <accdec/task.hpp>

// Controllers by name: files of problems/controllers/, built in, and files of users.

namespace accdec {

/// The place where a fact about a controller stands.
struct ControllerSource {
  std::string fact, where;
};

/// One time that a controller takes, as its manual gives it.
struct ControllerStage {
  SettableStage time;      ///< its length_max does not contain the next member
  int length_max_samples;  ///< 0: no cap in samples
};

/// A controller's filter and its sources.
struct Controller {
  std::string name;   ///< of the file, without .toml
  std::string title;  ///< maker, control, kind of filter
  std::string note;   ///< what else to set; may be empty
  std::vector<SettingFamily> families;
  const ShaperInfo* shaper = nullptr;
  double time_constant_step = 0.0, alpha_step = 0.0, cutoff_step = 0.0;  ///< of the families' numbers, SI; 0: not given
  double shaper_frequency_step = 0.0;  ///< Hz, of a control that interpolates; 0: impulses at whole samples
  std::vector<ControllerStage> stages;
  std::vector<DelayKind> delays;                  ///< empty: none is known
  std::vector<std::string> delay_words;           ///< see ControllerSettings
  std::shared_ptr<const ControlDialect> dialect;  ///< null: not known
  bool in_position_actual = false;                ///< see ControllerSettings
  bool in_position_by_axis = false;               ///< see ControllerSettings
  double in_position_latency = 0.0;               ///< s
  double corner_feed_step = 0.05;
  std::vector<std::string> unknown;  ///< what could not be found
  std::vector<std::string> assumed;  ///< in its place
  std::vector<ControllerSource> sources;
};

/// The file of a controller: its keys.
const FileKind& controller_file();

/// Those built in, by name.
std::span<const Controller> controllers();

/// @param text  of a controller's file  @param path  for messages; the name is its stem
/// @throws InputError
Controller parse_controller(std::string_view text, const std::string& path);

/// The built-in controller of this name, or the one of a file where the name ends in ".toml".
/// @throws InputError for a file that is none; std::invalid_argument for an unknown name, with all names and a
/// suggestion
Controller find_controller(const std::string& name_or_path);

/// Its settings at a sample period: steps become multiples of the period, and times of a set that are none are left
/// out.
/// @param period  s
/// @throws std::invalid_argument if no time is a multiple of the period
ControllerSettings settings_of(const Controller& controller, double period);

/// The message at the place of a task file that names its delays: [controller] delays, else its name or file.
InputError error_at_delays(const std::string& task, const std::string& message);
/// The same for the controller's name or file.
InputError error_at_controller(const std::string& task, const std::string& message);
/// The same for its filters: [design] family, else the controller's name or file.
InputError error_at_family(const std::string& task, const std::string& message);

}  // namespace accdec
