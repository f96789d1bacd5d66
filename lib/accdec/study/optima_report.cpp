#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/files/csv_table.hpp>
#include <accdec/formats/design_report.hpp>
#include <accdec/plot/figure.hpp>
#include <accdec/study/filters_figure.hpp>
#include <accdec/study/optima_report.hpp>

namespace accdec {
namespace {

using study::Optimum;
using Cells = std::vector<std::string>;

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

std::string milliseconds(double seconds) {
  return fmt::format("{:g}", std::round(seconds * 1e9) * 1e-6);
}

Cells header() {
  Cells cells{"task", "status", "N", "d", "cycle ms", "corners ms", "bound ms", "LPs", "time s", "proof"};
  for (const char* cell : {"best family", "its filter", "N", "d", "cycle ms", "saved %"}) cells.push_back(cell);
  return cells;
}

std::string proof_of(const Optimum& o) {
  if (!o.accepted) return "REJECTED";
  return o.design.lower_bound || o.design.status == Status::infeasible ? "accepted" : "none";
}

std::string delays_of(const DesignResult& design) {
  Cells delays;
  for (const CornerResult& corner : design.corners) delays.push_back(std::to_string(corner.delay));
  return delays.empty() ? "-" : fmt::format("{}", fmt::join(delays, " "));
}

std::string name_of(const Optimum& o, const BaselineResult& family) {
  return std::string(baselines()[static_cast<std::size_t>(&family - o.families.data())].name);
}

Cells cells_of(const Optimum& o) {
  const DesignResult& d = o.design;
  Cells cells{o.name,
              std::string(to_string(d.status)),
              d.filter ? std::to_string(d.filter->order()) : "-",
              delays_of(d),
              d.filter ? milliseconds(d.cycle_time) : "-",
              d.filter ? milliseconds(d.corner_time) : "-",
              d.lower_bound ? milliseconds(*d.lower_bound) : "-",
              std::to_string(d.solver.evaluations),
              fmt::format("{:.2g}", d.solver.wall_time),
              proof_of(o)};
  const BaselineResult* family = o.best_family();
  if (family == nullptr) {
    cells.insert(cells.end(), 5, "-");
  } else {
    const DesignResult& best = family->result;
    cells.push_back(name_of(o, *family) + (family->exact_stop ? ", exact stop" : ""));
    const std::string parameters = describe_parameters(*family->spec);
    cells.push_back(parameters.empty() ? "-" : parameters);
    cells.push_back(std::to_string(best.filter->order()));
    cells.push_back(delays_of(best));
    cells.push_back(milliseconds(best.cycle_time));
  }
  cells.push_back(o.saving() ? fmt::format("{:.1f}", 100.0 * *o.saving()) : "-");
  return cells;
}

std::string markdown(const std::vector<Optimum>& optima) {
  const auto line = [](const Cells& cells) { return fmt::format("| {} |\n", fmt::join(cells, " | ")); };
  Cells head = header();
  head.insert(head.begin(), "row");
  std::string text = line(head) + fmt::format("| {} |\n", fmt::join(Cells(head.size(), "---"), " | "));
  for (std::size_t i = 0; i < optima.size(); ++i) {
    Cells cells = cells_of(optima[i]);
    cells.insert(cells.begin(), std::to_string(i + 1));
    text += line(cells);
  }
  return text;
}

std::string csv(const std::vector<Optimum>& optima) {
  Cells head{"task",
             "status",
             "order",
             "delays",
             "cycle_time_ms",
             "corner_time_ms",
             "lower_bound_ms",
             "linear_programmes",
             "time_s",
             "check_time_s",
             "certificate_bytes",
             "proof"};
  for (const Baseline& family : baselines()) head.push_back(fmt::format("{}_ms", family.name));
  head.insert(head.end(), {"best_family", "its_parameters", "saving"});
  std::vector<Cells> rows;
  for (const Optimum& o : optima) {
    Cells cells = cells_of(o);
    cells.resize(10);
    cells[8] = fmt::format("{:.4g}", o.design.solver.wall_time);
    cells.insert(cells.begin() + 9, {fmt::format("{:.4g}", o.check_time), std::to_string(o.certificate_bytes)});
    std::replace(cells.begin(), cells.end(), std::string("-"), std::string());
    for (std::size_t i = 0; i < baselines().size(); ++i) {
      const bool held = i < o.families.size() && o.families[i].result.filter;
      cells.push_back(held ? milliseconds(o.families[i].result.cycle_time) : "");
    }
    const BaselineResult* best = o.best_family();
    cells.push_back(best ? name_of(o, *best) : "");
    cells.push_back(best ? describe_parameters(*best->spec) : "");
    cells.push_back(o.saving() ? fmt::format("{:.6f}", *o.saving()) : "");
    rows.push_back(std::move(cells));
  }
  return csv_table(head, rows);
}

Figure shapes_figure(const std::vector<Optimum>& optima) {
  Figure figure;
  figure.title = "Filters that controllers have beside the designed one, under the same limits";
  Panel panel;
  panel.x = {"cycle time over the optimum's", true, 0.9, {}};
  panel.y.min = 0.0;
  panel.y.max = static_cast<double>(optima.size()) + 1.0;
  for (const Optimum& o : optima) panel.y.names.push_back(o.name);
  const auto add = [&](const std::string& label, auto family_of) {
    Series series;
    series.label = label;
    series.mark = Mark::points;
    series.style = static_cast<int>(panel.series.size());
    for (std::size_t row = 0; row < optima.size(); ++row) {
      const Optimum& o = optima[row];
      const BaselineResult* family = o.design.filter ? family_of(o) : nullptr;
      if (family == nullptr || !family->result.filter) continue;
      // Side by side within the row: families often tie.
      series.y.push_back(static_cast<double>(row) + 1.0 + 0.12 * (static_cast<double>(series.style) - 2.0));
      series.x.push_back(family->result.objective() / o.design.objective());
    }
    panel.series.push_back(std::move(series));
  };
  // More would hide each other; the table has them all.
  for (const char* name : {"trapezoid", "s-curve", "blackman-sinc", "exponential"}) {
    const Baseline* family = find_baseline(name);
    const auto index = static_cast<std::size_t>(family - baselines().data());
    add(std::string(family->title),
        [=](const Optimum& o) { return index < o.families.size() ? &o.families[index] : nullptr; });
  }
  add("best of all families", [](const Optimum& o) { return o.best_family(); });
  double largest = 1.0;
  for (const Series& series : panel.series) {
    for (const double ratio : series.x) largest = std::max(largest, ratio);
  }
  panel.x.max = 1.04 * largest;
  panel.series.push_back({"optimum", {1.0, 1.0}, {0.0, *panel.y.max}, Mark::line, 0});
  figure.panels.push_back(std::move(panel));
  figure.panel_width = 820;
  figure.panel_height = 120 + 22 * static_cast<int>(optima.size());
  return figure;
}

Figure growth_figure(const std::vector<Optimum>& growth) {
  Figure figure;
  figure.title = "The exact method at ever shorter sample periods";
  const auto panel = [&](const char* label, auto... value) {
    Panel p;
    p.x = {"N + d / samples", true, {}, {}};
    p.y = {label, true, {}, {}};
    const auto decade = [](double x, bool up) {
      return std::pow(10.0, up ? std::ceil(std::log10(x)) : std::floor(std::log10(x)));
    };
    int style = 0;
    const auto add = [&](const auto& named) {
      Series series{named.first, {}, {}, Mark::line_points, style++};
      for (const Optimum& o : growth) {
        series.x.push_back(o.samples());
        series.y.push_back(o.design.filter ? named.second(o) : nothing);
        if (!(series.y.back() > 0.0 && series.x.back() > 0.0)) continue;
        p.x.min = std::min(p.x.min.value_or(1e300), decade(series.x.back(), false));
        p.x.max = std::max(p.x.max.value_or(0.0), decade(series.x.back(), true));
        p.y.min = std::min(p.y.min.value_or(1e300), decade(series.y.back(), false));
        p.y.max = std::max(p.y.max.value_or(0.0), decade(series.y.back(), true));
      }
      p.series.push_back(std::move(series));
    };
    (add(value), ...);
    figure.panels.push_back(std::move(p));
  };
  const auto named = [](const char* name, auto f) { return std::pair<std::string, decltype(f)>(name, f); };
  panel("Time / ms", named("design", [](const Optimum& o) { return 1e3 * o.design.solver.wall_time; }),
        named("recheck", [](const Optimum& o) { return 1e3 * o.check_time; }));
  panel("Count",
        named("programmes", [](const Optimum& o) { return static_cast<double>(o.design.solver.evaluations); }));
  panel("Size / kB",
        named("certificate", [](const Optimum& o) { return 1e-3 * static_cast<double>(o.certificate_bytes); }));
  figure.columns = 1;
  return figure;
}

std::string growth_csv(const std::vector<Optimum>& growth) {
  std::string text =
      "sample_period_ms,order,delay,status,time_s,linear_programmes,check_time_s,certificate_bytes,proof\n";
  for (const Optimum& o : growth) {
    const DesignResult& d = o.design;
    text +=
        fmt::format("{:g},{},{},{},{:.4g},{},{:.4g},{},{}\n", 1e3 * d.task.sample_period,
                    d.filter ? d.filter->order() : -1, d.corners.empty() ? -1 : d.corners[0].delay, to_string(d.status),
                    d.solver.wall_time, d.solver.evaluations, o.check_time, o.certificate_bytes, proof_of(o));
  }
  return text;
}

}  // namespace

std::vector<std::pair<std::string, std::string>> optima_documents(const std::vector<Optimum>& optima,
                                                                  const std::vector<Optimum>& growth) {
  std::vector<std::pair<std::string, std::string>> documents;
  documents.emplace_back("optima.csv", csv(optima));
  documents.emplace_back("optima.md", markdown(optima));
  const auto draw = [&](const std::string& name, const Figure& figure) {
    const std::string svg = render_svg(figure);
    documents.emplace_back(name + ".png", convert_svg(svg, "png"));
    documents.emplace_back(name + ".svg", svg);
  };
  draw("optima", shapes_figure(optima));
  for (const Optimum& o : optima) {
    if (const auto figure = filters_figure(o)) draw(fmt::format("{}-filters", o.name), *figure);
  }
  if (growth.empty()) return documents;
  documents.emplace_back("growth.csv", growth_csv(growth));
  draw("growth", growth_figure(growth));
  return documents;
}

std::string optima_text(const std::vector<Optimum>& optima) {
  TextTable table(header());
  table.left(1);
  for (const Optimum& o : optima) table.add(cells_of(o));
  return table.str();
}

}  // namespace accdec
