#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/files.hpp>
#include <accdec/files/text_file.hpp>
#include <accdec/files/units.hpp>
#include <accdec/formats/filter_table.hpp>
#include <accdec/formats/log_rows.hpp>
#include <accdec/formats/motion_log_file.hpp>

namespace accdec {
namespace {

constexpr double jitter_max = 0.1;  // of a sample period
constexpr int most_rows = 100;      // of a log in a sample period; more are a wrong unit of the time
constexpr const char* allowed_columns =
    "allowed are one time (t_s, t_ms or t_us, or time_ ..) and axes with their unit (x_mm, y_um, z_m, a_deg); "
    "names without unit take those of --units, such as s,mm";

/// SI of one unit of a column; none for a unit that is not allowed. Degrees are handled like millimetres everywhere.
std::optional<double> unit_of(std::string_view column, bool time) {
  const Unit* unit = unit_in_name(column);
  if (unit == nullptr) return std::nullopt;
  if (!time && unit->name == "degrees") return 1e-3;
  const std::string_view allowed = time ? " s ms us ns " : " m mm um nm ";
  if (allowed.find(fmt::format(" {} ", unit->name)) == std::string_view::npos) return std::nullopt;
  return 1.0 / unit->divisor;
}

class LogReader {
 public:
  LogReader(std::string name, double period, const ColumnUnits& units)
      : name_(std::move(name)), period_(period), units_(units) {}

  MotionLog read(std::string_view text) {
    for_each_row(text, [&](std::string_view row, long line) {
      last_line_ = line;
      if (row[row.find_first_not_of(" \t\r")] == '#') return;
      if (columns_.empty())
        header(row, line);
      else
        values(row, line);
    });
    if (columns_.empty()) throw InputError(name_, last_line_, 1, fmt::format("has no header; {}", allowed_columns));
    if (log_.samples() == 0)
      throw InputError(name_, last_line_, 1,
                       "has no samples behind its header; needed are those of a move from rest to rest");
    check_pace();
    for (std::vector<double>& position : log_.position) keep_one_a_period(position);
    if (log_.samples() < static_cast<std::size_t>(log_samples_least))
      throw InputError(name_, last_line_, 1,
                       fmt::format("the log ends here, after {} samples; allowed are {} or more", log_.samples(),
                                   log_samples_least));
    return std::move(log_);
  }

 private:
  struct Column {
    bool time = false;
    double unit = 1.0;
    std::size_t axis = 0;
  };

  void header(std::string_view row, long line) {
    bool timed = false;
    for (const LogField& field : log_fields(row)) {
      const bool unit_named = unit_in_name(field.text) != nullptr;
      const std::string_view name = unit_named ? field.text.substr(0, field.text.rfind('_')) : field.text;
      const auto fail = [&](const std::string& what) {
        throw InputError(name_, line, field.column,
                         fmt::format("column `{}` {}; {}", field.text.substr(0, 40), what, allowed_columns));
      };
      Column column{.time = name == "t" || name == "time", .unit = 1.0, .axis = log_.axes.size()};
      const auto si = unit_named ? unit_of(field.text, column.time) : column.time ? units_.time : units_.position;
      if (!si) fail("names no known unit");
      column.unit = *si;
      if (column.time && std::exchange(timed, true)) fail("is a second time");
      if (!column.time && (name.empty() || std::find(log_.axes.begin(), log_.axes.end(), name) != log_.axes.end()))
        fail(name.empty() ? "names no axis" : "stands twice");
      if (!column.time) log_.axes.emplace_back(name);
      columns_.push_back(column);
    }
    if (!timed || log_.axes.empty())
      throw InputError(name_, line, 1,
                       fmt::format("the header has no {}; {}", timed ? "axis" : "time", allowed_columns));
    log_.position.resize(log_.axes.size());
  }

  void values(std::string_view row, long line) {
    const std::vector<LogField> fields = log_fields(row);
    require_columns(fields.size(), columns_.size(), name_, line);
    for (std::size_t i = 0; i < fields.size(); ++i) {
      double value = log_number(fields[i], name_, line);
      value *= columns_[i].unit;
      if (columns_[i].time)
        time(value, line, fields[i].column);
      else
        log_.position[columns_[i].axis].push_back(value);
    }
  }

