#pragma once

#include <string>

namespace accdec {

/// Modal groups of the supported G codes of the RS274/NGC language (NIST, Kramer, Proctor, Messina 2000, table 4). Two
/// words of one group cannot stand in one block. Codes are in tenths: G91.1 is 911.
enum GGroup : int {
  g_motion,
  g_plane,
  g_distance,
  g_arc_distance,
  g_units,
  g_path,
  g_dwell,
  g_cancel_cycle,
  g_cutter,
  g_tool_length,
  g_coordinates,
  g_feed_mode,
  g_spindle_mode,
  g_return,
  g_unknown
};
/// For messages: the codes that `g_group` knows (a test compares).
inline constexpr const char* g_supported =
    "G0 G1 G2 G3 G4 G5 G5.1 G5.2 G5.3 G17 G18 G19 G20 G21 G40 G43 G49 G54 to G59.3 G61 G61.1 G64 G80 G90 "
    "G90.1 G91 G91.1 G94 G96 to G99";
GGroup g_group(int tenths);

/// Modal groups of M codes: stopping, tool change, spindle, coolant, overrides.
enum MGroup : int { m_stop, m_tool, m_spindle, m_coolant, m_override, m_unknown };
/// As `g_supported`.
inline constexpr const char* m_supported = "M0 to M9, M30, M48, M49";
MGroup m_group(int tenths);

/// Threads, rigid tapping, feed a revolution: G33 G33.1 G74 G76 G84 G95.
bool spindle_synchronised(int tenths);

/// "G91.1" of ('G', 911).
std::string code_name(char letter, int tenths);

}  // namespace accdec
