#include <algorithm>
#include <map>
#include <stdexcept>

#include <accdec/design/quadratic_problem.hpp>

namespace accdec {
namespace {

std::size_t nth(int i) {
  return static_cast<std::size_t>(i);
}

void merge(Affine& a) {
  std::sort(a.terms.begin(), a.terms.end());
  std::size_t kept = 0;
  for (std::size_t i = 0; i < a.terms.size(); ++i) {
    if (kept > 0 && a.terms[kept - 1].first == a.terms[i].first) {
      a.terms[kept - 1].second += a.terms[i].second;
    } else {
      a.terms[kept++] = a.terms[i];
    }
  }
  a.terms.resize(kept);
}

}  // namespace

Affine& Affine::add(int index, double coefficient) {
  terms.emplace_back(index, coefficient);
  return *this;
}

Affine& Affine::operator+=(const Affine& other) {
  constant += other.constant;
  terms.insert(terms.end(), other.terms.begin(), other.terms.end());
  return *this;
}

Affine& Affine::operator*=(double factor) {
  constant *= factor;
  for (auto& [index, coefficient] : terms) coefficient *= factor;
  return *this;
}

double Affine::operator()(std::span<const double> x) const {
  double sum = constant;
  for (const auto& [index, coefficient] : terms) sum += coefficient * x[nth(index)];
  return sum;
}

Affine operator*(double factor, Affine a) {
  return a *= factor;
}
Affine operator+(Affine a, const Affine& b) {
  return a += b;
}

int QuadraticProblem::add_variable(std::string name, nlp::Bound bound) {
  variables_.push_back({std::move(name), bound, false});
  return num_variables() - 1;
}

int QuadraticProblem::add_row(std::string name, nlp::Bound bound) {
  go_on();
  Row row;
  row.name = std::move(name);
  row.bound = bound;
  rows_.push_back(std::move(row));
  return num_rows() - 1;
}

void QuadraticProblem::add_to_row(int row, const Affine& a) {
  rows_[nth(row)].affine += a;
}

void QuadraticProblem::add_product(int row, double coefficient, Affine left, Affine right) {
  merge(left);
  merge(right);
  rows_[nth(row)].products.push_back({coefficient, std::move(left), std::move(right), {}, {}, {}});
}

Polynomial QuadraticProblem::polynomial(int row) const {
  const Row& r = rows_[nth(row)];
  Polynomial p;
  p.affine = r.affine;
  std::map<std::pair<int, int>, double> pairs;
  for (const Product& product : r.products) {
    const double c = product.coefficient;
    p.affine.constant += c * product.left.constant * product.right.constant;
    for (const auto& [i, l] : product.left.terms) {
      p.affine.add(i, c * l * product.right.constant);
      for (const auto& [j, t] : product.right.terms) pairs[std::minmax(i, j)] += c * l * t;
    }
    for (const auto& [j, t] : product.right.terms) p.affine.add(j, c * product.left.constant * t);
  }
  merge(p.affine);
  std::erase_if(p.affine.terms, [](const auto& term) { return term.second == 0.0; });
  for (const auto& [pair, c] : pairs) {
    if (c != 0.0) p.products.push_back({pair.first, pair.second, c});
  }
  return p;
}

void QuadraticProblem::finish() {
  merge(objective_);
  jacobian_pattern_.clear();
  std::vector<int> slot_of(nth(num_variables()), -1);  // valid for the row in hand
  for (int r = 0; r < num_rows(); ++r) {
    go_on();
    Row& row = rows_[nth(r)];
    merge(row.affine);
    std::vector<int> touched;
    const auto slot = [&](int variable) {
      if (slot_of[nth(variable)] < 0) {
        slot_of[nth(variable)] = static_cast<int>(jacobian_pattern_.size());
        jacobian_pattern_.push_back({r, variable});
        touched.push_back(variable);
      }
      return slot_of[nth(variable)];
    };
    for (const auto& term : row.affine.terms) row.slots.push_back(slot(term.first));
    for (Product& p : row.products) {
      for (const auto& term : p.left.terms) p.left_slots.push_back(slot(term.first));
      for (const auto& term : p.right.terms) p.right_slots.push_back(slot(term.first));
    }
    for (auto& [variable, where] : row.extra) where = slot(variable);
    for (const int variable : touched) slot_of[nth(variable)] = -1;
  }
  if (!with_hessian_) return;
  std::vector<std::pair<int, int>> entries = reserved_hessian_;
  const auto ordered = [](int i, int j) { return std::pair(std::max(i, j), std::min(i, j)); };
  for (const Row& row : rows_) {
    go_on();
    for (const Product& p : row.products) {
      for (const auto& l : p.left.terms) {
        for (const auto& t : p.right.terms) entries.push_back(ordered(l.first, t.first));
      }
    }
  }
  std::sort(entries.begin(), entries.end());
  entries.erase(std::unique(entries.begin(), entries.end()), entries.end());
  hessian_pattern_.clear();
  hessian_pattern_.reserve(entries.size());
  for (const auto& [i, j] : entries) hessian_pattern_.push_back({i, j});
  for (Row& row : rows_) {
    go_on();
    for (Product& p : row.products) {
      for (const auto& l : p.left.terms) {
        for (const auto& t : p.right.terms) p.hessian_slots.push_back(hessian_slot(l.first, t.first));
      }
    }
  }
}

int QuadraticProblem::hessian_slot(int i, int j) const {
  const std::pair key(std::max(i, j), std::min(i, j));
  const auto found =
      std::lower_bound(hessian_pattern_.begin(), hessian_pattern_.end(), key,
                       [](const nlp::Entry& e, const auto& k) { return std::pair(e.row, e.column) < k; });
  if (found == hessian_pattern_.end() || found->row != key.first || found->column != key.second) {
    throw std::logic_error("Hessian entry was not reserved");
  }
  return static_cast<int>(found - hessian_pattern_.begin());
}

nlp::ProblemClass QuadraticProblem::problem_class() const {
  for (const Row& row : rows_) {
    if (!row.products.empty() || !row.extra.empty()) return nlp::ProblemClass::general;
  }
  return nlp::ProblemClass::linear;
}

void QuadraticProblem::gradient(std::span<const double> /*x*/, std::span<double> g) const {
  std::fill(g.begin(), g.end(), 0.0);
  for (const auto& [index, coefficient] : objective_.terms) g[nth(index)] = coefficient;
}

void QuadraticProblem::rows(std::span<const double> x, std::span<double> c) const {
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    double value = rows_[r].affine(x);
    for (const Product& p : rows_[r].products) value += p.coefficient * p.left(x) * p.right(x);
    c[r] = value;
  }
}

