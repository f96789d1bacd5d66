#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <accdec/certificate.hpp>
#include <accdec/certificate/family_members.hpp>
#include <accdec/design/verify_settings.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/task/objective.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

constexpr double part = 1e-9;
constexpr double kept_digits = 1e-9;  // times are written with nine decimals or more, in the unit of the parameter

bool same_taps(const Filter& a, const std::vector<double>& b) {
  bool same = a.order() + 1 == static_cast<int>(b.size());
  for (int i = 0; same && i <= a.order(); ++i) same = std::abs(a.tap(i) - b[static_cast<std::size_t>(i)]) <= 1e-12;
  return same;
}

/// Whether the family of the task has these taps.
bool is_member(Task task, SettingFamily family, const Filter& filter) {
  const int order = filter.order();
  task.design.order_min = order;
  bool found = false;
  visit_family(task, family, order + 1, [&](const FamilyMember& member, const std::string&) {
    found = found || same_taps(filter, member.taps);
  });
  return found;
}

/// The whole number of samples that a time to enter is; -1: it is none, by more than the digits that are kept of it.
long samples_of(const Setting& time, double unit_seconds, double period) {
  const double samples = time.value * unit_seconds / period;
  if (!(samples >= 0.0 && samples < 2e6)) return -1;
  const long length = std::lround(samples);
  const double entered = static_cast<double>(length) * period / unit_seconds;
  return std::abs(time.value - entered) <= part * entered + kept_digits ? length : -1;
}

/// The filter of a length and a real number; empty if the values are not these.
std::vector<double> taps_of_number(const Task& task, const ChosenSettings& chosen) {
  const SettableStage& stage = task.settings->stages.front();
  const Setting& time = chosen.values.front();
  if (time.name != stage.name || time.unit != stage.unit || chosen.values.size() > 2) return {};
  const long samples = samples_of(time, stage.unit_seconds, task.sample_period);
  if (chosen.values.size() == 1) return samples == 0 ? std::vector<double>{1.0} : std::vector<double>{};
  const Setting& number = chosen.values.back();
  const bool of_time = chosen.family == SettingFamily::exponential;
  const std::string unit = of_time ? "ms" : chosen.family == SettingFamily::gaussian ? "" : "Hz";
  if (number.unit != unit || samples < 2) return {};
  const double si = of_time ? 1e-3 * number.value : number.value;
  const Filter filter(grid_taps(chosen.family, static_cast<int>(samples) - 1, si, task.sample_period));
  return {filter.taps().begin(), filter.taps().end()};
}

/// The filter that the values to enter make. @param filter_order  longer poles end there
std::vector<double> taps_of_values(const Task& task, const ChosenSettings& chosen, int filter_order) {
  const auto& stages = task.settings->stages;
  if (chosen.values.empty()) return {};
  if (chosen.family == SettingFamily::exponential || chosen.family == SettingFamily::gaussian ||
      chosen.family == SettingFamily::windowed_sinc)
    return taps_of_number(task, chosen);
  FilterSpec spec{.kind = Shape::averages};
  std::vector<int> constants;  // of poles; 0: off
  std::size_t s = 0;
  for (const Setting& setting : chosen.values) {
    if (setting.unit == "Hz") {
      const ShaperInfo* shaper = task.settings->shaper;
      if (shaper == nullptr || setting.name != shaper->title) return {};
      const double delay = shaper->delay_periods / (setting.value * task.sample_period);
      const double step = task.settings->shaper_frequency_step, steps = step > 0.0 ? setting.value / step : delay;
      if (!(delay >= 1.0 - part && delay < 2e6 && std::abs(steps - std::round(steps)) <= part * steps)) return {};
      spec.pairs = shaper->pairs, spec.outer = shaper->outer;
      spec.pair_delay = std::max(1.0, step > 0.0 ? delay : std::round(delay));
      continue;
    }
    if (s >= stages.size()) return {};
    if (setting.name != stages[s].name || setting.unit != stages[s].unit) return {};
    const long length = samples_of(setting, stages[s].unit_seconds, task.sample_period);
    // 0 samples, or an average of 1: the stage is off.
    const int off = chosen.family == SettingFamily::one_pole ? 0 : 1;
    if (length < 0 || (length > off && !settable(stages[s], static_cast<int>(length), task.sample_period))) return {};
    ++s;
    constants.push_back(static_cast<int>(length));
    if (length > 1) spec.lengths.push_back(static_cast<int>(length)), spec.order += spec.lengths.back() - 1;
  }
  if (chosen.family == SettingFamily::one_pole) return member_of(taps_of_poles(constants, filter_order + 1)).taps;
  if (spec.lengths.empty()) spec.lengths.push_back(1);
  if (spec.pairs > 0 && !(spec.pair_delay >= 1.0)) return {};
  const Filter filter = make_filter(spec);
  return {filter.taps().begin(), filter.taps().end()};
}

bool values_fit(const Task& task, const ChosenSettings& chosen, const Filter& filter) {
  return same_taps(filter, taps_of_values(task, chosen, filter.order()));
}

