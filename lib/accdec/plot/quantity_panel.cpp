#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include <accdec/files/units.hpp>
#include <accdec/plot/figure_style.hpp>
#include <accdec/plot/filter_panels.hpp>
#include <accdec/plot/quantity_panel.hpp>

namespace accdec {

using namespace figure_style;

QuantityPanel::QuantityPanel(LimitUnit shown, std::string_view name, Panel panel)
    : unit_(shown), panel_(std::move(panel)) {
  const Unit* const unit = find_unit(unit_.name);
  panel_.title = fmt::format("{} / {}", name, unit ? unit->printed : unit_.name);
}

void QuantityPanel::add(const std::string& name, int dash, Series curve, const Series* before, const Bounds& bounds) {
  Line line{name, bounds.low * unit_.per_si, bounds.high * unit_.per_si};
  for (std::size_t n = 0; n < curve.y.size(); ++n) {
    const double used = std::max(curve.y[n] / line.high, curve.y[n] / line.low);
    if (used > line.use) line.use = used, line.worst = {curve.x[n], curve.y[n]};
    peak_ = std::max(peak_, std::abs(curve.y[n]));
  }
  if (line.use > binding) add_bars(curve, line);
  lines_.push_back(line);
  curve.label = name.empty() ? "designed" : name, curve.dash = dash;
  curves_.push_back(std::move(curve));
  if (!before) return;
  Series old = *before;
  old.label = name.empty() ? "today" : name + " today", old.style = baseline_style, old.dash = dash;
  panel_.series.push_back(std::move(old));
}

Panel QuantityPanel::finished() {
  std::move(curves_.begin(), curves_.end(), std::back_inserter(panel_.series));
  std::move(bars_.begin(), bars_.end(), std::back_inserter(panel_.series));
  if (lines_.size() > 1) panel_.notes = std::move(notes_);
  const auto worst = std::ranges::max_element(lines_, {}, &Line::use);
  if (worst->use > 0.0) {
    panel_.title += ": " + bound() + uses() + (lines_.size() == 1 && worst->use > binding ? ", binding" : "");
    if (worst->use <= binding)
      panel_.series.push_back({"largest use", {worst->worst.first}, {worst->worst.second}, Mark::points, 0});
  }
  add_limits();
  return std::move(panel_);
}

/// The limit itself, drawn over every sample that reaches it: the upper and the lower one apart, or steps would join
/// them.
void QuantityPanel::add_bars(const Series& curve, const Line& line) {
  for (const double limit : {line.high, line.low}) {
    Series bars{bars_.empty() ? "binds" : "", curve.x, {}, Mark::steps, binding_style + most_lines / 3, true};
    bars.y.assign(curve.y.size(), std::nan(""));
    bool any = false;
    for (std::size_t n = 0; n < curve.y.size(); ++n) {
      if (!std::isfinite(limit) || !(curve.y[n] / limit >= binding)) continue;
      bars.y[n] = limit;
      if (n > 0) bars.y[n - 1] = limit;  // a step ends at its sample
      any = true;
    }
    name_bars(bars, limit, line.name);
    if (any) bars_.push_back(std::move(bars));
  }
}

/// The axis, beside each of its bars. Bars that overlap, or nearly, have one note with all names.
void QuantityPanel::name_bars(const Series& bars, double limit, const std::string& name) {
  const double near = 0.03 * (*panel_.x.max - *panel_.x.min);
  for (std::size_t first = 0; first < bars.y.size(); ++first) {
    if (std::isnan(bars.y[first])) continue;
    std::size_t last = first;
    while (last + 1 < bars.y.size() && !std::isnan(bars.y[last + 1])) ++last;
    const double middle = 0.5 * (bars.x[first] + bars.x[last]);
    first = last;
    const auto there = std::ranges::find_if(
        notes_, [&](const Note& note) { return note.y == limit && std::abs(note.x - middle) < near; });
    if (there == notes_.end())
      notes_.push_back({middle, limit, name, limit < 0.0});
    else if (!there->text.ends_with(name))
      there->text += ", " + name;
  }
}

/// "y binds; ", where there are several axes.
std::string QuantityPanel::bound() const {
  std::string names;
  std::size_t count = 0;
  for (const Line& line : lines_) {
    if (line.use <= binding) continue;
    names += (names.empty() ? "" : ", ") + line.name;
    ++count;
  }
  return count == 0 || lines_.size() == 1 ? "" : fmt::format("{} bind{}; ", names, count == 1 ? "s" : "");
}

/// "x 40.0 %, y 98.2 % used"
std::string QuantityPanel::uses() const {
  std::string text;
  for (const Line& line : lines_) {
    if (!std::isfinite(line.low) && !std::isfinite(line.high)) continue;
    text += fmt::format("{}{}{}{:.1f} %", text.empty() ? "" : ", ", line.name, line.name.empty() ? "" : " ",
                        100.0 * line.use);
  }
  return text + " used";
}

void QuantityPanel::add_limits() {
  constexpr double off_scale = 1.6 * (1.0 + 1e-9);  // farther limits would leave half of the panel empty
  std::string beyond, before;
  for (const Line& line : lines_) {
    std::string far;
    for (const double limit : {line.high, line.low}) {
      const bool known = std::ranges::find(panel_.limits, limit, &LimitLine::y) != panel_.limits.end();
      if (!std::isfinite(limit) || known) continue;
      if (std::abs(limit) <= off_scale * peak_)
        panel_.limits.push_back({limit, panel_.limits.empty() ? "limit" : ""});
      else if (line.low == -line.high)
        far = fmt::format(" ±{:.6g}", line.high);
      else
        far += fmt::format(" {:.6g}", limit);
    }
    // Axes with the same limits are named together.
    if (far.empty()) continue;
    beyond += far == before ? "" : (beyond.empty() ? "" : ",") + far;
    if (lines_.size() > 1) beyond += (far == before ? " and " : " of ") + line.name;
    before = far;
  }
  if (!beyond.empty()) panel_.title += fmt::format("; limit{}, off scale", beyond);
  name_limits();
}

/// The axes of each limit that is drawn, unless it is that of all axes. If a limit has both signs, the upper line has
/// the names.
void QuantityPanel::name_limits() {
  for (LimitLine& limit : panel_.limits) {
    const bool drawn_above =
        limit.y < 0.0 && std::ranges::find(panel_.limits, -limit.y, &LimitLine::y) != panel_.limits.end();
    std::size_t count = 0;
    for (const Line& line : lines_) {
      if (line.high != limit.y && line.low != limit.y) continue;
      if (!drawn_above) limit.name += (limit.name.empty() ? "" : ", ") + line.name;
      ++count;
    }
    if (count == lines_.size()) limit.name.clear();
  }
}

}  // namespace accdec
