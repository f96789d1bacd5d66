#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/files.hpp>
#include <accdec/files/text_file.hpp>
#include <accdec/files/units.hpp>
#include <accdec/formats/log_rows.hpp>
#include <accdec/formats/vibration_log_file.hpp>

namespace accdec {
namespace {

constexpr double gap = 1.5;            // of a sample period, the longest step
constexpr double spread_least = 0.02;  // of a frequency, to either side
constexpr const char* allowed_columns =
    "allowed are one time (t, t_ms, time_us ..), accelerations (ax, accel_x, ay_mm_s2 ..) and positions (x_mm, y_um "
    "..)";

struct Column {
  enum class Kind { time, acceleration, position } kind;
  double unit;
  std::string axis;
};

/// The unit that ends a name, which is cut off. None: there is no unit.
const Unit* cut_unit(std::string_view& name) {
  const Unit* unit = unit_in_name(name);
  if (unit != nullptr) name.remove_suffix(unit->suffix.size());
  return unit;
}

bool one_of(const Unit* unit, std::string_view names) {
  return names.find(fmt::format(" {} ", unit->name)) != std::string_view::npos;
}

/// None: no such column is known.
/// @param given  in letters of any size
std::optional<Column> column_of(std::string_view given) {
  std::string lower(given);
  for (char& letter : lower) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  std::string_view name = lower;
  const Unit* unit = cut_unit(name);
  const double factor = unit == nullptr ? 1.0 : 1.0 / unit->divisor;
  if (name == "t" || name == "time") {
    if (unit != nullptr && !one_of(unit, " s ms us ns ")) return std::nullopt;
    return Column{Column::Kind::time, factor, {}};
  }
  const bool accelerates = unit == nullptr || one_of(unit, " m/s^2 mm/s^2 um/s^2 g ");
  for (const std::string_view begin : {"accel_", "a_", "a"}) {
    if (accelerates && name.size() == begin.size() + 1 && name.starts_with(begin))
      return Column{Column::Kind::acceleration, 1.0, std::string(name.substr(begin.size()))};
  }
  if (unit != nullptr && !name.empty() && one_of(unit, " m mm um nm "))
    return Column{Column::Kind::position, factor, std::string(name)};
  return std::nullopt;
}

class VibrationReader {
 public:
  explicit VibrationReader(std::string name) : name_(std::move(name)) {}

  VibrationLog read(std::string_view text) {
    for_each_row(text, [&](std::string_view row, long line) {
      const bool remark = row[row.find_first_not_of(" \t\r")] == '#';
      last_line_ = line;
      if (columns_.empty() && header(row, line, remark)) return;
      if (!remark) values(row, line);
    });
    if (columns_.empty()) throw InputError(name_, last_line_, 1, fmt::format("has no header; {}", allowed_columns));
    if (times_.size() < 3) throw InputError(name_, last_line_, 1, "has fewer than three samples behind its header");
    return evenly_spaced();
  }

 private:
  /// False: a remark that is no header.
  bool header(std::string_view row, long line, bool remark) {
    const std::size_t skipped = remark ? row.find('#') + 1 : 0;
    std::vector<Column> columns;
    for (const LogField& field : log_fields(row.substr(skipped))) {
      const auto column = column_of(field.text);
      if (!column && remark) return true;
      const auto fail = [&](const char* what) {
        throw InputError(name_, line, field.column + static_cast<long>(skipped),
                         fmt::format("column `{}` {}; {}", field.text.substr(0, 40), what, allowed_columns));
      };
      if (!column) fail("is none of those known");
      const auto same = [&](const Column& other) { return other.axis == column->axis && other.kind == column->kind; };
      if (std::any_of(columns.begin(), columns.end(), same)) fail("stands twice");
      columns.push_back(*column);
    }
    const auto timed = [](const Column& c) { return c.kind == Column::Kind::time; };
    if (std::none_of(columns.begin(), columns.end(), timed) || columns.size() < 2) {
      if (remark) return true;
      throw InputError(name_, line, 1,
                       fmt::format("the header has no {}; {}", columns.size() < 2 ? "axis" : "time", allowed_columns));
    }
    columns_ = std::move(columns);
    values_.resize(columns_.size());
    return true;
  }

