#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/instances/cone_rows.hpp>
#include <accdec/instances/instance.hpp>

namespace accdec::instances {
namespace {

/// form(x) >= 0, or == 0.
struct Side {
  std::string name;
  Affine form;
};

/// An instance as a cone program: linear equations, linear inequalities, convex rows.
struct ConeProgram {
  std::vector<Side> equal, positive;
  std::vector<std::pair<std::string, ConvexRow>> cones;
};

void add_sides(const std::string& name, const Affine& body, nlp::Bound bound, ConeProgram& program) {
  if (bound.lower == bound.upper) {
    program.equal.push_back({name, body + Affine{-bound.lower, {}}});
    return;
  }
  if (std::isfinite(bound.lower)) program.positive.push_back({name, body + Affine{-bound.lower, {}}});
  if (std::isfinite(bound.upper)) program.positive.push_back({name, -1.0 * body + Affine{bound.upper, {}}});
}

ConeProgram cone_program(const Instance& instance) {
  ConeProgram program;
  for (std::size_t i = 0; i < instance.variables.size(); ++i)
    add_sides("bound of " + instance.variables[i].name, {0.0, {{static_cast<int>(i), 1.0}}},
              instance.variables[i].bound, program);
  for (const Instance::Row& row : instance.rows) {
    if (nonlinear(row))
      program.cones.emplace_back(row.name, convex_row(row));
    else
      add_sides(row.name, row.body.affine, row.bound, program);
  }
  return program;
}

std::map<int, double> merged(const Affine& form) {
  std::map<int, double> terms;
  for (const auto& [i, c] : form.terms) terms[i] += c;
  std::erase_if(terms, [](const auto& term) { return term.second == 0.0; });
  return terms;
}

/// Rows of a CBF file in the order in which they are added.
class CbfRows {
 public:
  void add(const std::string& name, const Affine& form, Text& text) {
    for (const auto& [i, c] : merged(form)) {
      ++entries_;
      fmt::format_to(std::back_inserter(a_), "{} {} {}\n", rows_, i, c);
    }
    if (form.constant != 0.0) {
      ++constants_;
      fmt::format_to(std::back_inserter(b_), "{} {}\n", rows_, form.constant);
    }
    ++rows_;
    text.rows.push_back(name);
  }
  void cone(const char* kind, std::size_t size) {
    if (size == 0) return;
    ++cones_;
    fmt::format_to(std::back_inserter(k_), "{} {}\n", kind, size);
  }
  std::string cones() const { return fmt::format("CON\n{} {}\n{}\n", rows_, cones_, k_); }
  std::string coefficients() const {
    return fmt::format("ACOORD\n{}\n{}\nBCOORD\n{}\n{}", entries_, a_, constants_, b_);
  }

 private:
  std::size_t rows_ = 0, cones_ = 0, entries_ = 0, constants_ = 0;
  std::string a_, b_, k_;
};

std::vector<std::size_t> binaries(const Instance& instance) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < instance.variables.size(); ++i) {
    if (instance.variables[i].binary) found.push_back(i);
  }
  return found;
}

void name_columns(const Instance& instance, Text& text) {
  for (std::size_t i = 0; i < instance.variables.size(); ++i) {
    text.columns.push_back(instance.variables[i].name);
    text.variables.push_back(static_cast<int>(i));
  }
}

/// Solves every equation for its last variable with coefficient 1 or -1, so that nothing is divided.
class Elimination {
 public:
  explicit Elimination(const std::vector<Side>& equations) {
    for (const Side& equation : equations) {
      const Affine form = reduced(equation.form);
      const auto terms = merged(form);
      const auto last =
          std::find_if(terms.rbegin(), terms.rend(), [](const auto& t) { return std::abs(t.second) == 1.0; });
      if (last == terms.rend()) {
        if (terms.empty() && std::abs(form.constant) < 1e-12) continue;
        throw std::invalid_argument(
            fmt::format("row \"{}\" cannot be solved for a variable without rounding", equation.name));
      }
      Affine value{-last->second * form.constant, {}};
      for (const auto& [i, c] : terms) {
        if (i != last->first) value.add(i, -last->second * c);
      }
      const int solved = last->first;
      for (auto& [i, other] : values_) other = replaced(other, solved, value);
      values_.emplace(solved, std::move(value));
    }
  }
  bool has(int variable) const { return values_.count(variable) > 0; }
  /// Every solved variable, as a form in those that are left.
  const std::map<int, Affine>& values() const { return values_; }
  Affine reduced(const Affine& form) const {
    Affine sum{form.constant, {}};
    for (const auto& [i, c] : form.terms) {
      const auto found = values_.find(i);
      sum += found == values_.end() ? Affine{0.0, {{i, c}}} : c * found->second;
    }
    return sum;
  }

 private:
  static Affine replaced(const Affine& form, int variable, const Affine& value) {
    Affine sum{form.constant, {}};
    for (const auto& [i, c] : form.terms) sum += i == variable ? c * value : Affine{0.0, {{i, c}}};
    return sum;
  }
  std::map<int, Affine> values_;
};