  void time(double now, long line, long column) {
    if (count_ == 1 && now > last_) find_rows(now - last_);
    const double step = period_ / rows_;
    if (!begin_) {
      begin_ = now;
    } else if (!(now > last_)) {
      throw InputError(
          name_, line, column,
          fmt::format("the time {:.9g} s is not after the {:.9g} s before it; allowed are rising times", now, last_));
    } else if (std::abs(now - last_ - step) > jitter_max * step && !uneven_) {
      uneven_ = {line, column, now - last_};
    }
    last_ = now;
    ++count_;
  }

  /// A log may have several rows a sample period, such as those of a drive. @param step  s, between its first two rows
  void find_rows(double step) {
    const double rows = std::round(period_ / step);
    if (rows >= 2.0 && rows <= most_rows && std::abs(period_ / rows - step) <= jitter_max * step)
      rows_ = static_cast<int>(rows);
  }
  void keep_one_a_period(std::vector<double>& position) const {
    const auto rows = static_cast<std::size_t>(rows_);
    std::size_t kept = 0;
    for (std::size_t k = 0; k < position.size(); k += rows) position[kept++] = position[k];
    position.resize(kept);
  }
  /// s; 0 of fewer than two rows.
  double mean_step() const { return count_ > 1 ? (last_ - *begin_) / (count_ - 1) : 0.0; }

  /// A wrong unit is said as such: it makes all steps wrong.
  void check_pace() const {
    const double mean = mean_step(), step = period_ / rows_;
    if (!uneven_) return check_mean();
    std::string hint;
    for (const double factor : {1e-6, 1e-3, 1e3, 1e6}) {
      if (std::abs(mean * factor - period_) < jitter_max * period_)
        hint = fmt::format("; all steps are {:g} times as long: is the unit of the time right?", 1.0 / factor);
    }
    if (hint.empty() && std::abs(mean - step) > jitter_max * step)
      hint = fmt::format("; on the whole, samples are {:.6g} ms apart{}", 1e3 * mean, of_whole_periods(mean));
    throw InputError(name_, uneven_->line, uneven_->column,
                     fmt::format("this sample comes {:.6g} ms after the one before; allowed is the task's sample "
                                 "period, {:.6g} ms, or a whole part of it, to a tenth{}",
                                 1e3 * uneven_->step, 1e3 * period_, hint));
  }

  /// Advice for a log that leaves out samples.
  std::string of_whole_periods(double mean) const {
    const double periods = std::round(mean / period_);
    if (periods < 2.0 || periods > most_rows || std::abs(mean / period_ - periods) > jitter_max) return "";
    return fmt::format(
        ", one for {:g} sample periods: log every sample, or set `sample_period_ms` = {:.6g} to find the filter in "
        "steps of that",
        periods, 1e3 * periods * period_);
  }

  /// Steps that all differ a little from the task's period are of another period. Rounded times move the first and the
  /// last by a part of a sample, and the clocks of two computers differ by less than a thousandth.
  void check_mean() const {
    constexpr double clocks = 1e-3;
    const double mean = mean_step() * rows_;
    if (count_ < 2 || std::abs(mean - period_) <= std::max(clocks, 2.0 * jitter_max / (count_ - 1)) * period_) return;
    throw InputError(name_, 0, 0,
                     fmt::format("samples are {:.6g} ms apart, the task's sample period is {:.6g} ms; allowed are logs "
                                 "of every sample of the task",
                                 1e3 * mean, 1e3 * period_));
  }

