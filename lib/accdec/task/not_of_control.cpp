#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include <accdec/task/filter_in_words.hpp>
#include <accdec/task/not_of_control.hpp>
#include <accdec/task/pole_rest.hpp>
#include <accdec/task/settings_text.hpp>

namespace accdec {
namespace {

bool is_multiple(double value, double step, double tolerance) {
  const double steps = value / step;
  return steps > 0.5 && std::abs(steps - std::round(steps)) <= tolerance;
}

/// A number that a task gives with few digits, such as a ratio, is taken for the multiple that it is near.
constexpr double few_digits = 0.01;  // of a step
constexpr double all_digits = 1e-6;

/// @param time  s, on
bool allows(const SettableStage& stage, double time, double period, double tolerance) {
  const double step = stage.length_step > 0.0 ? stage.length_step : period;
  if (!stage.length_set.empty())
    return std::ranges::any_of(stage.length_set, [&](double t) { return std::abs(t - time) <= tolerance * period; });
  const double most = stage.length_max > 0.0 ? stage.length_max : unlimited;
  return time <= most + tolerance * step && is_multiple(time, step, tolerance);
}

/// The lengths of averages in series with a filter's taps, samples, without those that are off. None: it is no such
/// cascade. Any shaper is left aside.
std::optional<std::vector<int>> as_averages(const FilterSpec& filter) {
  std::vector<int> lengths{filter.order + 1};
  const bool flat = filter.kind == Shape::boxcar || (info(filter.kind).has_order && filter.order == 0) ||
                    (filter.kind == Shape::exponential && filter.ratio == 1.0) ||
                    (filter.kind == Shape::gaussian && filter.alpha == 0.0);
  if (filter.kind == Shape::averages)
    lengths = filter.lengths;
  else if (filter.kind == Shape::trapezoid)
    lengths = {filter.order - filter.ramp + 1, filter.ramp + 1};
  else if (!flat)
    return std::nullopt;
  std::erase(lengths, 1);
  return lengths;
}

class Judge {
 public:
  Judge(const ControllerSettings& control, const FilterSpec& filter, double period)
      : control_(control), filter_(filter), period_(period), lengths_(as_averages(filter)) {}

  /// Whether a family has the filter, else why not. Empty: it has.
  std::string why() const {
    std::string why = fmt::format("the control has {}", families_in_words(control_));
    for (const SettingFamily family : control_.families) {
      if (has(family)) return "";
      if (const std::string time = time_not_had(family); !time.empty()) why = time;
    }
    return why;
  }

 private:
  bool has(SettingFamily family) const {
    const bool off = lengths_ && lengths_->empty() && filter_.pairs == 0;
    switch (family) {
      case SettingFamily::taps: return true;
      case SettingFamily::averages: return filter_.pairs == 0 && lengths_ && assigned(*lengths_);
      case SettingFamily::shaper: return shaped() && lengths_ && assigned(*lengths_);
      default: return off || (filter_.pairs == 0 && is_shape(family) && time_had(family) && number_had(family));
    }
  }

  bool shaped() const {
    if (filter_.pairs == 0) return true;
    const double step = control_.shaper_frequency_step;
    const ShaperInfo* shaper = control_.shaper;
    if (shaper == nullptr || shaper != shaper_of(filter_)) return false;
    return step > 0.0 ? is_multiple(shaper->delay_periods / (filter_.pair_delay * period_), step, few_digits)
                      : filter_.whole_pairs();
  }

  /// Whether every length has a stage of its own that allows it.
  bool assigned(std::vector<int> lengths) const {
    if (lengths.size() > control_.stages.size()) return false;
    lengths.resize(control_.stages.size(), 1);
    std::ranges::sort(lengths);
    bool found = false;
    do {
      found = true;
      for (std::size_t s = 0; s < lengths.size() && found; ++s)
        found = lengths[s] == 1 || allows(control_.stages[s], lengths[s] * period_, period_, all_digits);
    } while (!found && std::next_permutation(lengths.begin(), lengths.end()));
    return found;
  }

  bool is_shape(SettingFamily family) const {
    const bool falls = filter_.kind == Shape::exponential && filter_.ratio < 1.0;
    switch (family) {
      case SettingFamily::one_pole:
        // An endless pole has no less behind its last tap.
        return falls && std::pow(filter_.ratio, filter_.order + 1) <= pole_rest * (1.0 + few_digits);
      case SettingFamily::exponential: return falls;
      case SettingFamily::gaussian: return filter_.kind == Shape::gaussian;
      default: return family == SettingFamily::windowed_sinc && filter_.kind == Shape::blackman_sinc;
    }
  }

  double time_constant() const { return -period_ / std::log(filter_.ratio); }

  bool time_had(SettingFamily family) const {
    const auto& stages = control_.stages;
    if (family != SettingFamily::one_pole)
      return allows(stages.front(), (filter_.order + 1) * period_, period_, all_digits);
    return std::ranges::any_of(
        stages, [&](const SettableStage& stage) { return allows(stage, time_constant(), period_, few_digits); });
  }

  bool number_had(SettingFamily family) const {
    const double step = control_.time_constant_step > 0.0 ? control_.time_constant_step : period_;
    switch (family) {
      case SettingFamily::exponential: return is_multiple(time_constant(), step, few_digits);
      case SettingFamily::gaussian: return is_multiple(filter_.alpha, control_.alpha_step, all_digits);
      case SettingFamily::windowed_sinc:
        return is_multiple(0.5 * filter_.cutoff / period_, control_.cutoff_step, few_digits);
      default: return true;
    }
  }

  /// Of a filter of the family's shape: the time or number that the control cannot be set to. Empty: of another shape.
  std::string time_not_had(SettingFamily family) const {
    const bool cascade = family == SettingFamily::averages || family == SettingFamily::shaper;
    if (!cascade && filter_.pairs == 0 && is_shape(family))
      return "no setting of the control has " + std::string(time_had(family) ? "this number" : "this time");
    if (!cascade || !shaped() || (family == SettingFamily::averages && filter_.pairs > 0) || !lengths_) return "";
    if (lengths_->size() > control_.stages.size()) return "";
    for (const int length : *lengths_) {
      if (!assigned({length})) return fmt::format("no average of the control can be {:.9g} ms", 1e3 * length * period_);
    }
    return "no two averages of the control can have these times together";
  }

  const ControllerSettings& control_;
  const FilterSpec& filter_;
  double period_;
  std::optional<std::vector<int>> lengths_;
};

}  // namespace

std::string not_of_control(const ControllerSettings& control, const FilterSpec& filter, double period) {
  if (filter.kind == Shape::taps) return "";
  const std::string why = Judge(control, filter, period).why();
  const std::string words = filter_in_words(filter, period);
  return why.empty() ? "" : fmt::format("{}, and {}", words.empty() ? "a rising exponential" : words, why);
}

std::string today_not_of_control(const ControllerSettings& control, const FilterSpec& today, double period) {
  const std::string why = not_of_control(control, today, period);
  return why.empty() ? "" : fmt::format(" Today's setting is none of this control: {}.", why);
}

}  // namespace accdec
