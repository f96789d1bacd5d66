#include <cmath>
#include <vector>

#include <fmt/format.h>

#include <accdec/task.hpp>
#include <accdec/task/filter_in_words.hpp>
#include <accdec/task/settings_text.hpp>

namespace accdec {
namespace {

/// Averages, which a setting of 0 turns off, as one of one sample is.
std::string averages_in_words(const std::vector<int>& lengths, double period) {
  ChosenSettings chosen{.family = SettingFamily::averages};
  for (const int length : lengths) chosen.values.push_back({"", length > 1 ? 1e3 * length * period : 0.0, "ms"});
  return settings_in_words(chosen);
}

/// A filter of a length and a real number.
std::string with_number(SettingFamily family, const FilterSpec& filter, double period, const Setting& number) {
  return settings_in_words({.family = family, .values = {{"", 1e3 * (filter.order + 1) * period, "ms"}, number}});
}

/// Empty for taps that no control is set to by numbers.
std::string without_pairs(const FilterSpec& filter, double period) {
  const auto of_length = [&](std::string_view shape) {
    return fmt::format("a {} of {:.9g} ms", shape, 1e3 * (filter.order + 1) * period);
  };
  const bool one_tap = filter.order == 0 && info(filter.kind).has_order;
  switch (one_tap ? Shape::boxcar : filter.kind) {
    case Shape::boxcar: return averages_in_words({filter.order + 1}, period);
    case Shape::trapezoid: return averages_in_words({filter.order - filter.ramp + 1, filter.ramp + 1}, period);
    case Shape::averages: return averages_in_words(filter.lengths, period);
    case Shape::s_curve: return of_length("quintic S-curve");
    case Shape::hann: return of_length("Hann filter");
    case Shape::blackman: return of_length("Blackman filter");
    case Shape::blackman_sinc:
      return with_number(SettingFamily::windowed_sinc, filter, period, {"cut-off", 0.5 * filter.cutoff / period, "Hz"});
    case Shape::gaussian: return with_number(SettingFamily::gaussian, filter, period, {"alpha", filter.alpha, ""});
    case Shape::exponential:
      if (filter.ratio == 1.0) return averages_in_words({filter.order + 1}, period);
      if (filter.ratio > 1.0) return "";
      return with_number(SettingFamily::exponential, filter, period,
                         {"time constant", -1e3 * period / std::log(filter.ratio), "ms"});
    case Shape::taps: break;
  }
  return "";
}

}  // namespace

std::string filter_in_words(const FilterSpec& filter, double period) {
  std::string text = without_pairs(filter, period);
  if (filter.pairs == 0 || text.empty()) return text;
  const ShaperInfo* shaper = shaper_of(filter);
  text += shaper != nullptr
              ? fmt::format(", {} at {:.4g} Hz", shaper->title, shaper->delay_periods / (filter.pair_delay * period))
              : std::string(", three impulses");
  return text +
         fmt::format(" (impulses {:.6g} {} apart)", filter.pair_delay, filter.pair_delay == 1.0 ? "sample" : "samples");
}

}  // namespace accdec
