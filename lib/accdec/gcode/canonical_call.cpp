#include <algorithm>
#include <array>
#include <charconv>

#include <accdec/gcode/canonical_call.hpp>

namespace accdec {
namespace {

constexpr std::array<std::string_view, 17> followed{"STRAIGHT_TRAVERSE",
                                                    "STRAIGHT_FEED",
                                                    "ARC_FEED",
                                                    "SET_FEED_RATE",
                                                    "USE_LENGTH_UNITS",
                                                    "SELECT_PLANE",
                                                    "SET_MOTION_CONTROL_MODE",
                                                    "DWELL",
                                                    "PROGRAM_STOP",
                                                    "OPTIONAL_PROGRAM_STOP",
                                                    "PROGRAM_END",
                                                    "SET_G5X_OFFSET",
                                                    "SET_FEED_MODE",
                                                    "SET_XY_ROTATION",
                                                    "SET_G92_OFFSET",
                                                    "USE_TOOL_LENGTH_OFFSET",
                                                    "SET_NAIVECAM_TOLERANCE"};

constexpr std::array<std::string_view, 5> text{"COMMENT", "MESSAGE", "LOG", "LOGOPEN", "LOGAPPEND"};

constexpr std::array<std::string_view, 48> passed_over{"CHANGE_TOOL",
                                                       "CHANGE_TOOL_NUMBER",
                                                       "CLAMP_AXIS",
                                                       "CLEAR_AUX_OUTPUT_BIT",
                                                       "CLEAR_MOTION_OUTPUT_BIT",
                                                       "DISABLE_ADAPTIVE_FEED",
                                                       "DISABLE_FEED_HOLD",
                                                       "DISABLE_FEED_OVERRIDE",
                                                       "DISABLE_SPEED_OVERRIDE",
                                                       "ENABLE_ADAPTIVE_FEED",
                                                       "ENABLE_FEED_HOLD",
                                                       "ENABLE_FEED_OVERRIDE",
                                                       "ENABLE_SPEED_OVERRIDE",
                                                       "FINISH",
                                                       "FLOOD_OFF",
                                                       "FLOOD_ON",
                                                       "IO_PLUGIN_CALL",
                                                       "LOGCLOSE",
                                                       "MIST_OFF",
                                                       "MIST_ON",
                                                       "ON_RESET",
                                                       "ORIENT_SPINDLE",
                                                       "PALLET_SHUTTLE",
                                                       "PLUGIN_CALL",
                                                       "RELOAD_TOOLDATA",
                                                       "SELECT_TOOL",
                                                       "SET_AUX_OUTPUT_BIT",
                                                       "SET_AUX_OUTPUT_VALUE",
                                                       "SET_CUTTER_RADIUS_COMPENSATION",
                                                       "SET_FEED_REFERENCE",
                                                       "SET_MOTION_OUTPUT_BIT",
                                                       "SET_MOTION_OUTPUT_VALUE",
                                                       "SET_SPINDLE_MODE",
                                                       "SET_SPINDLE_SPEED",
                                                       "SET_TOOL_TABLE_ENTRY",
                                                       "SET_TRAVERSE_RATE",
                                                       "SPINDLE_RETRACT",
                                                       "SPINDLE_RETRACT_TRAVERSE",
                                                       "START_CHANGE",
                                                       "START_SPINDLE_CLOCKWISE",
                                                       "START_SPINDLE_COUNTERCLOCKWISE",
                                                       "STOP_CUTTER_RADIUS_COMPENSATION",
                                                       "STOP_SPEED_FEED_SYNCH",
                                                       "STOP_SPINDLE_TURNING",
                                                       "TURN_PROBE_OFF",
                                                       "TURN_PROBE_ON",
                                                       "UNCLAMP_AXIS",
                                                       "USE_NO_SPINDLE_FORCE"};

/// Synchronised motion is printed without the H of its function's name.
constexpr std::array<std::string_view, 10> unsupported{"STRAIGHT_PROBE",
                                                       "RIGID_TAP",
                                                       "START_SPEED_FEED_SYNC",
                                                       "START_SPEED_FEED_SYNCH",
                                                       "START_CUTTER_RADIUS_COMPENSATION",
                                                       "NURBS_FEED",
                                                       "NURBS_G5_FEED",
                                                       "NURBS_G6_FEED",
                                                       "SET_ORIGIN_OFFSETS",
                                                       "CANON_ERROR"};

template <std::size_t N>
bool has(const std::array<std::string_view, N>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool in_name(char c) {
  return (c >= 'A' && c <= 'Z') || c == '_' || (c >= '0' && c <= '9') || c == '.';
}

}  // namespace

CanonicalCall find_call(std::string_view line) {
  // "   12 N0010  NAME(arguments)": numbers of the output line and of the input line may come first.
  std::size_t i = line.find_first_not_of(" \t0123456789");
  std::int64_t program_line = 0;
  if (i != std::string_view::npos && line[i] == 'N' && i + 1 < line.size() &&
      !(line[i + 1] >= 'A' && line[i + 1] <= 'Z')) {
    const std::size_t digits = i + 1;
    i = std::min(line.find_first_not_of("0123456789", digits), line.size());
    if (i - digits == line_number_digits) std::from_chars(line.data() + digits, line.data() + i, program_line);
    i = line.find_first_not_of(". \t", i);
  }
  if (i == std::string_view::npos) return {};
  std::size_t j = i;
  while (j < line.size() && in_name(line[j])) ++j;
  if (j == i || j >= line.size() || line[j] != '(') return {};
  return {line.substr(i, j - i), i, j + 1, program_line};
}

CallKind call_kind(std::string_view name) {
  if (has(followed, name)) return CallKind::followed;
  if (has(text, name)) return CallKind::text;
  // The spindle's number is part of this name.
  if (has(passed_over, name) || (name.starts_with("SPINDLE.") && name.ends_with(".WAIT_ORIENT_COMPLETE"))) {
    return CallKind::passed_over;
  }
  return has(unsupported, name) ? CallKind::unsupported : CallKind::unknown;
}

}  // namespace accdec
