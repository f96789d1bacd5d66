#include <fmt/format.h>

#include <accdec/gcode/modal_groups.hpp>

namespace accdec {

GGroup g_group(int tenths) {
  switch (tenths) {
    case 0:
    case 10:
    case 20:
    case 30:
    case 50:
    case 51:
    case 52:
    case 53: return g_motion;
    case 40: return g_dwell;
    case 170:
    case 180:
    case 190: return g_plane;
    case 200:
    case 210: return g_units;
    case 400: return g_cutter;
    case 430:
    case 490: return g_tool_length;
    case 540:
    case 550:
    case 560:
    case 570:
    case 580:
    case 590:
    case 591:
    case 592:
    case 593: return g_coordinates;
    case 610:
    case 611:
    case 640: return g_path;
    case 800: return g_cancel_cycle;
    case 900:
    case 910: return g_distance;
    case 901:
    case 911: return g_arc_distance;
    case 940: return g_feed_mode;
    case 960:
    case 970: return g_spindle_mode;
    case 980:
    case 990: return g_return;
    default: return g_unknown;
  }
}

MGroup m_group(int tenths) {
  switch (tenths) {
    case 0:
    case 10:
    case 20:
    case 300: return m_stop;
    case 60: return m_tool;
    case 30:
    case 40:
    case 50: return m_spindle;
    case 70:
    case 80:
    case 90: return m_coolant;
    case 480:
    case 490: return m_override;
    default: return m_unknown;
  }
}

bool spindle_synchronised(int tenths) {
  for (const int g : {330, 331, 740, 760, 840, 950}) {
    if (tenths == g) return true;
  }
  return false;
}

std::string code_name(char letter, int tenths) {
  return tenths % 10 == 0 ? fmt::format("{}{}", letter, tenths / 10)
                          : fmt::format("{}{}.{}", letter, tenths / 10, tenths % 10);
}

}  // namespace accdec