/// Entries of F_0, F_1, .. in SDPA's order of matrices; F_0 has the opposite sign.
class SdpaEntries {
 public:
  explicit SdpaEntries(std::vector<int> numbers) : numbers_(std::move(numbers)), matrices_(numbers_.size() + 1) {}
  void add(int block, int i, int j, const Affine& form) {
    if (form.constant != 0.0) line(0, block, i, j, -form.constant);
    for (const auto& [variable, c] : merged(form))
      line(static_cast<std::size_t>(numbers_[static_cast<std::size_t>(variable)]), block, i, j, c);
  }
  std::string text() const {
    std::string all;
    for (const std::string& m : matrices_) all += m;
    return all;
  }

 private:
  void line(std::size_t matrix, int block, int i, int j, double value) {
    fmt::format_to(std::back_inserter(matrices_[matrix]), "{} {} {} {} {}\n", matrix, block, i, j, value);
  }
  std::vector<int> numbers_;
  std::vector<std::string> matrices_;
};

}  // namespace

Text cbf_text(const Instance& instance) {
  const ConeProgram program = cone_program(instance);
  Text text;
  name_columns(instance, text);
  CbfRows rows;
  for (const Side& side : program.equal) rows.add(side.name, side.form, text);
  for (const Side& side : program.positive) rows.add(side.name, side.form, text);
  rows.cone("L=", program.equal.size());
  rows.cone("L+", program.positive.size());
  for (const auto& [name, cone] : program.cones) {
    // 2 * slack * 1/2 >= sum of squares
    rows.add(name, cone.slack, text);
    rows.add(name + ", one half", {0.5, {}}, text);
    for (const Affine& part : cone.parts) rows.add(name + ", part", part, text);
    rows.cone("QR", cone.parts.size() + 2);
  }
  std::string& out = text.content;
  out = fmt::format("VER\n1\n\nOBJSENSE\nMIN\n\nVAR\n{} 1\nF {}\n\n", instance.variables.size(),
                    instance.variables.size());
  const std::vector<std::size_t> integer = binaries(instance);
  if (!integer.empty()) out += fmt::format("INT\n{}\n{}\n\n", integer.size(), fmt::join(integer, "\n"));
  out += rows.cones();
  const auto costs = merged(instance.objective);
  out += fmt::format("OBJACOORD\n{}\n", costs.size());
  for (const auto& [i, c] : costs) out += fmt::format("{} {}\n", i, c);
  out += '\n';
  if (instance.objective.constant != 0.0) out += fmt::format("OBJBCOORD\n{}\n\n", instance.objective.constant);
  out += rows.coefficients();
  text.kind = integer.empty() ? "second-order cone program" : "mixed-integer second-order cone program (big-M)";
  return text;
}

Text dat_s_text(const Instance& instance) {
  if (!binaries(instance).empty()) throw std::invalid_argument("the format has no integer variables");
  const ConeProgram program = cone_program(instance);
  const Elimination elimination(program.equal);
  Text text;
  std::vector<int> numbers(instance.variables.size(), 0);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (elimination.has(static_cast<int>(i))) continue;
    text.columns.push_back(instance.variables[i].name);
    text.variables.push_back(static_cast<int>(i));
    numbers[i] = static_cast<int>(text.columns.size());
  }
  text.solved.assign(elimination.values().begin(), elimination.values().end());
  SdpaEntries entries(numbers);
  std::string sizes;
  int block = 0;
  for (const auto& [name, cone] : program.cones) {
    const int n = static_cast<int>(cone.parts.size());
    ++block;
    entries.add(block, 1, 1, elimination.reduced(cone.slack));
    for (int p = 0; p < n; ++p) {
      entries.add(block, 1, p + 2, elimination.reduced(cone.parts[static_cast<std::size_t>(p)]));
      entries.add(block, p + 2, p + 2, {1.0, {}});
    }
    sizes += fmt::format("{} ", n + 1);
    text.rows.push_back(name);
  }
  ++block;
  int row = 0;
  for (const Side& side : program.positive) {
    const Affine form = elimination.reduced(side.form);
    if (merged(form).empty() && form.constant >= 0.0) continue;
    ++row;
    entries.add(block, row, row, form);
    text.rows.push_back(side.name);
  }
  const Affine objective = elimination.reduced(instance.objective);
  const auto costs = merged(objective);
  std::string c;
  for (const int i : text.variables) c += fmt::format("{} ", costs.count(i) > 0 ? costs.at(i) : 0.0);
  text.content = fmt::format("\"minimise c'x with sum F_i x_i - F_0 positive semidefinite\n{}\n{}\n{}-{}\n{}\n{}",
                             text.columns.size(), block, sizes, row, c, entries.text());
  text.kind = "semidefinite program";
  if (objective.constant != 0.0) text.relation = fmt::format("the same problem; {} is to be added", objective.constant);
  return text;
}

}  // namespace accdec::instances
