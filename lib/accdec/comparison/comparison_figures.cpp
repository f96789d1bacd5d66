#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/comparison/comparison_report.hpp>

namespace accdec {
namespace {

using comparison::Attempt;
using comparison::ComparisonData;
using comparison::Distribution;

/// Solvers of one panel.
struct Group {
  std::string title;
  std::vector<std::size_t> solvers;
};

bool one_panel_each(const ComparisonData& data) {
  return data.solvers.size() > most_lines;
}

/// The panel of a solver: one algorithm with its variants if there are many; else solvers with derivatives, or with
/// values only.
std::string group_of(const ComparisonData& data, std::size_t solver) {
  if (one_panel_each(data)) return data.algorithms[solver];
  return data.header.at("solvers").at(solver).value("uses", "") == "values" ? "Values only" : "With derivatives";
}

std::vector<Group> groups(const ComparisonData& data, bool design) {
  std::vector<Group> all;
  for (std::size_t s = 0; s < data.solvers.size(); ++s) {
    if (!data.takes_part(design, s)) continue;
    const std::string title = group_of(data, s);
    auto group = std::find_if(all.begin(), all.end(), [&](const Group& g) { return g.title == title; });
    if (group == all.end()) group = all.insert(all.end(), {title, {}});
    group->solvers.push_back(s);
  }
  return all;
}

/// The style is the same in every panel and figure. Among fifteen solvers in a panel no symbol appears twice.
int style_of(const ComparisonData& data, std::size_t solver) {
  int style = 0;
  for (std::size_t s = 0; s < solver; ++s) style += group_of(data, s) == group_of(data, solver) ? 1 : 0;
  return style;
}

/// The steps of a distribution from `low` to `high`, as a line.
Series steps(const Distribution& d, double low, double high, const std::string& label, int style) {
  Series s;
  s.label = label;
  s.style = style;
  s.mark = Mark::marked_line;
  double y = comparison::at(d, low);
  s.x.push_back(low);
  s.y.push_back(y);
  for (std::size_t i = 0; i < d.x.size(); ++i) {
    if (d.x[i] <= low || d.x[i] > high) continue;
    s.x.insert(s.x.end(), {d.x[i], d.x[i]});
    s.y.insert(s.y.end(), {y, d.y[i]});
    y = d.y[i];
  }
  s.x.push_back(high);
  s.y.push_back(y);
  return s;
}

/// Decades around all finite values.
std::pair<double, double> decades(const std::vector<std::vector<double>>& values) {
  double low = INFINITY, high = 0.0;
  for (const auto& list : values) {
    for (const double v : list) {
      if (std::isfinite(v) && v > 0.0) low = std::min(low, v), high = std::max(high, v);
    }
  }
  if (high == 0.0) return {1.0, 10.0};
  low = std::pow(10.0, std::floor(std::log10(low)));
  high = std::pow(10.0, std::ceil(std::log10(high)));
  return {low, high > low ? high : 10.0 * low};
}

Panel panel_of(std::string title, std::string x, std::string y, std::pair<double, double> range) {
  Panel panel;
  panel.title = std::move(title);
  panel.x = {std::move(x), true, range.first, range.second};
  panel.y = {std::move(y), false, -0.03,
             1.03};  // away from the frame, where lines of solvers that solve none or all would be hidden
  return panel;
}

/// One panel per group, one line per solver: the share of `values[solver]` up to x.
void add_panels(Figure& figure, const ComparisonData& data, bool design, const std::vector<std::vector<double>>& values,
                const std::string& title, const std::string& x, const std::string& y, double least_low) {
  auto range = decades(values);
  range.first = std::max(range.first, least_low);
  if (range.second <= range.first) range.second = 10.0 * range.first;
  for (const Group& group : groups(data, design)) {
    Panel panel = panel_of(title.empty() ? group.title : fmt::format("{}: {}", title, group.title), x, y, range);
    for (const std::size_t s : group.solvers)
      panel.series.push_back(
          steps(comparison::distribution(values[s]), range.first, range.second, data.solvers[s], style_of(data, s)));
    figure.panels.push_back(std::move(panel));
  }
}

Figure page(std::string title, int columns, int width = 640, int height = 380) {
  Figure figure;
  figure.title = std::move(title);
  figure.columns = columns;
  figure.panel_width = width;
  figure.panel_height = height;
  return figure;
}

int columns_of(const ComparisonData& data) {
  return one_panel_each(data) ? 3 : 2;
}

std::string to_accuracy(const ComparisonData& data) {
  return fmt::format("time until within {:g} of the reference", data.accuracy);
}

/// The value that the profiles' costs are divided by.
std::string least_of(const ComparisonData& data) {
  return data.plain.size() == data.solvers.size() ? "least of all solvers" : "least of the plain solvers";
}

Figure performance(const ComparisonData& data, bool design, const std::string& of) {
  Figure figure = page(fmt::format("Performance profiles by {}, {}", to_accuracy(data), of), columns_of(data));
  const auto costs = data.costs(design, [](const Attempt& a) { return a.accuracy_cost; });
  add_panels(figure, data, design, comparison::performance_ratios(costs, data.plain), "",
             "time to accuracy / " + least_of(data), "share of problems solved", 1.0);
  return figure;
}

Figure performance_to_the_end(const ComparisonData& data, bool design, const std::string& of) {
  Figure figure = page(fmt::format("Performance profiles by time until the solver ends, {}", of), columns_of(data));
  const auto costs = data.costs(design, [](const Attempt& a) { return a.end_cost; });
  add_panels(figure, data, design, comparison::performance_ratios(costs, data.plain), "",
             "time to the solver's end / " + least_of(data), "share of problems solved", 1.0);
  return figure;
}

Figure pairwise(const ComparisonData& data, bool design, const std::string& of) {
  const auto costs = data.costs(design, [](const Attempt& a) { return a.accuracy_cost; });
  std::size_t best = 0, most = 0;
  for (const std::size_t s : data.plain) {
    const auto solved = static_cast<std::size_t>(
        std::count_if(costs[s].begin(), costs[s].end(), [](double c) { return std::isfinite(c); }));
    if (solved > most) most = solved, best = s;
  }
  Figure figure = page(fmt::format("Performance profiles of pairs by {}, {}: {} against each other solver",
                                   to_accuracy(data), of, data.solvers[best]),
                       2, 640, 300);
  for (std::size_t s = 0; s < costs.size(); ++s) {
    if (s == best || !data.takes_part(design, s)) continue;
    const auto ratios = comparison::performance_ratios({costs[best], costs[s]});
    auto range = decades(ratios);
    range.first = 1.0;
    Panel panel = panel_of(fmt::format("{} and {}", data.solvers[best], data.solvers[s]),
                           "time to accuracy / lesser of the two", "share of problems solved", range);
    panel.series.push_back(
        steps(comparison::distribution(ratios[0]), range.first, range.second, data.solvers[best], 0));
    panel.series.push_back(steps(comparison::distribution(ratios[1]), range.first, range.second, data.solvers[s],
                                 1));  // the two may have the same style elsewhere
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

Figure data_profiles(const ComparisonData& data, bool design, const std::string& of) {
  Figure figure = page(fmt::format("Data profiles by evaluations of objective or rows (derivatives free), {}", of),
                       columns_of(data));
  const std::vector<int> variables = data.variables(design);
  for (std::size_t t = 0; t < data.targets.size(); ++t) {
    auto values = data.costs(design, [t](const Attempt& a) { return a.target_evaluations[t]; });
    for (auto& list : values) list = comparison::simplex_gradients(list, variables);
    add_panels(figure, data, design, values, fmt::format("within {:g} of the reference", data.targets[t]),
               "evaluations / (variables + 1)", "share of problems that met it", 1e-4);
  }
  return figure;
}

Figure runtimes(const ComparisonData& data, bool design, const std::string& of) {
  Figure figure = page(fmt::format("Time until within {:g} of the reference, {}", fmt::join(data.targets, ", "), of),
                       columns_of(data));
  std::vector<std::vector<double>> all(data.solvers.size());
  for (std::size_t t = 0; t < data.targets.size(); ++t) {
    const auto values = data.costs(design, [t](const Attempt& a) { return std::max(a.target_time[t], 1e-5); });
    for (std::size_t s = 0; s < all.size(); ++s) all[s].insert(all[s].end(), values[s].begin(), values[s].end());
  }
  add_panels(figure, data, design, all, "", "time / s", "share of problems x targets met", 1e-5);
  return figure;
}

}  // namespace

std::vector<std::pair<std::string, Figure>> comparison_figures(const ComparisonData& data) {
  std::vector<std::pair<std::string, Figure>> figures;
  for (const bool design : {false, true}) {
    if (data.profiled(design).empty() || groups(data, design).empty()) continue;
    const std::string prefix = design ? "design-" : "", of = design ? "designs at fixed order" : "nonlinear problems";
    figures.emplace_back(prefix + "performance", performance(data, design, of));
    figures.emplace_back(prefix + "performance-end", performance_to_the_end(data, design, of));
    if (Figure pairs = pairwise(data, design, of); !pairs.panels.empty())
      figures.emplace_back(prefix + "pairs", std::move(pairs));
    if (!design) figures.emplace_back("data", data_profiles(data, design, of));
    figures.emplace_back(prefix + "runtime", runtimes(data, design, of));
  }
  return figures;
}

}  // namespace accdec