/// The position that the control looks at, by its own sums.
class InPosition {
 public:
  explicit InPosition(const DesignResult& result)
      : result_(result), behind_(*result.filter, result.task.machine, result.task.sample_period) {}

  /// The delay that an in-position width gives corner j.
  int delay_at(std::size_t j, double width) const {
    const ControllerSettings& control = *result_.task.settings;
    const Corner& g = result_.task.corners[j].geometry();
    const double step = g.feed_in * result_.task.sample_period;
    for (int d = 0;; ++d) {
      double squares = 0.0, longest = 0.0;  // along the path, and of one axis
      for (Eigen::Index a = 0; a < g.axes(); ++a) {
        const Filter& watched =
            control.in_position_actual ? behind_.motion(static_cast<std::size_t>(a)) : behind_.command();
        double way = 0.0;
        for (int i = d + 1; i <= watched.order(); ++i) way += watched.tap(i) * (i - d);
        squares += g.direction_in[a] * g.direction_in[a] * way * way;
        longest = std::max(longest, std::abs(g.direction_in[a]) * way);
      }
      if (step * (control.in_position_by_axis ? longest : std::sqrt(squares)) <= width || d > behind_.longest_order())
        return d + static_cast<int>(std::lround(control.in_position_latency / result_.task.sample_period));
    }
  }

  /// The recorded interval gives the recorded delays, and no wider one does.
  void compare_width(const WidthInterval& width, std::vector<std::string>& reasons) const {
    constexpr double rounding = 1e-15;  // m, of sums
    bool lower = width.low <= 0.0, higher = !std::isfinite(width.high);
    const double inside = std::isfinite(width.high) ? width.high * (1.0 - part) : 2.0 * width.low;
    for (std::size_t j = 0; j < result_.corners.size(); ++j) {
      if (result_.settings->delays[j] != DelayKind::in_position) continue;
      const int d = result_.corners[j].delay;
      for (const double w : {width.low * (1.0 + part), width.middle(), inside}) {
        if (const int found = delay_at(j, w); found != d)
          reasons.push_back(fmt::format("corner {}: an in-position width of {:.9g} m gives delay {}, not {}",
                                        result_.corners[j].name, w, found, d));
      }
      lower = lower || delay_at(j, width.low * (1.0 - part) - rounding) != d;
      higher = higher || delay_at(j, width.high * (1.0 + part) + rounding) != d;
    }
    if (!lower) reasons.push_back(fmt::format("settings.width_low_m: widths below {:.9g} m do as well", width.low));
    if (!higher) reasons.push_back(fmt::format("settings.width_high_m: widths above {:.9g} m do as well", width.high));
  }

 private:
  const DesignResult& result_;
  FilterBehind behind_;
};

/// A corner feed, and nothing else, passes the corner at a part of the feed that the controller has.
void compare_feed(const DesignResult& result, std::size_t j, std::vector<std::string>& reasons) {
  const CornerResult& corner = result.corners[j];
  const bool slow = result.settings->delays[j] == DelayKind::corner_feed;
  if (slow != (corner.feed_part < 1.0))
    reasons.push_back(
        fmt::format("corner {}: a corner feed goes with a feed_part below 1, and only that", corner.name));
  if (!slow) return;
  if (corner.delay != 0) reasons.push_back(fmt::format("corner {}: a corner feed has no delay", corner.name));
  const double multiple = corner.feed_part / result.task.settings->corner_feed_step;
  if (!(std::abs(multiple - std::round(multiple)) <= part * multiple) || std::round(multiple) < 1.0)
    reasons.push_back(
        fmt::format("corner {}: {} of the feed is no multiple of corner_feed_step", corner.name, corner.feed_part));
}

/// Whether this corner is an exact stop: as soon as the filter and the control's smoothing are empty, or a sample later
/// if a limit asks for that.
bool is_exact_stop(const DesignResult& result, std::size_t j) {
  const int apart =
      result.filter->order() + std::max(0, static_cast<int>(result.task.machine.prefilter_taps.size()) - 1);
  const int longer = result.corners[j].delay - apart;
  if (longer != 1) return longer == 0;
  std::vector<LimitUse> limits;
  verify_by_simulation(corner_alone(result.task, result.task.corners[j]), *result.filter, {apart}, &limits);
  return std::ranges::any_of(limits, [](const LimitUse& use) { return use.utilisation > 1.0; });
}