  struct Uneven {
    long line, column;
    double step;  // s
  };
  std::string name_;
  double period_;
  ColumnUnits units_;
  MotionLog log_;
  std::vector<Column> columns_;
  std::optional<double> begin_;
  double last_ = 0.0;
  long count_ = 0;
  int rows_ = 1;        // a sample period
  long last_line_ = 1;  // that is not empty
  std::optional<Uneven> uneven_;
};

std::string listed(const std::vector<double>& numbers) {
  return fmt::format("[{}]", fmt::join(numbers, ", "));
}

/// The keys of [filter].
std::string filter_keys_of(const FilterSpec& spec) {
  std::string text;
  const nlohmann::ordered_json filter = filter_to_json(spec);
  for (const auto& [key, value] : filter.items()) {
    // It follows from them.
    if (key == "order" && (filter.contains("lengths") || filter.contains("taps"))) continue;
    text += fmt::format("{} = {}\n", key, value.is_array() ? listed(value.get<std::vector<double>>()) : value.dump());
  }
  return text;
}

std::string in_words(const FittedFilter& fit, double period) {
  const FilterSpec& spec = fit.filter;
  const double length = std::round(1e9 * (spec.order + 1) * period) / 1e6;
  switch (fit.family) {
    case SettingFamily::taps: return fmt::format("{} taps", spec.order + 1);
    case SettingFamily::one_pole:
      if (fit.second_constant > 0.0)
        return fmt::format("two poles in series with time constants of {:.5g} and {:.5g} ms", 1e3 * fit.time_constant,
                           1e3 * fit.second_constant);
      return fmt::format("a pole with a time constant of {:.5g} ms", 1e3 * fit.time_constant);
    case SettingFamily::exponential:
      return fmt::format("an exponential of {} ms with a time constant of {:.5g} ms", length, 1e3 * fit.time_constant);
    case SettingFamily::gaussian: return fmt::format("a Gaussian of {} ms, alpha {:.4g}", length, spec.alpha);
    case SettingFamily::windowed_sinc:
      return fmt::format("a windowed sinc of {} ms, cut-off {:.5g} Hz", length, 0.5 * spec.cutoff / period);
    case SettingFamily::averages:
    case SettingFamily::shaper: break;
  }
  std::vector<double> ms;
  for (const int taps : spec.lengths) ms.push_back(std::round(1e9 * taps * period) / 1e6);
  const std::string text = fmt::format("average{} of {} ms", ms.size() == 1 ? "" : "s", fmt::join(ms, ", "));
  const ShaperInfo* shaper = shaper_of(spec);
  if (shaper == nullptr) return text;
  return fmt::format("{}{} at {:.4g} Hz (impulses {:.5g} {} apart)", spec.order == 0 ? "" : text + " with ",
                     shaper->title, shaper->delay_periods / (spec.pair_delay * period), spec.pair_delay,
                     spec.pair_delay == 1.0 ? "sample" : "samples");
}

/// The legs of a log's command, as remarks.
std::string moves_in_words(const std::vector<LoggedMove>& moves, double period) {
  std::string text;
  for (std::size_t i = 0; i < moves.size(); ++i) {
    const LoggedMove& move = moves[i];
    double way = 0.0;
    for (const double w : move.way) way = std::hypot(way, w);
    text += fmt::format("# {}: {:.6g} mm in {} samples, {:.6g} mm/min, from sample {}\n",
                        moves.size() == 1 ? "straight move" : fmt::format("leg {}", i + 1), 1e3 * way, move.samples,
                        6e4 * move.feed(period), move.first);
    if (move.first_step < 1.0)
      text += fmt::format("# it begins {:.2g} of a sample after sample {}: the log's clock is not the control's\n",
                          1.0 - move.first_step, move.first);
  }
  if (moves.size() == 2)
    text += fmt::format("# delay at the corner: {:.3g} samples\n", delay_between(moves[0], moves[1]));
  return text;
}

/// Its other names, as a remark of its own; empty: it has none.
std::string other_names(const FittedFilter& fit, double period) {
  std::string same, nearly;
  for (const FittedFilter& alias : fit.aliases) {
    const bool whole = alias.family == SettingFamily::averages || alias.family == SettingFamily::shaper;
    std::string& names = whole ? same : nearly;
    names += (names.empty() ? "" : "; ") + in_words(alias, period);
  }
  return (same.empty() ? "" : fmt::format("#   the same filter: {}\n", same)) +
         (nearly.empty() ? "" : fmt::format("#   to 1 % of its taps the same filter: {}\n", nearly));
}

/// By how much another fit explains the log less well, or better.
std::string behind(double sigmas) {
  return sigmas < 0.0 ? fmt::format("{:.1f} sigma better", -sigmas) : fmt::format("{:.1f} sigma behind", sigmas);
}

/// The move of a fit, if it is not as long as that of the best.
std::string other_move(const FittedFilter& fit, const FittedFilter& best, double period) {
  if (fit.moves.empty() || std::abs(fit.moves.front().samples - best.moves.front().samples) <= 2) return "";
  return fmt::format(" behind a move of {} samples at {:.6g} mm/min", fit.moves.front().samples,
                     6e4 * fit.moves.front().feed(period));
}

}  // namespace

ColumnUnits column_units(const std::string& text) {
  const std::size_t comma = text.find(',');
  ColumnUnits units;
  if (comma != std::string::npos) {
    units.time = unit_of("t_" + text.substr(0, comma), true);
    units.position = unit_of("x_" + text.substr(comma + 1), false);
  }
  if (!units.time || !units.position)
    throw std::invalid_argument(fmt::format(
        "`{}` is no unit of times and one of positions; allowed are s, ms, us or ns, a comma, and m, mm, um, "
        "nm or deg",
        text));
  return units;
}

MotionLog read_motion_log(const std::string& path, double period, const ColumnUnits& units) {
  return LogReader(path, period, units).read(read_text_file(path, log_size_max));
}

std::string identified_to_toml(const Identification& found, const MotionLog& log, double period, bool prefilter,
                               const std::string& log_name) {
  const FittedFilter& best = found.fits.front();
  std::string text = fmt::format("# found in {}: {}\n", log_name, in_words(best, period));
  text += fmt::format("# where the filter acts, {} differ{} from it by {:.4g} um rms; free taps by {:.4g} um\n",
                      fmt::join(log.axes, ", "), log.axes.size() == 1 ? "s" : "", 1e6 * best.rms, 1e6 * found.taps.rms);
  text += moves_in_words(best.moves, period);
  if (best.family == SettingFamily::taps) {
    text += "# no family of settings fits nearly as well\n";
    if (found.taps.rms > 3.0 * found.log_noise + 1e-7)
      text += fmt::format("# nor do taps fit well: at rest and at constant speed the log's noise is {:.3g} um\n",
                          1e6 * found.log_noise);
  } else
    text +=
        other_names(best, period) + fmt::format("# likelihood {:.3g} among the fits listed, at noise of {:.4g} um\n",
                                                best.likelihood, 1e6 * found.noise);
  if (found.rounding > 0.5 * found.noise)
    text += fmt::format("# the positions are rounded, which is noise of {:.4g} um or more\n", 1e6 * found.rounding);
  constexpr std::size_t shown = 20;
  for (std::size_t i = 1; i < std::min(found.fits.size(), shown); ++i) {
    const FittedFilter& fit = found.fits[i];
    text += fmt::format("# also fits: {}{}, {}, likelihood {:.3g}\n", in_words(fit, period),
                        other_move(fit, best, period), behind(fit.sigmas), fit.likelihood);
    text += other_names(fit, period);
  }
  if (std::ranges::any_of(found.fits, [](const FittedFilter& fit) { return fit.sigmas < 0.0; }))
    text +=
        "# the first explains the log with the fewest numbers; sigma is of the log alone, likelihoods count numbers\n";
  const auto other = [&](const FittedFilter& fit) { return !other_move(fit, best, period).empty(); };
  if (std::ranges::any_of(found.fits, other))
    text +=
        "# a move and an average may exchange their lengths; the programmed feed (--feed-mm-min) tells them apart\n";
  if (found.fits.size() > shown) text += fmt::format("# and {} more\n", found.fits.size() - shown);
  if (!prefilter) return text + "[filter]\n" + filter_keys_of(best.filter);
  const Filter filter = make_filter(best.filter);
  return text +
         fmt::format("[controller]\nprefilter_taps = {}\n", listed({filter.taps().begin(), filter.taps().end()}));
}

}  // namespace accdec