  void values(std::string_view row, long line) {
    const std::vector<LogField> fields = log_fields(row);
    require_columns(fields.size(), columns_.size(), name_, line);
    for (std::size_t i = 0; i < fields.size(); ++i) {
      const double value = log_number(fields[i], name_, line) * columns_[i].unit;
      if (columns_[i].kind != Column::Kind::time) {
        values_[i].push_back(value);
      } else if (!times_.empty() && !(value > times_.back())) {
        throw InputError(name_, line, fields[i].column,
                         fmt::format("the time {:.9g} s is not after the {:.9g} s before it; allowed are rising times",
                                     value, times_.back()));
      } else {
        times_.push_back(value), lines_.push_back(line);
      }
    }
  }

  VibrationLog evenly_spaced() const {
    const std::size_t count = times_.size();
    VibrationLog log;
    log.last_line = last_line_;
    log.period = (times_.back() - times_.front()) / static_cast<double>(count - 1);
    for (std::size_t k = 1; k < count; ++k) {
      if (const double step = times_[k] - times_[k - 1]; step > gap * log.period)
        throw InputError(
            name_, lines_[k], 1,
            fmt::format("this sample comes {:.6g} ms after the one before; allowed are {:g} times the mean "
                        "of {:.6g} ms: a gap looks like a jolt",
                        1e3 * step, gap, 1e3 * log.period));
    }
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      if (columns_[i].kind == Column::Kind::time) continue;
      std::vector<double> even = interpolated(values_[i], log.period);
      if (columns_[i].kind == Column::Kind::position) {
        for (std::size_t k = 1; k + 1 < count; ++k)
          even[k - 1] = (even[k + 1] - 2.0 * even[k] + even[k - 1]) / (log.period * log.period);
        even[count - 2] = even[count - 1] = 0.0;
      }
      log.axes.push_back(columns_[i].axis);
      log.acceleration.push_back(std::move(even));
    }
    return log;
  }

  std::vector<double> interpolated(const std::vector<double>& values, double period) const {
    std::vector<double> even;
    std::size_t next = 1;
    for (std::size_t k = 0; k < values.size(); ++k) {
      const double t = times_.front() + static_cast<double>(k) * period;
      while (next + 1 < times_.size() && times_[next] < t) ++next;
      const double part = std::clamp((t - times_[next - 1]) / (times_[next] - times_[next - 1]), 0.0, 1.0);
      even.push_back((1.0 - part) * values[next - 1] + part * values[next]);
    }
    return even;
  }

  std::string name_;
  std::vector<Column> columns_;
  std::vector<double> times_;
  std::vector<long> lines_;
  long last_line_ = 1;  // that is not empty
  std::vector<std::vector<double>> values_;
};

/// Four digits, and no more than is known.
double rounded(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 3.0);
  return std::round(value / unit) * unit;
}

Mode bounded(const FoundMode& mode, double residual) {
  const double spread = std::max(mode.spread, spread_least);
  return {mode.frequency * (1.0 - spread), mode.frequency * (1.0 + spread), residual, mode.damping_low,
          mode.damping_high};
}

/// By what the axis vibrated, and for what its errors are derived.
std::string excitation_of(const FoundMode& mode) {
  switch (mode.excitation) {
    case Excitation::jolts:
      return fmt::format("{} jolts; the stretches between them were fitted{}. Errors are those of white noise",
                         mode.jolts,
                         mode.overlaps > 0 ? fmt::format(", {} of them before the ringing ends", mode.overlaps) : "");
    case Excitation::sweep:
      return fmt::format(
          "a sweep of {:.4g} Hz/s, fitted as the jolt of all its frequencies; it shows modes from {:.4g} "
          "to {:.4g} Hz.\n# Errors are those of a steady rate and amplitude, and of white noise",
          mode.sweep.rate, mode.sweep.frequency_low, mode.sweep.frequency_high);
    case Excitation::noise:
      return "noise shakes it all the time; its spectrum was fitted. Errors are those of noise that is steady";
    case Excitation::other: break;
  }
  return "neither jolts, nor steady noise, nor a sweep at a constant rate: no errors are derived";
}

}  // namespace

