#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>

#include <fmt/format.h>

#include <accdec/instances/cone_rows.hpp>
#include <accdec/instances/instance.hpp>

namespace accdec::instances {
namespace {

using Out = std::back_insert_iterator<std::string>;

/// Writes one instance. The format wants nonlinear rows first. Among variables it wants the nonlinear ones first, and
/// binary ones behind continuous ones: D. M. Gay, Writing .nl Files, Sandia 2005.
class NlWriter {
 public:
  explicit NlWriter(const Instance& instance) : instance_(instance) {
    order_rows();
    order_variables();
  }

  Text write() {
    header();
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      fmt::format_to(out_, "C{}\n", r);
      body(row(r));
    }
    fmt::format_to(out_, "O0 0\nn{}\n", instance_.objective.constant);
    fmt::format_to(out_, "x{}\n", columns_.size());
    for (std::size_t i = 0; i < columns_.size(); ++i) fmt::format_to(out_, "{} {}\n", i, variable(i).start);
    out("r\n");
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      const double constant = row(r).body.affine.constant;
      bound({row(r).bound.lower - constant, row(r).bound.upper - constant});
    }
    out("b\n");
    for (std::size_t i = 0; i < columns_.size(); ++i) bound(variable(i).bound);
    jacobian();
    Text text;
    text.content = std::move(text_);
    text.variables = columns_;
    for (const int i : columns_) text.columns.push_back(instance_.variables[at(i)].name);
    for (const int r : rows_) text.rows.push_back(instance_.rows[at(r)].name);
    text.kind = kind();
    return text;
  }

 private:
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  const Instance::Row& row(std::size_t r) const { return instance_.rows[at(rows_[r])]; }
  const Instance::Variable& variable(std::size_t i) const { return instance_.variables[at(columns_[i])]; }
  void out(std::string_view s) { text_ += s; }

  void order_rows() {
    rows_.resize(instance_.rows.size());
    std::iota(rows_.begin(), rows_.end(), 0);
    const auto middle =
        std::stable_partition(rows_.begin(), rows_.end(), [&](int r) { return nonlinear(instance_.rows[at(r)]); });
    nonlinear_rows_ = static_cast<std::size_t>(middle - rows_.begin());
  }

  void order_variables() {
    std::vector<int> rank(instance_.variables.size(), 2);  // 0, 1: nonlinear; 2, 3: linear; odd: binary
    for (const Instance::Row& r : instance_.rows) {
      for (const auto& p : r.body.products) rank[at(p.first)] = rank[at(p.second)] = 0;
      for (const Approach& a : r.approaches) {
        for (int i = 0; i < instance_.order; ++i) rank[at(i)] = 0;
        rank[at(a.instant)] = 0;
        if (a.delay >= 0) rank[at(a.delay)] = 0;
      }
    }
    for (std::size_t i = 0; i < rank.size(); ++i) {
      if (instance_.variables[i].binary) ++rank[i];
      ++counts_[rank[i]];
    }
    columns_.resize(rank.size());
    std::iota(columns_.begin(), columns_.end(), 0);
    std::stable_sort(columns_.begin(), columns_.end(), [&](int a, int b) { return rank[at(a)] < rank[at(b)]; });
    column_of_.resize(rank.size());
    for (std::size_t i = 0; i < columns_.size(); ++i) column_of_[at(columns_[i])] = static_cast<int>(i);
  }

  /// Coefficients of the linear part of a row, with a zero where a variable appears only in the nonlinear part.
  std::map<int, double> linear(const Instance::Row& r) const {
    std::map<int, double> terms;
    for (const auto& p : r.body.products) terms[column_of_[at(p.first)]] = terms[column_of_[at(p.second)]] = 0.0;
    for (const Approach& a : r.approaches) {
      for (int i = 0; i < instance_.order; ++i) terms[column_of_[at(i)]] = 0.0;
      terms[column_of_[at(a.instant)]] = 0.0;
      if (a.delay >= 0) terms[column_of_[at(a.delay)]] = 0.0;
    }
    for (const auto& [i, c] : r.body.affine.terms) terms[column_of_[at(i)]] += c;
    return terms;
  }

  void header() {
    std::size_t ranges = 0, equal = 0, nonzeros = 0, longest_row = 0, longest_column = 0;
    for (const Instance::Row& r : instance_.rows) {
      const bool both = std::isfinite(r.bound.lower) && std::isfinite(r.bound.upper);
      if (both) ++(r.bound.lower == r.bound.upper ? equal : ranges);
      nonzeros += linear(r).size();
      longest_row = std::max(longest_row, r.name.size());
    }
    for (const Instance::Variable& v : instance_.variables) longest_column = std::max(longest_column, v.name.size());
    fmt::format_to(out_, "g3 0 1 0\n {} {} 1 {} {}\n {} 0\n 0 0\n {} 0 0\n 0 0 0 1\n {} 0 0 {} 0\n {} {}\n {} {}\n",
                   columns_.size(), rows_.size(), ranges, equal, nonlinear_rows_, counts_[0] + counts_[1], counts_[3],
                   counts_[1], nonzeros, instance_.objective.terms.size(), longest_row, longest_column);
    out(" 0 0 0 0 0\n");
  }