void compare_kinds(const DesignResult& result, std::vector<std::string>& reasons) {
  const auto& kinds = result.settings->delays;
  const auto& allowed = result.task.settings->delays;
  if (allowed.empty() ? !kinds.empty() : kinds.size() != result.corners.size()) {
    reasons.push_back("settings.delays must name the kind of delay at every corner, or none if the task names none");
    return;
  }
  bool in_position = false;
  for (std::size_t j = 0; j < kinds.size(); ++j) {
    compare_feed(result, j, reasons);
    const int d = result.corners[j].delay;
    const std::string& name = result.corners[j].name;
    if (std::find(allowed.begin(), allowed.end(), kinds[j]) == allowed.end())
      reasons.push_back(fmt::format("corner {}: the controller has no delay of kind {}", name, to_string(kinds[j])));
    if (kinds[j] == DelayKind::continuous && d != 0)
      reasons.push_back(fmt::format("corner {}: delay {} is not continuous", name, d));
    if (kinds[j] == DelayKind::exact_stop && !is_exact_stop(result, j))
      reasons.push_back(fmt::format("corner {}: delay {} is no exact stop", name, d));
    in_position = in_position || kinds[j] == DelayKind::in_position;
  }
  if (in_position != result.settings->width.has_value())
    reasons.push_back("an in-position width must be recorded with corners that are in-position, and only then");
  if (in_position && result.settings->width) InPosition(result).compare_width(*result.settings->width, reasons);
}

/// Free taps for a control that has no delays of any number of samples.
void compare_one_kind(const DesignResult& result, std::vector<std::string>& reasons) {
  const auto& control = result.task.settings;
  if (!control || control->any_delay() || !result.filter) return;
  for (std::size_t j = 0; j < result.corners.size(); ++j) {
    const CornerResult& corner = result.corners[j];
    const bool runs_on = control->names(DelayKind::continuous) && corner.delay == 0,
               stops = control->names(DelayKind::exact_stop) && is_exact_stop(result, j);
    if (!runs_on && !stops)
      reasons.push_back(fmt::format("corner {}: the controller has no delay of {} samples", corner.name, corner.delay));
  }
}

/// Free taps as what to set.
void compare_taps(const DesignResult& result, std::vector<std::string>& reasons) {
  const ChosenSettings& chosen = *result.settings;
  if (!result.task.settings->names(SettingFamily::taps)) reasons.push_back("the task names no free taps");
  if (!chosen.values.empty() || chosen.filter.kind != Shape::taps)
    reasons.push_back("settings are free taps, and no other values");
  const Filter named = make_filter(chosen.filter);
  if (!same_taps(*result.filter, {named.taps().begin(), named.taps().end()}))
    reasons.push_back("the taps are not those of settings.filter");
  compare_kinds(result, reasons);
  if (result.family_bound || result.free_taps) reasons.push_back("the settings are free taps, beside which are none");
}

}  // namespace

void compare_setting(const Task& task, const ChosenSettings& chosen, const Filter& filter,
                     std::vector<std::string>& reasons) {
  const auto& families = task.settings->families;
  if (std::find(families.begin(), families.end(), chosen.family) == families.end() ||
      !is_member(task, chosen.family, filter))
    reasons.push_back("the taps are no member of the task's families");
  if (!values_fit(task, chosen, filter)) reasons.push_back("the taps are not those that settings.values make");
}

void compare_settings(const DesignResult& result, std::vector<std::string>& reasons) {
  const auto& control = result.task.settings;
  const bool asked = control && control->names_family();
  const bool taps = control && result.settings && result.settings->family == SettingFamily::taps;
  if (!(asked || taps) || control->delays.empty()) {
    for (const CornerResult& corner : result.corners) {
      if (corner.feed_part < 1.0)
        reasons.push_back(fmt::format("corner {}: the task has no corner feeds", corner.name));
    }
  }
  const bool tree = result.certificate && std::holds_alternative<proof::BranchAndBound>(result.certificate->proof);
  if (tree && control && result.settings && control->names(DelayKind::corner_feed))
    reasons.push_back("the bound is of delays at full feed, and the task names corner feeds");
  if (taps) return compare_taps(result, reasons);
  if (!asked) {
    compare_one_kind(result, reasons);
    if (result.settings || result.family_bound || result.free_taps)
      reasons.push_back("settings are recorded, the task asks for none");
    return;
  }
  if (!result.settings) {
    reasons.push_back("the task asks for settings, none are recorded");
    return;
  }
  compare_setting(result.task, *result.settings, *result.filter, reasons);
  const Filter named = make_filter(result.settings->filter);
  if (!same_taps(*result.filter, {named.taps().begin(), named.taps().end()}))
    reasons.push_back("the taps are not those of settings.filter");
  compare_kinds(result, reasons);
  if (result.free_taps && result.lower_bound && *result.free_taps < *result.lower_bound * (1.0 - part))
    reasons.push_back("free_taps_s is below the lower bound");
  if (result.free_taps && *result.free_taps > result.objective() * (1.0 + part))
    reasons.push_back("free_taps_s is above the time of the settings");
  // Free taps that are no shorter are recorded with the time of the settings, whose corner feeds may lose parts of
  // samples.
  const bool shorter = result.free_taps && *result.free_taps < result.objective() * (1.0 - part);
  if (shorter && cost_of(result.task).whole()) {
    const double samples = *result.free_taps / result.task.sample_period;
    if (!(std::abs(samples - std::round(samples)) <= part * samples))
      reasons.push_back(fmt::format("free_taps_s is {:.9g} samples, and every time is a whole number", samples));
  }
  if (result.family_bound && *result.family_bound > result.objective() * (1.0 + part))
    reasons.push_back("family_bound_s is above the time of the settings");
}

}  // namespace accdec
