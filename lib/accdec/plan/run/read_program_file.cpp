#include <algorithm>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <accdec/files.hpp>
#include <accdec/files/file_kind.hpp>
#include <accdec/files/text_file.hpp>
#include <accdec/gcode/dialects.hpp>
#include <accdec/gcode/read_error.hpp>
#include <accdec/gcode/run_rs274.hpp>
#include <accdec/program.hpp>
#include <accdec/simulate.hpp>

namespace accdec {
namespace {

/// Reports the kind of a file that is not a program; does nothing if it may be one.
void refuse_other_kinds(const std::string& file) {
  if (!std::filesystem::is_regular_file(file)) return;
  if (const std::string wrong = wrong_kind(read_text_file(file), InputKind::program); !wrong.empty())
    throw std::invalid_argument(file + ": " + wrong);
}

/// See foreign_words.
std::string foreign_at(const std::string& file, std::int64_t number) {
  LineSource source{std::filesystem::path(file)};
  std::string_view line;
  while (source.next(line)) {
    if (source.line_number() == number) return foreign_words(line);
  }
  return "";
}

using Tell = std::function<void(const std::string&)>;

/// G4 is in seconds, as LinuxCNC, GRBL and Mach read it. A dwell that is a minute or longer may be meant in ms.
void say_long_dwells(const Toolpath& path, const std::string& file, const Tell& tell) {
  constexpr double long_dwell = 60.0;
  double longest = path.dwell_first;
  for (const auto& [block, seconds] : path.dwell) longest = std::max(longest, seconds);
  if (!tell || longest < long_dwell) return;
  tell(fmt::format("{}: a G4 dwells {:g} s; FANUC, Haas and Marlin read P as ms, this is in seconds", file, longest));
}

/// Puts a remark before everything, unless the program has one of this head from when it was written before.
void remark(Toolpath& path, const std::string& head, const std::string& text) {
  const bool known = std::any_of(path.kept_words.begin(), path.kept_words.end(),
                                 [&](const auto& p) { return p.words.starts_with(head); });
  if (known) return;
  Toolpath::KeptWords first;
  first.words = head + text;
  path.kept_words.insert(path.kept_words.begin(), std::move(first));
}

std::string words_of(const std::vector<Toolpath::Selected>& systems) {
  std::string words;
  for (const Toolpath::Selected& system : systems) {
    if (system.line > 0) words += (words.empty() ? "" : " ") + system.word;
  }
  return words;
}

/// Work offsets lie in the control, and their distance is in no program: moves from one to another are planned as if
/// they lay in one place.
void say_systems(Toolpath& path, const std::string& file, bool interpreted, const Tell& tell) {
  const std::string dropped = interpreted ? words_of(path.systems) : "";
  if (!dropped.empty())
    remark(path, "(left out of the program: ", dropped + "; the offset in force at the start acts on all of it)");
  if (path.systems.size() < 2) return;
  const Toolpath::Selected& second = path.systems[1];
  const std::string planned = "all is planned as one system, and work offsets that the program does not set count as 0";
  remark(path,
         "(work offsets: ", "line " + std::to_string(second.line) + " selects " + second.word + "; " + planned + ")");
  if (tell) {
    tell(file + ":" + std::to_string(second.line) + ": " + second.word + " selects a second work offset: " + planned +
         (dropped.empty() ? "" : "; --emit leaves out " + dropped));
  }
}

/// Says what our own reader makes of the tools.
/// @throws std::invalid_argument if the program takes a length that nobody gave
void say_tools(Toolpath& path, const std::string& file, const ProgramTools& tools, const Tell& tell) {
  if (path.length_at) {
    const std::string line = std::to_string(*path.length_at);
    if (!tools.length) throw std::invalid_argument(no_tool_length(file, *path.length_at));
    remark(path,
           "(G43: ", "lengths of tools count as 0 in the plan, from line " + line + " on; G43 acts on the machine)");
    return;
  }
  const std::string given = !tools.table.empty() ? tools.table : tools.length ? "--tool-length" : "";
  if (tell && !given.empty())
    tell(given + ": not used, as no word of the program takes a length or diameter of a tool");
}

/// rs274 moves the coordinates by what offsets words set, and drops the words. Whoever runs an emitted program has to
/// know: on a machine with the same offset in force, the tool would go twice as far aside or down.
void say_what_acts(Toolpath& path, const ProgramTools& tools) {
  std::vector<Toolpath::KeptWords> remarks(1);
  remarks[0].words =
      "(offsets that the program sets and cutter compensation are in the coordinates, without their words: they must "
      "not act again)";
  remarks.emplace_back().words =
      tools.length == 0.0 ? "(tool lengths are not in the coordinates, nor is G43: it must act on the machine)"
                          : "(tool lengths by G43 are in the coordinates, G43 is not: it must not act again)";
  path.kept_words.insert(path.kept_words.begin(), remarks.begin(), remarks.end());
}

/// Largest distance in m of chords from their arcs so that planning them is like planning the arc. It is the sagitta a
/// T^2/8 that the arc's fastest motion, v = sqrt(a R), passes in a sample, for any radius. Here a is the smallest
/// acceleration limit of an axis. Longer chords turn the velocity in larger steps than the arc does from sample to
/// sample, and the limits must leave room for that. It is at most 2 um, also without a limit, and at least 0.1 um.
double chord_tolerance(const Task& task) {
  constexpr double least = 1e-7;
  double acceleration = unlimited;
  for (const Axis& axis : task.machine.axes) acceleration = std::min(acceleration, axis.acceleration_max);
  if (!(acceleration < unlimited)) return longest_chords;
  return std::clamp(acceleration * task.sample_period * task.sample_period / 8.0, least, longest_chords);
}

}  // namespace

ProgramFile read_program_file(const std::string& file, const Task& task, const ProgramFileOptions& options,
                              const std::function<void(const std::string&)>& tell) {
  ProgramFile result;
  result.name = file;
  ToolpathOptions& reading = result.reading;
  reading.read.arc_tolerance =
      options.arc_tolerance.value_or(options.fixed.feeds == Feeds::choose ? chord_tolerance(task) : longest_chords);
  reading.widen_arcs = options.fixed.compensate_arcs;
  reading.error_max = task.program_error_max;
  reading.contour_max = task.program_contour_max.value_or(unlimited);
  reading.clamp_feeds = options.fixed.feeds == Feeds::choose;
  reading.rapid_stops = options.rapid_stops;
  reading.read.tools = options.tools.given();
  reading.dwells_before_filter = options.fixed.dwells_before_filter;
  try {
    LineSource source{std::filesystem::path(file)};
    result.path = read_toolpath(source, task.machine, reading);
    if (source.byte_order_mark() && tell) tell(file + ": begins with a byte order mark, which is passed over");
    say_systems(result.path, file, false, tell);
    say_long_dwells(result.path, file, tell);
    say_tools(result.path, file, options.tools, tell);
    return result;
  } catch (const NeedsInterpreter& reason) {
    refuse_other_kinds(file);
    if (const std::string foreign = foreign_at(file, reason.line()); !foreign.empty()) {
      const std::string place = fmt::format("{}:{}:{}: ", file, reason.line(), reason.column());
      throw std::invalid_argument(place + "neither accdec nor LinuxCNC reads this: " + foreign);
    }
    try {
      result.path = read_interpreted(file, options.tools, task.machine, reading, options.deadline);
    } catch (const ReadError&) {
      throw;
    } catch (const std::invalid_argument& refused) {
      throw std::invalid_argument(std::string(reason.what()) + "\n" + refused.what());
    }
    if (tell) tell(std::string(reason.what()) + ": run by rs274");
    result.interpreted = true;
    say_what_acts(result.path, options.tools);
    say_systems(result.path, file, true, tell);
    say_long_dwells(result.path, file, tell);
    return result;
  } catch (const ReadError& error) {
    refuse_other_kinds(file);
    const std::string foreign = foreign_at(file, error.line());
    if (foreign.empty()) throw;
    throw std::invalid_argument(std::string(error.what()) + "\n" + foreign);
  }
}

}  // namespace accdec
