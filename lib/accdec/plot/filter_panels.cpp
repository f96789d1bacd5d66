#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>

#include <accdec/machine.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/plot/figure_style.hpp>
#include <accdec/plot/filter_panels.hpp>

namespace accdec {
namespace {

using namespace figure_style;

/// The modes as bands with the bounds on them. A bound that binds is wide, and its worst frequency is marked.
void add_modes(Panel& panel, const DesignResult& result, double top) {
  double most = 0.0;
  for (const Mode& mode : result.task.machine.modes) {
    const bool first = panel.bands.empty();
    panel.bands.push_back({mode.frequency_low, mode.frequency_high, first ? "mode" : ""});
    const double half =
        std::max(0.0, 0.004 * top - 0.5 * (mode.frequency_high - mode.frequency_low));  // a line has to be seen
    panel.bands.back().from -= half, panel.bands.back().to += half;
    const LimitUse* worst = nullptr;
    const double bound = mode.of_axis() ? mode.displacement_max : mode.residual_max;
    for (const LimitUse& use : result.limits) {
      const bool here = use.kind == (mode.of_axis() ? LimitKind::residual : LimitKind::vibration) &&
                        use.frequency >= mode.frequency_low && use.frequency <= mode.frequency_high &&
                        std::abs(use.bound - bound) <= 1e-15 * bound;  // rounded in files of axes that turn
      if (here && (!worst || use.utilisation > worst->utilisation)) worst = &use;
    }
    const bool binds = worst && worst->utilisation > binding;
    if (mode.of_axis()) {  // its bound is an amplitude, not a part
      if (worst && worst->utilisation > most) {
        most = worst->utilisation;
        panel.title = fmt::format("residual vibration of {}:", worst->axis) + use_in_title(*worst);
      }
      continue;
    }
    const double level = std::max(mode.residual_max, 1e-4);
    panel.series.push_back({first ? "bound" : "",
                            {mode.frequency_low - half, mode.frequency_high + half},
                            {level, level},
                            Mark::line,
                            binds ? binding_style + static_cast<int>(most_lines) / 3 : thin_style,
                            true});
    if (!worst) continue;
    const char* const name = binds ? "binds" : "largest use";
    const bool named = std::ranges::find(panel.series, name, &Series::label) != panel.series.end();
    panel.series.push_back({named ? "" : name,
                            {worst->frequency},
                            {std::max(worst->value, 1e-4)},
                            Mark::points,
                            binds ? binding_style : 0});
    if (worst->utilisation > most) {
      most = worst->utilisation;
      panel.title = "residual vibration:" + use_in_title(*worst);
    }
  }
}

/// Residual vibration of a filter up to a frequency for every damping; the first damping's line is solid.
void add_response(Panel& panel, const Filter& filter, double period, double top, const std::set<double>& dampings,
                  const Series& look) {
  // Each point takes a pass over all taps.
  const int points = static_cast<int>(std::clamp(1e8 / (filter.order() + 1.0), 100.0, 800.0));
  for (const double damping : dampings) {
    Series response = look;
    if (*dampings.rbegin() > 0.0)
      response.label += fmt::format("{}damping {:.4g}", look.label.empty() ? "" : ", ", damping);
    response.solid = damping == *dampings.begin();
    for (int i = 0; i <= points; ++i) {
      const double f = top * i / points;
      response.x.push_back(f);
      response.y.push_back(std::max(residual_vibration(filter, f, period, damping), 1e-6));
    }
    panel.series.push_back(std::move(response));
  }
}

}  // namespace

const LimitUse* use_of(const DesignResult& result, LimitKind kind, const std::string& corner) {
  const LimitUse* most = nullptr;
  for (const LimitUse& use : result.limits) {
    if (use.kind == kind && use.corner == corner && (!most || use.utilisation > most->utilisation)) most = &use;
  }
  return most;
}

std::string use_in_title(const LimitUse& use) {
  return fmt::format(" {:.1f} % used{}", 100.0 * use.utilisation, use.utilisation > binding ? ", binding" : "");
}

Panel taps_panel(const Filter& filter, const Filter* before) {
  Panel panel;
  panel.title = fmt::format("weights of the filter taps, order {}", filter.order());
  panel.x.label = "tap";
  const auto taps = [](const Filter& of, std::string label, Mark mark, int style) {
    Series series{std::move(label), {}, {}, mark, style, true};
    for (int i = 0; i <= of.order(); ++i) {
      series.x.push_back(i);
      series.y.push_back(of.tap(i));
    }
    // The edges of a curve without symbols, which could be a level line.
    if (mark == Mark::line) {
      series.x.insert(series.x.begin(), 0.0), series.y.insert(series.y.begin(), 0.0);
      series.x.push_back(of.order()), series.y.push_back(0.0);
    }
    return series;
  };
  int last = filter.order();
  if (before) {
    panel.title += fmt::format("; today {}", before->order());
    panel.series.push_back(taps(*before, "today", Mark::line_points, baseline_style));
    last = std::max(last, before->order());
  }
  panel.series.push_back(
      taps(filter, before ? "designed" : "", last <= 200 ? Mark::impulses : Mark::line, design_style));
  panel.x.min = -1.0, panel.x.max = last + 1.0, panel.y.min = 0.0;
  return panel;
}

Panel response_panel(const DesignResult& result, const Filter* before) {
  const double period = result.task.sample_period;
  const Response response(result.task.machine, period);
  const std::vector<Mode>& modes = result.task.machine.modes;
  Panel panel;
  panel.title = "residual vibration, part of that without a filter";
  panel.x.label = "frequency / Hz";
  panel.y.log = true;
  panel.y.max = 1.5;
  const Filter filter = response.command(*result.filter);
  double top = 8.0 / ((filter.order() + 1) * period);
  for (const Mode& mode : modes) top = std::max(top, 1.5 * mode.frequency_high);
  top = std::min(top, 0.5 / period);
  panel.x.min = 0.0, panel.x.max = top;
  add_modes(panel, result, top);
  std::set<double> dampings;
  for (const Mode& mode : modes) dampings.insert({mode.damping_low, mode.damping_high});
  if (dampings.empty()) dampings.insert(0.0);
  if (before)
    add_response(panel, response.command(*before), period, top, dampings,
                 {"today", {}, {}, Mark::line, baseline_style});
  add_response(panel, filter, period, top, dampings, {before ? "designed" : "", {}, {}, Mark::line, design_style});
  double least = 1.0;
  for (const Series& series : panel.series) least = std::min(least, std::ranges::min(series.y));
  panel.y.min = std::clamp(std::pow(10.0, std::floor(std::log10(least))), 1e-4, 0.1);
  return panel;
}

}  // namespace accdec
