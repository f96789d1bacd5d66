#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <accdec/machine/limits.hpp>
#include <accdec/plot/figure_style.hpp>
#include <accdec/study/filters_figure.hpp>
#include <accdec/task/simulation.hpp>

namespace accdec {
namespace {

struct Compared {
  std::string label;
  const DesignResult* result;
};

/// The axis limit that a design uses most at its first corner; null if no axis has a limit.
const LimitUse* tightest(const DesignResult& design) {
  const LimitUse* most = nullptr;
  for (const LimitUse& use : design.limits) {
    const bool of_axis = std::any_of(axis_limits.begin(), axis_limits.end(),
                                     [&](const AxisLimit& limit) { return limit.kind == use.kind; });
    if (of_axis && use.corner == design.corners.front().name &&
        (most == nullptr || use.utilisation > most->utilisation))
      most = &use;
  }
  return most;
}

std::vector<Compared> compared(const study::Optimum& optimum) {
  std::vector<Compared> filters;
  const auto add = [&](std::string_view title, const DesignResult& result) {
    if (!result.filter) return;
    std::string delays;
    for (const CornerResult& corner : result.corners) delays += fmt::format(" {}", corner.delay);
    // The legend has no room for what a title says in brackets.
    const std::string_view name = title.substr(0, title.find(" ("));
    filters.push_back({fmt::format("{}: N = {}, d ={}, {:.6g}\u00a0ms", name, result.filter->order(), delays,
                                   1e3 * result.cycle_time),
                       &result});
  };
  add("optimum", optimum.design);
  for (const char* name : {"trapezoid", "exponential"}) {
    const Family* family = find_family(name);
    const auto index = static_cast<std::size_t>(family - families().data());
    if (index < optimum.families.size()) add(family->title, optimum.families[index].result);
  }
  return filters;
}

}  // namespace

std::optional<Figure> filters_figure(const study::Optimum& optimum) {
  if (!optimum.design.filter || optimum.design.corners.empty()) return std::nullopt;
  const Task& task = optimum.design.task;
  const double period = task.sample_period;
  const Corner& corner = task.corners.front().geometry();
  const LimitUse* limit = tightest(optimum.design);
  const auto axis = std::find_if(task.machine.axes.begin(), task.machine.axes.end(),
                                 [&](const Axis& a) { return limit != nullptr && a.name == limit->axis; });
  Panel taps, speed, use;
  taps.title = "taps", speed.title = "speed / mm/s";
  taps.x.label = "time / ms";
  speed.x.label = use.x.label = "time from the corner command / ms";
  for (const auto& [label, result] : compared(optimum)) {
    Series b{label, {}, {}, Mark::line, figure_style::design_style, true};
    if (result != &optimum.design) {
      const bool first = taps.series.size() == 1;
      b.style = first ? figure_style::baseline_style : 4, b.dash = first ? 1 : 3;
    }
    Series v = b, u = b;
    for (int i = 0; i <= result->filter->order(); ++i) {
      b.x.push_back(1e3 * period * i);
      b.y.push_back(result->filter->tap(i));
    }
    const SampledResponse sampled =
        simulate_response(*result->filter, corner, result->corners.front().delay, period, task.machine);
    const SampledMotion &motion = sampled.motion(), &command = sampled.command;
    std::optional<AxisSampler> sampler;
    const auto column = static_cast<Eigen::Index>(axis - task.machine.axes.begin());
    const double still = still_part * std::max(corner.feed_in, corner.feed_out);
    if (axis != task.machine.axes.end()) sampler.emplace(*axis, period, still);
    for (Eigen::Index n = 0; n < motion.velocity.rows(); ++n) {
      v.x.push_back(1e3 * period * static_cast<double>(n - motion.corner));
      v.y.push_back(1e3 * motion.velocity.row(n).norm());
      if (!sampler) continue;
      const AxisLimit& bound = axis_limit(limit->kind);
      const AxisState state = with_load(sampler->next(command.velocity(n, column), command.acceleration(n, column)),
                                        *axis, motion.velocity(n, column), motion.acceleration(n, column), still);
      u.x.push_back(v.x.back());
      u.y.push_back(100.0 * bound.value(state) / ((*axis).*bound.bound));
    }
    taps.series.push_back(std::move(b));
    speed.series.push_back(std::move(v));
    use.series.push_back(std::move(u));
  }
  Figure figure;
  figure.title = fmt::format("{}: the optimum beside two averages and an exponential", optimum.name);
  figure.one_legend = true;
  figure.panel_width = 820;
  figure.panel_height = 240;
  figure.panels = {taps, speed};
  if (axis != task.machine.axes.end()) {
    use.title = fmt::format("{} of {}, % of its limit", limit_name(limit->kind).name, axis->name);
    use.limits.push_back({100.0, "limit"});
    figure.panels.push_back(std::move(use));
  }
  return figure;
}

}  // namespace accdec
