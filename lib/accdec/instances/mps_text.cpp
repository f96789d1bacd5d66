#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/instances/cone_rows.hpp>
#include <accdec/instances/instance.hpp>

namespace accdec::instances {
namespace {

struct LinearRow {
  std::string name;
  nlp::Bound bound;
  Affine body;
};

/// A linear program whose feasible set contains that of the instance.
struct Outer {
  std::vector<LinearRow> rows;
  std::vector<Instance::Variable> variables;
  Affine objective;
  std::optional<int> root;  ///< variable that stands for the root of the instance's
  bool exact = true;
};

/// The one variable of the objective, if it bounds squares: then its root makes every bound a cone.
std::optional<int> root_of_objective(const Instance& instance) {
  if (instance.objective.terms.size() != 1) return std::nullopt;
  const int variable = instance.objective.terms.front().first;
  bool found = false;
  for (const Instance::Row& row : instance.rows) {
    const auto& terms = row.body.affine.terms;
    const bool in = std::any_of(terms.begin(), terms.end(), [&](const auto& t) { return t.first == variable; });
    if (!in) continue;
    // squares - variable <= 0
    if (!nonlinear(row) || terms.size() != 1 || terms.front().second != -1.0 || row.body.affine.constant != 0.0 ||
        row.bound.upper != 0.0)
      return std::nullopt;
    found = true;
  }
  return found ? std::optional(variable) : std::nullopt;
}

/// Tangents to |parts| <= radius, where the radius is a number or a variable.
void add_tangents(const Instance::Row& row, int tangents, Outer& outer) {
  const ConvexRow convex = convex_row(row);
  Affine radius;
  if (convex.slack.terms.empty()) {
    radius.constant = std::sqrt(std::max(0.0, convex.slack.constant));
  } else if (outer.root && convex.slack.terms.size() == 1 && convex.slack.terms.front().first == *outer.root) {
    radius.add(*outer.root, 1.0);
  } else {
    throw std::invalid_argument(fmt::format("row \"{}\" bounds squares by more than a number", row.name));
  }
  if (convex.parts.size() > 2)
    throw std::invalid_argument(fmt::format("row \"{}\" has more than two squares", row.name));
  const bool line = convex.parts.size() == 1;
  const int directions = line ? 2 : tangents;
  outer.exact = outer.exact && line;
  for (int m = 0; m < directions; ++m) {
    const double angle = 2.0 * std::numbers::pi * m / directions;
    Affine body = line ? (m == 0 ? 1.0 : -1.0) * convex.parts[0]
                       : std::cos(angle) * convex.parts[0] + std::sin(angle) * convex.parts[1];
    body += -1.0 * Affine{0.0, radius.terms};
    outer.rows.push_back({fmt::format("{}, tangent {}", row.name, m), {-nlp::infinity, radius.constant}, body});
  }
}

Outer outer_approximation(const Instance& instance, int tangents) {
  Outer outer;
  outer.variables = instance.variables;
  outer.objective = instance.objective;
  if (instance.objective.constant != 0.0) {
    // Readers disagree on the sign of a constant in the objective, so a fixed variable carries it.
    outer.variables.push_back({"one", {1.0, 1.0}, 1.0});
    outer.objective.add(static_cast<int>(instance.variables.size()), instance.objective.constant);
  }
  outer.root = root_of_objective(instance);
  if (outer.root) {
    Instance::Variable& v = outer.variables[static_cast<std::size_t>(*outer.root)];
    v.name = "root of " + v.name;
    v.bound.upper = std::sqrt(v.bound.upper);
  }
  for (const Instance::Row& row : instance.rows) {
    if (nonlinear(row)) {
      add_tangents(row, tangents, outer);
      continue;
    }
    const double constant = row.body.affine.constant;
    outer.rows.push_back(
        {row.name, {row.bound.lower - constant, row.bound.upper - constant}, Affine{0.0, row.body.affine.terms}});
  }
  return outer;
}

/// Sums coefficients of equal variables, by column: (row, coefficient).
std::vector<std::vector<std::pair<std::size_t, double>>> by_column(const Outer& outer) {
  std::vector<std::vector<std::pair<std::size_t, double>>> columns(outer.variables.size());
  for (std::size_t r = 0; r < outer.rows.size(); ++r) {
    for (const auto& [i, c] : outer.rows[r].body.terms) {
      auto& column = columns[static_cast<std::size_t>(i)];
      if (!column.empty() && column.back().first == r)
        column.back().second += c;
      else
        column.emplace_back(r, c);
    }
  }
  return columns;
}

void write_bounds(const Outer& outer, std::string& text) {
  const auto out = std::back_inserter(text);
  text += "BOUNDS\n";
  for (std::size_t i = 0; i < outer.variables.size(); ++i) {
    const nlp::Bound b = outer.variables[i].bound;
    if (b.lower == b.upper) {
      fmt::format_to(out, " FX BND X{} {}\n", i + 1, b.lower);
      continue;
    }
    if (!std::isfinite(b.lower) && !std::isfinite(b.upper)) fmt::format_to(out, " FR BND X{}\n", i + 1);
    if (!std::isfinite(b.lower) && std::isfinite(b.upper)) fmt::format_to(out, " MI BND X{}\n", i + 1);
    if (std::isfinite(b.lower)) fmt::format_to(out, " LO BND X{} {}\n", i + 1, b.lower);
    if (std::isfinite(b.upper)) fmt::format_to(out, " UP BND X{} {}\n", i + 1, b.upper);
  }
}

void write_rows(const Outer& outer, std::string& text) {
  const auto out = std::back_inserter(text);
  text += "ROWS\n N COST\n";
  for (std::size_t r = 0; r < outer.rows.size(); ++r) {
    const nlp::Bound b = outer.rows[r].bound;
    const char kind = b.lower == b.upper ? 'E' : std::isfinite(b.upper) ? 'L' : 'G';
    fmt::format_to(out, " {} R{}\n", kind, r + 1);
  }
}

void write_columns(const Outer& outer, std::string& text) {
  const auto out = std::back_inserter(text);
  text += "COLUMNS\n";
  const auto columns = by_column(outer);
  bool integer = false;
  const auto mark = [&](bool wanted) {
    if (wanted != integer)
      fmt::format_to(out, " MARK{} 'MARKER' '{}'\n", wanted ? "A" : "B", wanted ? "INTORG" : "INTEND");
    integer = wanted;
  };
  for (std::size_t i = 0; i < columns.size(); ++i) {
    mark(outer.variables[i].binary);
    double cost = 0.0;
    for (const auto& [j, c] : outer.objective.terms) cost += static_cast<std::size_t>(j) == i ? c : 0.0;
    if (cost != 0.0 || columns[i].empty()) fmt::format_to(out, " X{} COST {}\n", i + 1, cost);
    for (const auto& [r, c] : columns[i]) fmt::format_to(out, " X{} R{} {}\n", i + 1, r + 1, c);
  }
  mark(false);
}

/// Right sides, and the width of rows with two different sides.
void write_sides(const Outer& outer, std::string& text) {
  const auto out = std::back_inserter(text);
  text += "RHS\n";
  std::string ranges;
  for (std::size_t r = 0; r < outer.rows.size(); ++r) {
    const nlp::Bound b = outer.rows[r].bound;
    const bool low = std::isfinite(b.lower), high = std::isfinite(b.upper);
    const double side = high ? b.upper : b.lower;
    if (side != 0.0) fmt::format_to(out, " RHS R{} {}\n", r + 1, side);
    if (low && high && b.lower != b.upper)
      fmt::format_to(std::back_inserter(ranges), " RNG R{} {}\n", r + 1, b.upper - b.lower);
  }
  if (!ranges.empty()) text += "RANGES\n" + ranges;
}

std::string relation_of(const Outer& outer, int tangents) {
  std::string relation = outer.exact ? "the same feasible set"
                                     : fmt::format(
                                           "outer approximation: every cone has {} tangents, so its radius is at most "
                                           "1/cos(pi/{}) times too large; a lower bound",
                                           tangents, tangents);
  if (outer.root) relation += "; the optimum is the root of the problem's";
  return relation;
}

}  // namespace

Text mps_text(const Instance& instance, int tangents) {
  const Outer outer = outer_approximation(instance, tangents);
  Text text;
  bool integer = false;
  text.content = "NAME accdec FREE\n";
  write_rows(outer, text.content);
  write_columns(outer, text.content);
  write_sides(outer, text.content);
  write_bounds(outer, text.content);
  text.content += "ENDATA\n";
  for (std::size_t i = 0; i < outer.variables.size(); ++i) {
    text.columns.push_back(outer.variables[i].name);
    text.variables.push_back(static_cast<int>(i));
    integer = integer || outer.variables[i].binary;
  }
  for (const LinearRow& row : outer.rows) text.rows.push_back(row.name);
  text.kind = integer ? "mixed-integer linear program (big-M)" : "linear program";
  text.relation = relation_of(outer, tangents);
  return text;
}

}  // namespace accdec::instances
