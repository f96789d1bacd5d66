#pragma once

#include <array>
#include <numbers>
#include <string_view>

namespace accdec {

/// Rotary axes count a degree as a millimetre, as feeds and tolerances of controls do. So a metre of one is that many
/// radians.
inline constexpr double radians_per_metre = 1e3 * std::numbers::pi / 180.0;

/// A unit as keys, tables and figures write it.
struct Unit {
  std::string_view suffix;   ///< of names of keys and columns: "_mm_s3" of "jerk_mm_s3"
  std::string_view name;     ///< in tables of keys: "mm/s^3"
  std::string_view printed;  ///< on figures: "mm/s³"
  double divisor = 1.0;      ///< a number in this unit divided by this is the number in SI; degrees are handled in
                             ///< `to_si`
};

/// Units of our files, and others that people write into names. A suffix stands before any shorter suffix that it ends
/// with.
constexpr std::array<Unit, 42> units{{{"_mm_min", "mm/min", "mm/min", 6e4},
                                      {"_mm_s3", "mm/s^3", "mm/s³", 1e3},
                                      {"_mm_s2", "mm/s^2", "mm/s²", 1e3},
                                      {"_mm_s", "mm/s", "mm/s", 1e3},
                                      {"_um_s2", "um/s^2", "µm/s²", 1e6},
                                      {"_um_s", "um/s", "µm/s", 1e6},
                                      {"_N_s_m", "N s/m", "N s/m"},
                                      {"_N_m_s", "N m s", "N m s", 1.0 / (radians_per_metre * radians_per_metre)},
                                      {"_m_min", "m/min", "m/min", 60.0},
                                      {"_m_s3", "m/s^3", "m/s³"},
                                      {"_m_s2", "m/s^2", "m/s²"},
                                      {"_m_s", "m/s", "m/s"},
                                      {"_deg_s3", "deg/s^3", "deg/s³", 1e3},
                                      {"_deg_s2", "deg/s^2", "deg/s²", 1e3},
                                      {"_deg_s", "deg/s", "deg/s", 1e3},
                                      {"_kg_m2", "kg m^2", "kg m²", 1.0 / (radians_per_metre * radians_per_metre)},
                                      {"_N_m", "N m", "N m", 1.0 / radians_per_metre},
                                      {"_rad_s3", "rad/s^3", "rad/s³", radians_per_metre},
                                      {"_rad_s2", "rad/s^2", "rad/s²", radians_per_metre},
                                      {"_rad_s", "rad/s", "rad/s", radians_per_metre},
                                      {"_samples", "samples", "samples"},
                                      {"_mdeg", "mdeg", "mdeg", 1e6},
                                      {"_deg", "degrees", "deg"},
                                      {"_rad", "rad", "rad"},
                                      {"_ms", "ms", "ms", 1e3},
                                      {"_us", "us", "µs", 1e6},
                                      {"_ns", "ns", "ns", 1e9},
                                      {"_mm", "mm", "mm", 1e3},
                                      {"_um", "um", "µm", 1e6},
                                      {"_nm", "nm", "nm", 1e9},
                                      {"_kg", "kg", "kg"},
                                      {"_kHz", "kHz", "kHz", 1e-3},
                                      {"_Hz", "Hz", "Hz"},
                                      {"_hz", "Hz", "Hz"},
                                      {"_kN", "kN", "kN", 1e-3},
                                      {"_kW", "kW", "kW", 1e-3},
                                      {"_1_s", "1/s", "1/s"},
                                      {"_s", "s", "s"},
                                      {"_m", "m", "m"},
                                      {"_N", "N", "N"},
                                      {"_W", "W", "W"},
                                      {"_g", "g", "g", 1e3}}};

/// The unit with this name in tables of keys; null if there is none.
constexpr const Unit* find_unit(std::string_view name) {
  for (const Unit& unit : units) {
    if (unit.name == name) return &unit;
  }
  return nullptr;
}

/// The unit whose suffix ends the name of a key or column. Null if there is none, or nothing before it.
constexpr const Unit* unit_in_name(std::string_view key) {
  for (const Unit& unit : units) {
    if (key.size() > unit.suffix.size() && key.ends_with(unit.suffix)) return &unit;
  }
  return nullptr;
}

}  // namespace accdec
