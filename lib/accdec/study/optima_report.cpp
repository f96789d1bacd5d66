#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/files/csv_table.hpp>
#include <accdec/files/shown_text.hpp>
#include <accdec/formats/design_report.hpp>
#include <accdec/plot/figure.hpp>
#include <accdec/study/filters_figure.hpp>
#include <accdec/study/optima_report.hpp>

namespace accdec {
namespace {

using study::Optimum;
using Cells = std::vector<std::string>;

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

std::string proof_of(const Optimum& o) {
  if (!o.accepted) return "REJECTED";
  return o.design.lower_bound || o.design.status == Status::infeasible ? "accepted" : "none";
}

std::string delays_of(const DesignResult& design) {
  Cells delays;
  for (const CornerResult& corner : design.corners) delays.push_back(std::to_string(corner.delay));
  return fmt::format("{}", fmt::join(delays, " "));
}

const Family& baseline_of(const Optimum& o, const FamilyResult& family) {
  return families()[static_cast<std::size_t>(&family - o.families.data())];
}
std::string name_of(const Optimum& o, const FamilyResult& family) {
  return std::string(baseline_of(o, family).name);
}
std::string title_of(const Optimum& o, const FamilyResult& family) {
  return baseline_of(o, family).title;
}

const char* stop_note(const DesignResult& result) {
  return stops_exactly(result) ? ", exact stop" : "";
}

/// A column of the table in the report, of the CSV, or of both. Empty cells are shown as "-" in the report.
struct OptimaColumn {
  const char* heading;  ///< in the report; null: not in it
  const char* csv;      ///< in the CSV, with its unit; null: not in it
  std::string (*cell)(const Optimum& o);
};

const OptimaColumn of_design[] = {
    {"task", "task", [](const Optimum& o) { return o.name; }},
    {"status", "status", [](const Optimum& o) { return std::string(to_string(o.design.status)); }},
    {"N", "order", [](const Optimum& o) { return o.design.filter ? std::to_string(o.design.filter->order()) : ""; }},
    {"d", nullptr, [](const Optimum& o) { return delays_of(o.design) + stop_note(o.design); }},
    {nullptr, "delays", [](const Optimum& o) { return delays_of(o.design); }},
    {"cycle ms", "cycle_time_ms",
     [](const Optimum& o) { return o.design.filter ? shown_ms(o.design.cycle_time) : ""; }},
    {"corners ms", "corner_time_ms",
     [](const Optimum& o) { return o.design.filter ? shown_ms(o.design.corner_time) : ""; }},
    {"bound ms", "lower_bound_ms",
     [](const Optimum& o) { return o.design.lower_bound ? shown_ms(*o.design.lower_bound) : ""; }},
    {"LPs", "linear_programmes", [](const Optimum& o) { return std::to_string(o.design.solver.evaluations); }},
    {"time s", nullptr, [](const Optimum& o) { return fmt::format("{:.2g}", o.design.solver.wall_time); }},
    {nullptr, "time_s", [](const Optimum& o) { return fmt::format("{:.4g}", o.design.solver.wall_time); }},
    {nullptr, "check_time_s", [](const Optimum& o) { return fmt::format("{:.4g}", o.check_time); }},
    {nullptr, "certificate_bytes", [](const Optimum& o) { return std::to_string(o.certificate_bytes); }},
    {"proof", "proof", proof_of},
};

/// A value of the best family; empty if no family holds the limits.
template <auto value>
std::string of_best(const Optimum& o) {
  const FamilyResult* best = o.best_family();
  return best == nullptr ? "" : value(o, *best);
}

const OptimaColumn of_family[] = {
    {"best family", nullptr, of_best<title_of>},
    {nullptr, "best_family", of_best<name_of>},
    {"its filter", nullptr,
     of_best<[](const Optimum&, const FamilyResult& best) { return describe_parameters(*best.spec); }>},
    {nullptr, "its_parameters",
     of_best<[](const Optimum&, const FamilyResult& best) { return describe_parameters(*best.spec, Digits::all); }>},
    {"N", nullptr,
     of_best<[](const Optimum&, const FamilyResult& best) { return std::to_string(best.result.filter->order()); }>},
    {"d", nullptr,
     of_best<[](const Optimum&, const FamilyResult& best) { return delays_of(best.result) + stop_note(best.result); }>},
    {"cycle ms", nullptr,
     of_best<[](const Optimum&, const FamilyResult& best) { return shown_ms(best.result.cycle_time); }>},
    {"saved %", nullptr, [](const Optimum& o) { return o.saving() ? fmt::format("{:.1f}", 100.0 * *o.saving()) : ""; }},
    {nullptr, "saving", [](const Optimum& o) { return o.saving() ? fmt::format("{:.6f}", *o.saving()) : ""; }},
};

/// The heading and one row each, without columns that only the CSV has.
std::vector<Cells> shown(const std::vector<Optimum>& optima) {
  std::vector<Cells> lines(optima.size() + 1);
  for (const std::span<const OptimaColumn> part :
       {std::span<const OptimaColumn>(of_design), std::span<const OptimaColumn>(of_family)}) {
    for (const OptimaColumn& column : part) {
      if (column.heading == nullptr) continue;
      lines[0].emplace_back(column.heading);
      for (std::size_t i = 0; i < optima.size(); ++i) {
        const std::string cell = column.cell(optima[i]);
        lines[i + 1].push_back(cell.empty() ? "-" : cell);
      }
    }
  }
  return lines;
}

std::string markdown(const std::vector<Optimum>& optima) {
  std::vector<Cells> lines = shown(optima);
  for (std::size_t i = 0; i < lines.size(); ++i) lines[i].insert(lines[i].begin(), i == 0 ? "row" : std::to_string(i));
  lines.insert(lines.begin() + 1, Cells(lines[0].size(), "---"));
  std::string text;
  for (const Cells& cells : lines) text += fmt::format("| {} |\n", fmt::join(cells, " | "));
  return text;
}

std::string csv(const std::vector<Optimum>& optima) {
  Cells head;
  std::vector<Cells> rows(optima.size());
  const auto add = [&](const std::string& name, const auto& cell) {
    head.push_back(name);
    for (std::size_t i = 0; i < optima.size(); ++i) rows[i].push_back(cell(optima[i]));
  };
  for (const OptimaColumn& column : of_design) {
    if (column.csv != nullptr) add(column.csv, column.cell);
  }
  for (std::size_t f = 0; f < families().size(); ++f) {
    add(fmt::format("{}_ms", families()[f].name), [f](const Optimum& o) {
      const bool held = f < o.families.size() && o.families[f].result.filter;
      return held ? shown_ms(o.families[f].result.cycle_time) : "";
    });
  }
  for (const OptimaColumn& column : of_family) {
    if (column.csv != nullptr) add(column.csv, column.cell);
  }
  return csv_table(head, rows);
}

Figure shapes_figure(const std::vector<Optimum>& optima) {
  Figure figure;
  figure.title = "Filters that controllers have beside the designed one, under the same limits";
  Panel panel;
  panel.x = {"cycle time over the optimum's", false, 0.9, {}};
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
      const FamilyResult* family = o.design.filter ? family_of(o) : nullptr;
      if (family == nullptr || !family->result.filter) continue;
      // Markers stand side by side within the row, because families often tie.
      series.y.push_back(static_cast<double>(row) + 1.0 + 0.12 * (static_cast<double>(series.style) - 2.0));
      series.x.push_back(family->result.objective() / o.design.objective());
    }
    panel.series.push_back(std::move(series));
  };
  // More markers would hide each other; the table has them all.
  for (const char* name : {"trapezoid", "s-curve", "blackman-sinc", "exponential"}) {
    const Family* family = find_family(name);
    const auto index = static_cast<std::size_t>(family - families().data());
    add(family->title, [=](const Optimum& o) { return index < o.families.size() ? &o.families[index] : nullptr; });
  }
  add("best of all families", [](const Optimum& o) { return o.best_family(); });
  double largest = 1.0;
  for (const Series& series : panel.series) {
    for (const double ratio : series.x) largest = std::max(largest, ratio);
  }
  panel.x.max = 1.04 * largest;
  panel.x.log = largest > 10.0;
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
        p.x.min = std::min(p.x.min.value_or(1e300), 0.9 * series.x.back());
        p.x.max = std::max(p.x.max.value_or(0.0), 1.1 * series.x.back());
        p.y.min = std::min(p.y.min.value_or(1e300), decade(series.y.back(), false));
        p.y.max = std::max(p.y.max.value_or(0.0), decade(series.y.back(), true));
      }
      p.series.push_back(std::move(series));
    };
    (add(value), ...);
    figure.panels.push_back(std::move(p));
  };
  const auto named = [](const char* name, auto f) { return std::pair<std::string, decltype(f)>(name, f); };
  panel("time / ms", named("design", [](const Optimum& o) { return 1e3 * o.design.solver.wall_time; }),
        named("recheck", [](const Optimum& o) { return 1e3 * o.check_time; }));
  panel("number",
        named("linear programmes", [](const Optimum& o) { return static_cast<double>(o.design.solver.evaluations); }));
  panel("size / kB",
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
  const std::vector<Cells> lines = shown(optima);
  TextTable table(lines[0]);
  table.left(1);
  for (std::size_t i = 1; i < lines.size(); ++i) table.add(lines[i]);
  return table.str();
}

}  // namespace accdec
