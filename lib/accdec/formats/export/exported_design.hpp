#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <accdec/result.hpp>

// Internal to the exports: what every format says of a design, and one writer a format in a file beside this one.

namespace accdec {

/// A limit of the task, in its usual unit.
struct ExportedLimit {
  std::string kind, axis, corner;  ///< axis and corner are empty where the limit belongs to none
  double bound = 0.0;
  std::string unit;
  std::optional<double> used;     ///< value/bound of the worst sample, as LimitUse; none: not in the result
  std::vector<double> frequency;  ///< Hz, of a vibration: one or a band
  std::vector<double> damping{};  ///< ratio, of a vibration: none, one or a range
  std::string text() const;       ///< "acceleration x 5000 mm/s^2, 97.1 % used"
};

/// A number or word to set in the control.
struct ExportedSetting {
  std::string name, corner, value, unit;  ///< corner and unit are empty where there is none
  std::string text() const;               ///< "MD32410 = 0.018 s"
};

struct ExportedDesign {
  const DesignResult& result;
  const Filter& filter;
  double period;                      ///< s
  std::vector<ExportedLimit> limits;  ///< of the task
  std::string commit;                 ///< of the accdec that writes the export

  /// The control's settings: its family and values, and how each corner's delay is made. Empty if the task names
  /// neither families nor kinds of delays.
  std::vector<ExportedSetting> settings() const;
  /// One fact a line: title, status, times, limits, commit. The user's text stands there unchanged: pass each line
  /// through `ascii_line`, or what the format asks for.
  std::vector<std::string> facts() const;
};

/// Keeps a reference to the result. @throws std::invalid_argument for a result without a filter
ExportedDesign exported_design(const DesignResult& result);

/// A text on one line of printable ASCII: code points above it as \u00e4, control characters as spaces. Sequences
/// that end or begin a comment in C or Structured Text get a space inside.
std::string ascii_line(std::string_view text);

/// A number that every language reads as a floating-point one and reads back as the same double.
std::string real_literal(double value);

std::string csv_export(const ExportedDesign& design);
std::string c_export(const ExportedDesign& design);
std::string json_export(const ExportedDesign& design);
std::string npy_export(const ExportedDesign& design);
std::string cascade_export(const ExportedDesign& design);
std::string matlab_export(const ExportedDesign& design);
std::string structured_text_export(const ExportedDesign& design);
std::string linuxcnc_export(const ExportedDesign& design);
std::string klipper_export(const ExportedDesign& design);
std::string q15_export(const ExportedDesign& design);
std::string q31_export(const ExportedDesign& design);

}  // namespace accdec