  /// The nonlinear part.
  void body(const Instance::Row& r) {
    std::size_t terms = r.body.products.size();
    for (std::size_t i = 0; i < r.approaches.size(); ++i) terms += at(instance_.order) + 2;
    if (terms == 0) return out("n0\n");
    sum(terms);
    for (const auto& p : r.body.products)
      fmt::format_to(out_, "o2\nn{}\no2\nv{}\nv{}\n", p.coefficient, column_of_[at(p.first)], column_of_[at(p.second)]);
    for (const Approach& a : r.approaches) approach(a);
  }

  void sum(std::size_t terms) {
    if (terms >= 3) fmt::format_to(out_, "o54\n{}\n", terms);
    if (terms == 2) out("o0\n");
  }

  /// Summed by parts, an approach is 1/2 sum_k w_k max(y_k, 0)^2 with y_k = t - d - k and w_k = b_k - b_{k-1} for Q.
  /// For p, y_k = k - t and w_k = b_{k-1} - b_k. Here k = 0 .. N + 1.
  void approach(const Approach& a) {
    const double sign = a.delay >= 0 ? 1.0 : -1.0;
    for (int k = 0; k <= instance_.order + 1; ++k) {
      std::vector<std::pair<double, int>> weight;  // coefficient, column; -1 for the constant
      const auto add = [&](double c, int j) {      // c B_j
        if (j > instance_.order) weight.emplace_back(c, -1);
        if (j >= 1 && j <= instance_.order) weight.emplace_back(c, column_of_[at(j - 1)]);
      };
      add(1.0, k + 1), add(-2.0, k), add(1.0, k - 1);
      fmt::format_to(out_, "o2\nn{}\no2\n", 0.5 * sign * a.scale);
      sum(weight.size());
      for (const auto& [c, column] : weight) {
        if (column < 0)
          fmt::format_to(out_, "n{}\n", c);
        else
          fmt::format_to(out_, "o2\nn{}\nv{}\n", c, column);
      }
      // max(y, 0)^2 = y (y + |y|) / 2
      std::string y = fmt::format("o0\nn{}\no2\nn{}\nv{}\n", -sign * k, sign, column_of_[at(a.instant)]);
      if (a.delay >= 0) y = fmt::format("o1\n{}v{}\n", y, column_of_[at(a.delay)]);
      fmt::format_to(out_, "o2\nn0.5\no2\n{}o0\n{}o15\n{}", y, y, y);
    }
  }

  void bound(nlp::Bound b) {
    const bool low = std::isfinite(b.lower), high = std::isfinite(b.upper);
    if (low && high && b.lower == b.upper)
      fmt::format_to(out_, "4 {}\n", b.lower);
    else if (low && high)
      fmt::format_to(out_, "0 {} {}\n", b.lower, b.upper);
    else if (high)
      fmt::format_to(out_, "1 {}\n", b.upper);
    else if (low)
      fmt::format_to(out_, "2 {}\n", b.lower);
    else
      out("3\n");
  }

  void jacobian() {
    std::vector<int> count(columns_.size(), 0);
    std::string rows;
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      const auto terms = linear(row(r));
      if (!terms.empty()) fmt::format_to(std::back_inserter(rows), "J{} {}\n", r, terms.size());
      for (const auto& [i, c] : terms) {
        ++count[at(i)];
        fmt::format_to(std::back_inserter(rows), "{} {}\n", i, c);
      }
    }
    fmt::format_to(out_, "k{}\n", columns_.size() - 1);
    int sum = 0;
    for (std::size_t i = 0; i + 1 < columns_.size(); ++i) fmt::format_to(out_, "{}\n", sum += count[i]);
    out(rows);
    std::map<int, double> gradient;
    for (const auto& [i, c] : instance_.objective.terms) gradient[column_of_[at(i)]] = c;
    // The readers of the ASL refuse an empty gradient.
    if (!gradient.empty()) fmt::format_to(out_, "G0 {}\n", gradient.size());
    for (const auto& [i, c] : gradient) fmt::format_to(out_, "{} {}\n", i, c);
  }

  std::string kind() const {
    const bool integer = counts_[1] + counts_[3] > 0, flat = nonlinear_rows_ == 0;
    bool quadratic = true;
    for (const Instance::Row& r : instance_.rows) quadratic = quadratic && r.approaches.empty();
    return fmt::format("{}{} program{}", integer ? "mixed-integer " : "",
                       flat        ? "linear"
                       : quadratic ? "quadratically constrained"
                                   : "nonlinear",
                       integer ? " (big-M)" : "");
  }

  const Instance& instance_;
  std::string text_;
  Out out_{text_};
  std::vector<int> rows_, columns_, column_of_;
  std::size_t nonlinear_rows_ = 0;
  std::array<std::size_t, 4> counts_{};
};

}  // namespace

Text nl_text(const Instance& instance) {
  return NlWriter(instance).write();
}

}  // namespace accdec::instances