void QuadraticProblem::jacobian(std::span<const double> x, std::span<double> values) const {
  std::fill(values.begin(), values.end(), 0.0);
  for (const Row& row : rows_) {
    for (std::size_t i = 0; i < row.slots.size(); ++i) values[nth(row.slots[i])] += row.affine.terms[i].second;
    for (const Product& p : row.products) {
      const double left = p.coefficient * p.left(x), right = p.coefficient * p.right(x);
      for (std::size_t i = 0; i < p.left_slots.size(); ++i)
        values[nth(p.left_slots[i])] += right * p.left.terms[i].second;
      for (std::size_t i = 0; i < p.right_slots.size(); ++i)
        values[nth(p.right_slots[i])] += left * p.right.terms[i].second;
    }
  }
}

void QuadraticProblem::hessian(std::span<const double> /*x*/, double /*objective_factor*/,
                               std::span<const double> multipliers, std::span<double> values) const {
  std::fill(values.begin(), values.end(), 0.0);
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    for (const Product& p : rows_[r].products) {
      const double factor = multipliers[r] * p.coefficient;
      std::size_t slot = 0;
      for (const auto& [i, l] : p.left.terms) {
        for (const auto& [j, t] : p.right.terms) {
          // d2(lr)/dxi dxj = l_i r_j + l_j r_i; the lower triangle holds each off-diagonal pair once.
          values[nth(p.hessian_slots[slot++])] += factor * l * t * (i == j ? 2.0 : 1.0);
        }
      }
    }
  }
}

}  // namespace accdec
