#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/files/csv_table.hpp>
#include <accdec/formats/report.hpp>
#include <accdec/plot/figure.hpp>
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
  for (const Shape shape : standard_shapes) cells.push_back(std::string(to_string(shape)));
  cells.push_back("saved %");
  return cells;
}

std::string proof_of(const Optimum& o) {
  if (!o.accepted) return "REJECTED";
  return o.design.lower_bound || o.design.status == Status::infeasible ? "accepted" : "none";
}

Cells cells_of(const Optimum& o) {
  const DesignResult& d = o.design;
  Cells delays;
  for (const CornerResult& corner : d.corners) delays.push_back(std::to_string(corner.delay));
  Cells cells{o.name,
              std::string(to_string(d.status)),
              d.filter ? std::to_string(d.filter->order()) : "-",
              delays.empty() ? "-" : fmt::format("{}", fmt::join(delays, " ")),
              d.filter ? milliseconds(d.cycle_time) : "-",
              d.filter ? milliseconds(d.corner_time) : "-",
              d.lower_bound ? milliseconds(*d.lower_bound) : "-",
              std::to_string(d.solver.evaluations),
              fmt::format("{:.2g}", d.solver.wall_time),
              proof_of(o)};
  for (const auto& shape : o.shapes) cells.push_back(shape ? milliseconds(*shape) : "-");
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
  for (const Shape shape : standard_shapes) head.push_back(fmt::format("{}_ms", to_string(shape)));
  head.push_back("saving");
  std::vector<Cells> rows;
  for (const Optimum& o : optima) {
    Cells cells = cells_of(o);
    std::replace(cells.begin(), cells.end(), std::string("-"), std::string());
    cells[8] = fmt::format("{:.4g}", o.design.solver.wall_time);
    cells.insert(cells.begin() + 9, {fmt::format("{:.4g}", o.check_time), std::to_string(o.certificate_bytes)});
    cells.back() = o.saving() ? fmt::format("{:.6f}", *o.saving()) : "";
    rows.push_back(std::move(cells));
  }
  return csv_table(head, rows);
}

Figure shapes_figure(const std::vector<Optimum>& optima) {
  Figure figure;
  figure.title = "Standard shapes beside the designed filter, under the same limits";
  Panel panel;
  panel.x.label = "Task, by its row in optima.md";
  panel.y = {"Cycle time over the optimum's", true, 0.9, {}};
  panel.x.min = 0.0;
  panel.x.max = static_cast<double>(optima.size()) + 1.0;
  for (std::size_t i = 0; i < standard_shapes.size(); ++i) {
    Series series;
    series.label = std::string(to_string(standard_shapes[i]));
    series.mark = Mark::points;
    series.style = static_cast<int>(i);
    for (std::size_t row = 0; row < optima.size(); ++row) {
      const Optimum& o = optima[row];
      if (!o.shapes[i] || !o.design.filter) continue;
      // Side by side within the row: shapes often tie.
      series.x.push_back(static_cast<double>(row) + 1.0 + 0.08 * (static_cast<double>(i) - 2.5));
      series.y.push_back(*o.shapes[i] / o.design.objective());
    }
    panel.series.push_back(std::move(series));
  }
  panel.limits.push_back({1.0, "optimum"});
  figure.panels.push_back(std::move(panel));
  figure.panel_width = 820;
  figure.panel_height = 420;
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