VibrationLog read_vibration_log(const std::string& path) {
  return VibrationReader(path).read(read_text_file(path, log_size_max));
}

std::vector<Mode> bounded_modes(const std::vector<FoundMode>& modes, double residual) {
  std::vector<Mode> all;
  for (const FoundMode& mode : modes)
    if (mode.certain()) all.push_back(bounded(mode, residual));
  return all;
}

std::string modes_to_toml(const std::vector<FoundMode>& modes, const VibrationLog& log,
                          const std::vector<ModeCost>& costs, double residual, const std::string& log_name) {
  std::vector<std::string> columns;  // a log may have several of one axis
  for (const std::string& axis : log.axes)
    if (std::ranges::find(columns, axis) == columns.end()) columns.push_back(axis);
  std::string text = fmt::format("# found in {}: {} samples of {}, {:.4g} s\n", log_name, log.samples(),
                                 fmt::join(columns, ", "), static_cast<double>(log.samples()) * log.period);
  if (modes.empty()) text += "# no vibration stands out\n";
  for (const std::string& axis : columns) {
    const auto first = std::ranges::find(modes, axis, &FoundMode::axis);
    if (first != modes.end()) text += fmt::format("# axis {}: {}\n", axis, excitation_of(*first));
  }
  if (!modes.empty())
    text += fmt::format(
        "# a [[mode]] is within {:g} % of the frequency and {:g} % of the damping in 99 of 100 cases, as far as\n"
        "# standard errors tell\n",
        100.0 * promised_frequency, 100.0 * promised_damping);
  const auto same_axis = [](const FoundMode& a, const FoundMode& b) { return a.axis == b.axis; };
  if (std::ranges::adjacent_find(modes, same_axis) != modes.end())
    text +=
        "# the power of a mode is what it would have alone. Modes near each other share a part of the spectrum: so\n"
        "# powers may sum up to more than 100 %\n";
  for (const ModeCost& cost : costs) {
    if (cost.more)
      text += fmt::format("# residual_max = {:g} costs {:.4g} ms{}\n", cost.residual, 1e3 * *cost.more,
                          cost.proved ? "" : ", not proved");
    else
      text += fmt::format("# residual_max = {:g}: no design was found\n", cost.residual);
  }
  for (const FoundMode& mode : modes) {
    text += fmt::format(
        "\n# axis {}: {:.4g} Hz, damping {:.3g}; standard errors {:.2g} % and {:.2g} %; {:.3g} % of its ", mode.axis,
        mode.frequency, mode.damping, 100.0 * mode.frequency_error, 100.0 * mode.damping_error, 100.0 * mode.share);
    if (!mode.certain()) {
      text += fmt::format("acceleration (power)\n# uncertain, no [[mode]]: {}\n", mode.doubt);
      continue;
    }
    const Mode held = bounded(mode, residual);
    text += fmt::format(
        "acceleration (power), {}\n[[mode]]\n",
        mode.compared > 0 ? fmt::format("within {:.1f} % over the log", 100.0 * mode.spread)
                          : fmt::format("no parts of the log to compare: widen the ranges by hand, {:.0f} % is assumed",
                                        100.0 * spread_least));
    text += fmt::format("frequency_Hz = [{:.5g}, {:.5g}]\n", rounded(held.frequency_low), rounded(held.frequency_high));
    const std::string low = fmt::format("{:.3g}", held.damping_low), high = fmt::format("{:.3g}", held.damping_high);
    text +=
        low == high ? fmt::format("damping_ratio = {}\n", low) : fmt::format("damping_ratio = [{}, {}]\n", low, high);
    text += fmt::format("residual_max = {:g}\n", residual);
  }
  return text;
}

}  // namespace accdec
