#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/machine.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/task/corner_feed.hpp>
#include <accdec/task/delay_kinds.hpp>
#include <accdec/task/not_of_control.hpp>
#include <accdec/task/settings_notes.hpp>
#include <accdec/task/settings_text.hpp>

namespace accdec {
namespace {

/// Which corner feeds a proof is about.
constexpr const char* settled_feeds = " with corner feeds that last until the motion has settled";

/// "18 ms, 12 ms and 3 ms".
std::string listed(const std::vector<std::string>& items) {
  if (items.size() < 2) return items.empty() ? "" : items.front();
  const std::vector<std::string> first(items.begin(), items.end() - 1);
  return fmt::format("{} and {}", fmt::join(first, ", "), items.back());
}

std::string with_unit(const Setting& setting) {
  return fmt::format("{:.9g} {}", setting.value, setting.unit);
}

std::string family_words(const ControllerSettings& settings, SettingFamily family) {
  switch (family) {
    case SettingFamily::taps: return "free taps";
    case SettingFamily::averages:
      return fmt::format("{} average{}", settings.stages.size(), settings.stages.size() == 1 ? "" : "s");
    case SettingFamily::one_pole:
      return settings.stages.size() == 1 ? "one pole" : fmt::format("{} poles", settings.stages.size());
    case SettingFamily::shaper:
      return fmt::format("{} average{} with {}", settings.stages.size(), settings.stages.size() == 1 ? "" : "s",
                         settings.shaper->title);
    case SettingFamily::exponential: return "finite exponentials";
    case SettingFamily::gaussian: return "Gaussians";
    case SettingFamily::windowed_sinc: return "windowed sincs";
  }
  return "";
}

/// All digits of a frequency that is entered with few; else it follows from whole samples, which are exact.
std::string frequency_in_words(double frequency) {
  const std::string entered = fmt::format("{:.9g}", frequency);
  return std::stod(entered) == frequency ? entered : fmt::format("{:.4g}", frequency);
}

std::string_view family_member(SettingFamily family) {
  if (family == SettingFamily::exponential) return "an exponential";
  return family == SettingFamily::gaussian ? "a Gaussian" : "a windowed sinc";
}

/// A corner with what a kind of delay sets there.
std::string corner_in_words(const DesignResult& result, std::size_t j, DelayKind kind) {
  const CornerResult& corner = result.corners[j];
  if (kind == DelayKind::corner_feed) return fmt::format("{} ({})", corner.name, corner_feed_in_words(result, j));
  if (kind != DelayKind::dwell && kind != DelayKind::timed_axis) return corner.name;
  return fmt::format("{} ({:.6g} ms)", corner.name, 1e3 * corner.delay * result.task.sample_period);
}

/// "A (14 ms), B (12 ms) and 3 more".
std::string some(std::vector<std::string> corners) {
  constexpr std::size_t shown = 5;
  const std::size_t more = corners.size() > shown ? corners.size() - shown : 0;
  corners.resize(std::min(corners.size(), shown));
  return fmt::format("corner{} {}{}", corners.size() + more == 1 ? "" : "s", listed(corners),
                     more > 0 ? fmt::format(" and {} more", more) : "");
}

/// Delays of samples, for a control whose kinds are not named.
std::string plain_delays_in_words(const DesignResult& result) {
  std::vector<std::string> corners;
  for (std::size_t j = 0; j < result.corners.size(); ++j) {
    if (result.corners[j].delay > 0) corners.push_back(corner_in_words(result, j, DelayKind::dwell));
  }
  return corners.empty() ? "" : "; delay at " + some(std::move(corners));
}

/// The delays in words: "; exact-stop at corner A". An in-position width alone is of all corners.
std::string delays_in_words(const DesignResult& result) {
  const std::vector<DelayKind> chosen = chosen_delay_kinds(result);
  if (chosen.empty()) return plain_delays_in_words(result);
  std::string text;
  if (result.settings && result.settings->width) text += "; " + width_in_words(*result.settings->width);
  const auto count = static_cast<std::size_t>(std::count(chosen.begin(), chosen.end(), DelayKind::in_position));
  for (const DelayKindName& kind : delay_kinds) {
    const std::string word(result.task.settings->word_of(kind.kind));
    if (kind.kind == DelayKind::in_position && count == chosen.size() && word.empty()) continue;
    std::vector<std::string> corners;
    for (std::size_t j = 0; j < chosen.size(); ++j) {
      if (chosen[j] == kind.kind) corners.push_back(corner_in_words(result, j, kind.kind));
    }
    if (corners.empty()) continue;
    text += fmt::format("; {}{} at {}", kind.name, word.empty() ? "" : fmt::format(" ({})", word),
                        some(std::move(corners)));
  }
  return text;
}

bool has_real_number(SettingFamily family) {
  return family == SettingFamily::exponential || family == SettingFamily::gaussian ||
         family == SettingFamily::windowed_sinc;
}

/// "a Gaussian of 30 ms, alpha 2.4", or "TIME = 30 ms, alpha 2.4" where the control has a name for the length.
std::string length_and_number(const ChosenSettings& settings) {
  const Setting& length = settings.values.front();
  std::string text = with_unit(length);
  if (!length.name.empty()) {
    text = fmt::format("{} = {}", length.name, text);
  } else if (settings.values.size() == 1) {
    return "no filter";
  } else {
    text = fmt::format("{} of {}", family_member(settings.family), text);
  }
  if (settings.values.size() == 1) return text;
  const Setting& number = settings.values.back();
  return fmt::format("{}, {} {:.9g}{}{}", text, number.name, number.value, number.unit.empty() ? "" : " ", number.unit);
}

std::string milliseconds(double seconds) {
  return fmt::format("{:.6g} ms", 1e3 * seconds);
}

/// @param bits  of whole coefficients; 0: of real ones
std::string exported_taps(int count, int bits) {
  return fmt::format("the {} taps{} that `accdec export` writes", count,
                     bits > 0 ? fmt::format(" in whole numbers over 2^{}", bits) : "");
}

/// The time that free taps would take, or at least take.
std::string beside_taps(const DesignResult& result) {
  const double time = result.objective();
  const auto& whole = result.quantisation;
  // Those beside whole coefficients have the same kinds of delays.
  const std::string taps = free_taps_in_words(result.task.settings && !whole ? &*result.task.settings : nullptr);
  const std::optional<double> free = whole ? whole->unquantised : result.free_taps;
  const auto part = [&](double other) { return percent_in_words((time - other) / time); };
  if (free && result.lower_bound && *free <= *result.lower_bound * (1.0 + 1e-9)) {
    if (*free >= time * (1.0 - 1e-9)) return fmt::format(" {} are not faster.", taps);
    return fmt::format(" {} would take {} ({} less).", taps, milliseconds(*free), part(*free));
  }
  std::string text;
  if (free && *free < time * (1.0 - 1e-9))
    text = fmt::format(" {} would take {} ({} less) or less.", taps, milliseconds(*free), part(*free));
  if (result.lower_bound && *result.lower_bound < time * (1.0 - 1e-9))
    text += fmt::format(" No filter takes less than {} ({} less).", milliseconds(*result.lower_bound),
                        part(*result.lower_bound));
  return text;
}

/// A value to so many significant digits, rounded upwards or downwards.
std::string rounded(double value, int digits, double (*whole)(double)) {
  if (value == 0.0 || !std::isfinite(value)) return fmt::format("{:.{}g}", value, digits);
  const double unit = std::pow(10.0, std::floor(std::log10(value)) + 1.0 - digits);
  // Beyond 12 digits a quotient is not whole by its rounding alone.
  const double units = value / unit, nearest = std::round(units);
  return fmt::format("{:.{}g}", (std::abs(units - nearest) < 1e-12 * units ? nearest : whole(units)) * unit, digits);
}

}  // namespace

std::string free_taps_in_words(const ControllerSettings* control) {
  return control == nullptr || control->any_delay() ? "Free taps" : "Free taps with delays of any number of samples";
}

std::string percent_in_words(double part) {
  const double percent = 100.0 * part;
  // One digit behind the point, or the first one that is not 0.
  return percent < 0.05 ? fmt::format("{:.1g} %", percent) : fmt::format("{:.1f} %", percent);
}

std::string assumed_in_words(const ControllerSettings* control) {
  if (control == nullptr) return "";
  std::vector<std::string> assumed = control->assumed;
  if (!control->controller.empty() && control->delays.empty())
    assumed.emplace_back("the second leg of a corner can be delayed by any number of samples");
  return assumed.empty() ? "" : fmt::format(" Assumed: {}.", fmt::join(assumed, "; "));
}

std::string families_in_words(const ControllerSettings& settings) {
  std::vector<std::string> families;
  for (const SettingFamily family : settings.families) families.push_back(family_words(settings, family));
  return listed(families);
}

std::string proved_best_in_words(const ControllerSettings& settings) {
  const std::string feeds = settings.names(DelayKind::corner_feed) ? settled_feeds : "";
  if (settings.controller.empty()) return "proved best for this family" + feeds;
  return settings.delays.empty() ? "proved best for this control's filter" : "proved best for this control" + feeds;
}

std::string width_in_words(const WidthInterval& width) {
  constexpr double smallest = 1e-9, small = 1e-6;  // m: the steps of encoders and of most controls' parameters
  const char* const note = width.high < smallest ? ": no control holds so small a width, stop exactly instead"
                           : width.high < small  ? ": few controls hold a width below 0.001 mm, stop exactly instead"
                                                 : "";
  // Both ends are rounded inwards: every width that is printed may be entered. A narrow interval needs more digits.
  int digits = 4;
  while (digits < 15 && width.high - width.low < 20.0 * std::pow(10.0, -digits) * width.high) ++digits;
  const std::string low = rounded(1e3 * width.low, digits, std::ceil),
                    high = width.high < unlimited ? rounded(1e3 * width.high, digits, std::floor) : "any larger";
  return fmt::format("in-position width {:.{}g} mm ({} to {}){}", 1e3 * width.middle(), digits, low, high, note);
}

std::string corner_feed_in_words(const DesignResult& result, std::size_t corner) {
  const Task& task = result.task;
  const Corner& g = task.corners[corner].geometry();
  const double part = result.corners[corner].feed_part;
  const int lead = corner_feed_lead(result.filter->order(), Response(task.machine, task.sample_period).order());
  const double slow = part * lead * task.sample_period;  // s, at full feed
  const auto both = [&](double of_in, double of_out) {
    return g.feed_in == g.feed_out ? fmt::format("{:.6g}", of_in) : fmt::format("{:.6g} and {:.6g}", of_in, of_out);
  };
  return fmt::format("{:.6g} % of the feed, {} mm/min, from {:.4g} mm before to {:.4g} mm behind it", 1e2 * part,
                     both(6e4 * part * g.feed_in, 6e4 * part * g.feed_out), 1e3 * slow * g.feed_in,
                     1e3 * slow * g.feed_out);
}

std::string settings_in_words(const ChosenSettings& settings) {
  if (settings.family == SettingFamily::taps) return exported_taps(static_cast<int>(settings.filter.taps.size()), 0);
  if (has_real_number(settings.family)) return length_and_number(settings);
  std::vector<std::string> named, plain;
  for (const Setting& setting : settings.values) {
    if (setting.unit == "Hz") continue;
    if (!setting.name.empty()) named.push_back(fmt::format("{} = {}", setting.name, with_unit(setting)));
    if (setting.value > 0.0) plain.push_back(with_unit(setting));
  }
  std::string text;
  if (named.size() == settings.values.size() - (settings.filter.pairs > 0 ? 1 : 0))
    text = fmt::format("{}", fmt::join(named, ", "));
  else if (plain.empty())
    text = "no filter";
  else if (settings.family == SettingFamily::one_pole)
    text = plain.size() == 1 ? fmt::format("a pole of {}", plain.front()) : fmt::format("poles of {}", listed(plain));
  else if (plain.size() == 1)
    text = fmt::format("one average of {}", plain.front());
  else
    text = fmt::format("averages of {}", listed(plain));
  if (settings.filter.pairs > 0) {
    const Setting& shaper = settings.values.back();
    text += fmt::format(", {} at {} Hz", shaper.name, frequency_in_words(shaper.value));
    text += fmt::format(" (impulses {:.6g} {} apart)", settings.filter.pair_delay,
                        settings.filter.pair_delay == 1.0 ? "sample" : "samples");
  }
  return text;
}

std::vector<DelayKind> chosen_delay_kinds(const DesignResult& result) {
  if (result.settings) return result.settings->delays;
  const auto& control = result.task.settings;
  if (!control || control->delays.empty() || !result.filter) return {};
  const bool dwells = control->names(DelayKind::dwell);
  const Response response(result.task.machine, result.task.sample_period);
  const int apart = exact_stop_delay(response.command(*result.filter));
  std::vector<DelayKind> kinds;
  for (const CornerResult& corner : result.corners) {
    if (corner.delay == 0 && control->names(DelayKind::continuous))
      kinds.push_back(DelayKind::continuous);
    else if (control->names(DelayKind::exact_stop) && (corner.delay == apart || !control->any_delay()))
      kinds.push_back(DelayKind::exact_stop);
    else
      kinds.push_back(dwells ? DelayKind::dwell : DelayKind::timed_axis);
  }
  return kinds;
}

namespace {

/// The taps and delays that a control takes.
std::string taps_in_words(const DesignResult& result) {
  std::string text = exported_taps(result.filter->order() + 1, result.quantisation ? result.quantisation->bits : 0);
  if (result.task.settings) return text + delays_in_words(result);
  std::vector<std::string> delays;
  for (std::size_t j = 0; j < result.corners.size(); ++j)
    delays.push_back(corner_in_words(result, j, DelayKind::dwell));
  return text + "; delay at " + some(std::move(delays));
}

/// Kinds of delays that free taps do without.
std::string kinds_not_used(const DesignResult& result) {
  const auto& control = result.task.settings;
  if (result.settings || !control) return "";
  std::string text;
  if (control->names(DelayKind::in_position))
    text += fmt::format(" In-position is not used: a {} waits as long as needed.",
                        control->names(DelayKind::dwell) ? "dwell" : "timed axis");
  if (control->names(DelayKind::corner_feed)) text += " Corner-feed is not considered with free taps.";
  return text;
}

/// The part of the motion that the time leaves out.
std::string smoothing_left_out(const DesignResult& result) {
  const double later = Response(result.task.machine, result.task.sample_period).prefilter_order();
  if (later == 0.0) return "";
  return fmt::format(" The control's smoothing ends {} after this time.",
                     milliseconds(later * result.task.sample_period));
}

/// Whether the control's corner feeds were candidates: free taps with delays of any length do without.
bool considers_feeds(const DesignResult& result) {
  const auto& control = result.task.settings;
  return control && control->names(DelayKind::corner_feed) && (result.settings || !control->any_delay());
}

/// Corner feeds that no search looks at.
std::string feeds_left_out(const DesignResult& result) {
  if (!considers_feeds(result)) return "";
  const int lead =
      corner_feed_lead(result.filter->order(), Response(result.task.machine, result.task.sample_period).order());
  return fmt::format(
      " The {} samples at the corner feed, before and behind the corner, are a rule of this design. Fewer may be "
      "faster; they are not considered.",
      lead);
}

/// The proof behind the time.
std::string proved_in_words(const DesignResult& result) {
  const auto& control = result.task.settings;
  if (result.status != Status::optimal)
    return result.quantisation ? "the fastest whole numbers found, not proved best" : "not proved best";
  if (result.settings && result.settings->family != SettingFamily::taps) return proved_best_in_words(*control);
  return control && !control->controller.empty() && !control->names(DelayKind::corner_feed)
             ? "proved best for this control"
         : control && !control->any_delay()
             ? std::string("proved best of free taps with such delays") + (considers_feeds(result) ? settled_feeds : "")
             : "proved best of free taps with delays";
}

}  // namespace

std::string settings_answer(const DesignResult& result) {
  const bool control = result.task.settings || !result.task.machine.prefilter_taps.empty() || result.quantisation;
  if (!result.has_design() || !control || (!result.settings && result.task.filter)) return "";
  const double time = result.objective();
  std::string text = fmt::format("Set these: {}. ", result.settings && result.settings->family != SettingFamily::taps
                                                        ? settings_in_words(*result.settings) + delays_in_words(result)
                                                        : taps_in_words(result));
  const bool corner = result.corners.size() == 1 && result.task.design.runs == 1.0;
  text += fmt::format("{}{}, {}.", milliseconds(time), corner ? " a corner" : " in all", proved_in_words(result));
  const ControllerSettings* const own = result.task.settings ? &*result.task.settings : nullptr;
  text += caps_reached(result) + stops_considered(own) + feeds_left_out(result) + smoothing_left_out(result);
  text += beside_taps(result) + kinds_not_used(result);
  if (result.savings && result.settings) {
    const double today = result.savings->today, saved = result.savings->total;
    text += fmt::format(" Today's setting takes {}; ", milliseconds(today));
    text += saved > 1e-9 * today
                ? fmt::format("retuning saves {} ({}).", milliseconds(saved), percent_in_words(saved / today))
                : "retuning saves nothing.";
  }
  text += limit_broken_today(result);
  if (result.settings && result.task.baseline)
    text += today_not_of_control(*own, *result.task.baseline, result.task.sample_period);
  return text + assumed_in_words(own) + "\n";
}

}  // namespace accdec
