#include <algorithm>
#include <cmath>

#include <accdec/exact/dual_simplex.hpp>

namespace accdec::exact {
namespace {

/// A pivot of a refactorisation below this says that the basis is singular.
constexpr double singular = 1e-9;

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

}  // namespace

DualSimplex::DualSimplex(int columns)
    : columns_(columns),
      stride_((at(columns) + 3) / 4 * 4),
      cost_(at(columns), 0.0),
      low_(at(columns), 0.0),
      high_(at(columns), infinity),
      nonbasic_(at(columns)),
      basic_row_(at(columns)),
      value_(at(columns), 0.0),
      at_(at(columns), lower),
      dual_(stride_, 0.0),
      is_row_(stride_, 0.0),
      point_(at(columns), 0.0) {
  for (int j = 0; j < columns; ++j) nonbasic_[at(j)] = j, basic_row_[at(j)] = -1 - j;
}

void DualSimplex::set_cost(int column, double cost) {
  cost_[at(column)] = cost;
}
void DualSimplex::set_column_bounds(int column, double low, double high) {
  low_[at(column)] = low, high_[at(column)] = high;
}
void DualSimplex::set_row_bounds(int row, double low, double high) {
  low_[at(columns_ + row)] = low, high_[at(columns_ + row)] = high;
}

double DualSimplex::activity(int row, const std::vector<double>& x) const {
  double sum = 0.0;
  const Row& r = rows_[at(row)];
  for (std::size_t e = 0; e < r.columns.size(); ++e) sum += r.values[e] * x[at(r.columns[e])];
  return sum;
}

void DualSimplex::add_row(std::span<const int> columns, std::span<const double> values, double low, double high) {
  rows_.push_back({{columns.begin(), columns.end()}, {values.begin(), values.end()}});
  low_.push_back(low);
  high_.push_back(high);
  value_.push_back(0.0);
  at_.push_back(lower);
  basic_row_.push_back(static_cast<int>(basic_.size()));
  basic_.push_back(columns_ + rows() - 1);
  tableau_.resize(basic_.size() * stride_, 0.0);
  express(rows() - 1, tableau_row(static_cast<int>(basic_.size()) - 1));
}

void DualSimplex::express(int row, double* in_nonbasics) const {
  std::fill(in_nonbasics, in_nonbasics + stride_, 0.0);
  const Row& r = rows_[at(row)];
  for (std::size_t e = 0; e < r.columns.size(); ++e) {
    const double a = r.values[e];
    const int i = basic_row_[at(r.columns[e])];
    if (i < 0) {
      in_nonbasics[-1 - i] += a;
      continue;
    }
    const double* from = tableau_row(i);
    for (std::size_t j = 0; j < stride_; ++j) in_nonbasics[j] += a * from[j];
  }
}

/// An active row becomes basic in exchange for another variable, if possible for one that costs: what is left then
/// costs nothing.
bool DualSimplex::free_row(int row) {
  const int position = -1 - basic_row_[at(columns_ + row)];
  int best = -1, costly = -1;
  double largest = 0.0, costly_largest = 0.0;
  for (int i = 0; i < static_cast<int>(basic_.size()); ++i) {
    const int v = basic_[at(i)];
    const double size = std::abs(tableau_row(i)[position]);
    if (size > largest) largest = size, best = i;
    if (v < columns_ && cost_[at(v)] != 0.0 && size > costly_largest) costly_largest = size, costly = i;
  }
  if (costly >= 0 && costly_largest > 1e-3 * largest) best = costly;
  if (best < 0 || std::abs(tableau_row(best)[position]) < singular) return false;
  exchange(best, position);
  return true;
}

void DualSimplex::drop_tableau_row(int i) {
  const int last = static_cast<int>(basic_.size()) - 1;
  if (i != last) {
    std::copy_n(tableau_row(last), stride_, tableau_row(i));
    basic_[at(i)] = basic_[at(last)];
    basic_row_[at(basic_[at(i)])] = i;
  }
  basic_.pop_back();
  tableau_.resize(basic_.size() * stride_);
}

void DualSimplex::replace_row(int row, std::span<const int> columns, std::span<const double> values, double low,
                              double high) {
  set_row_bounds(row, low, high);
  Row& r = rows_[at(row)];
  if (std::ranges::equal(r.columns, columns) && std::ranges::equal(r.values, values)) return;
  r.columns.assign(columns.begin(), columns.end());
  r.values.assign(values.begin(), values.end());
  const int v = columns_ + row, i = basic_row_[at(v)];
  if (i >= 0) return express(row, tableau_row(i));
  // The new row in terms of the old one and the other nonbasics, then solved for the old one, which goes.
  const int position = -1 - i, last = static_cast<int>(basic_.size());
  tableau_.resize((basic_.size() + 1) * stride_);
  basic_.push_back(v);
  express(row, tableau_row(last));
  const double* in_old = tableau_row(last);
  double largest = 0.0;
  for (int j = 0; j < columns_; ++j) largest = std::max(largest, std::abs(in_old[j]));
  const bool safe = std::abs(in_old[position]) > 0.01 * largest;
  if (safe) exchange(last, position);
  drop_tableau_row(last);
  if (safe) return;
  if (free_row(row))
    express(row, tableau_row(basic_row_[at(v)]));
  else
    start_cold();
}

void DualSimplex::remove_row(int row) {
  if (!active(row) || free_row(row)) {
    drop_tableau_row(basic_row_[at(columns_ + row)]);
  } else {
    start_cold();
    drop_tableau_row(row);
  }
  const int last = rows() - 1;
  if (row != last) {
    const auto from = at(columns_ + last), to = at(columns_ + row);
    std::swap(rows_[at(row)], rows_[at(last)]);
    low_[to] = low_[from], high_[to] = high_[from], value_[to] = value_[from], at_[to] = at_[from];
    basic_row_[to] = basic_row_[from];
    (basic_row_[to] < 0 ? nonbasic_[at(-1 - basic_row_[to])] : basic_[at(basic_row_[to])]) = columns_ + row;
  }
  rows_.pop_back();
  low_.pop_back(), high_.pop_back(), value_.pop_back(), at_.pop_back(), basic_row_.pop_back();
}

void DualSimplex::start_cold() {
  for (int j = 0; j < columns_; ++j) {
    nonbasic_[at(j)] = j;
    basic_row_[at(j)] = -1 - j;
    is_row_[at(j)] = 0.0;
  }
  for (int r = 0; r < rows(); ++r) {
    basic_[at(r)] = columns_ + r;
    basic_row_[at(columns_ + r)] = r;
    express(r, tableau_row(r));
  }
}

/// Sets the tableau up again from the rows as given, for the same basis or, where that is singular, one near it.
void DualSimplex::refactor() {
  std::vector<int> active_rows;
  std::vector<char> wanted(at(columns_), 0);
  for (const int v : nonbasic_) {
    if (v >= columns_) active_rows.push_back(v);
  }
  for (const int v : basic_) {
    if (v < columns_) wanted[at(v)] = 1;
  }
  start_cold();
  for (const int v : active_rows) {
    const int i = basic_row_[at(v)];
    const double* row = tableau_row(i);
    int best = -1;
    for (int j = 0; j < columns_; ++j) {
      const int c = nonbasic_[at(j)];
      if (c >= columns_ || wanted[at(c)] == 0) continue;
      if (best < 0 || std::abs(row[j]) > std::abs(row[best])) best = j;
    }
    if (best >= 0 && std::abs(row[best]) > singular) exchange(i, best);
  }
}

/// Solves row i for the nonbasic variable at a position, and puts that into the other rows.
void DualSimplex::exchange(int i, int position) {
  double* const pivot_row = tableau_row(i);
  const double inverse = 1.0 / pivot_row[position];
  for (std::size_t j = 0; j < stride_; ++j) pivot_row[j] *= -inverse;
  pivot_row[position] = inverse;
  const int count = static_cast<int>(basic_.size());
  for (int r = 0; r < count; ++r) {
    if (r == i) continue;
    double* const row = tableau_row(r);
    const double factor = row[position];
    if (factor == 0.0) continue;
    row[position] = 0.0;
    if (std::abs(factor) < 1e-14) continue;
    for (std::size_t j = 0; j < stride_; ++j) row[j] += factor * pivot_row[j];
  }
  const int in = nonbasic_[at(position)], out = basic_[at(i)];
  basic_[at(i)] = in;
  nonbasic_[at(position)] = out;
  basic_row_[at(in)] = i;
  basic_row_[at(out)] = -1 - position;
  is_row_[at(position)] = out >= columns_ ? 1.0 : 0.0;
  ++pivots_;
}

/// The point from its basis, refined once against the rows as given. False: it does not hold them.
bool DualSimplex::take_point() {
  constexpr double tolerance = 2.0 * primal_tolerance;
  std::copy_n(value_.begin(), columns_, point_.begin());
  for (int j = 0; j < columns_; ++j) {
    const int v = nonbasic_[at(j)];
    if (v < columns_) continue;
    const double residual = value_[at(v)] - activity(v - columns_, point_);
    if (std::abs(residual) < 1e-15) continue;
    if (std::abs(residual) > 1e-6) return false;
    scratch_.emplace_back(j, residual);
  }
  for (std::size_t i = 0; i < basic_.size() && !scratch_.empty(); ++i) {
    if (basic_[i] >= columns_) continue;
    const double* row = tableau_row(static_cast<int>(i));
    for (const auto& [j, residual] : scratch_) point_[at(basic_[i])] += row[j] * residual;
  }
  scratch_.clear();
  objective_ = 0.0;
  for (int j = 0; j < columns_; ++j) {
    if (point_[at(j)] < low_[at(j)] - tolerance || point_[at(j)] > high_[at(j)] + tolerance) return false;
    point_[at(j)] = std::clamp(point_[at(j)], low_[at(j)], high_[at(j)]);
    objective_ += cost_[at(j)] * point_[at(j)];
  }
  for (int r = 0; r < rows(); ++r) {
    const double value = activity(r, point_);
    const auto v = at(columns_ + r);
    if (value < low_[v] - tolerance || value > high_[v] + tolerance) return false;
    if (basic_row_[v] < 0 && std::abs(value - value_[v]) > tolerance * (1.0 + std::abs(value))) return false;
  }
  multipliers_.assign(at(rows()), 0.0);
  for (int j = 0; j < columns_; ++j) {
    if (nonbasic_[at(j)] >= columns_) multipliers_[at(nonbasic_[at(j)] - columns_)] = dual_[at(j)];
  }
  return true;
}

/// Row i of the tableau as a Farkas ray. False: it proves nothing against the rows as given.
bool DualSimplex::take_ray(int i, double sigma) {
  multipliers_.assign(at(rows()), 0.0);
  const double* row = tableau_row(i);
  if (basic_[at(i)] >= columns_) multipliers_[at(basic_[at(i)] - columns_)] = -sigma;
  for (int j = 0; j < columns_; ++j) {
    if (nonbasic_[at(j)] >= columns_) multipliers_[at(nonbasic_[at(j)] - columns_)] = sigma * row[j];
  }
  return refutes(multipliers_);
}

bool DualSimplex::refutes(std::vector<double>& ray) const {
  std::vector<double> sum(at(columns_), 0.0);
  double sides = 0.0, magnitude = 1.0;
  for (int r = 0; r < rows(); ++r) {
    double& y = ray[at(r)];
    if (std::abs(y) < 1e-13) y = 0.0;
    if (y == 0.0) continue;
    const double side = y > 0.0 ? low_[at(columns_ + r)] : high_[at(columns_ + r)];
    if (std::isinf(side)) {
      // Without it the columns' bounds say as much.
      y = 0.0;
      continue;
    }
    sides += y * side;
    magnitude += std::abs(y * side);
    const Row& from = rows_[at(r)];
    for (std::size_t e = 0; e < from.columns.size(); ++e) sum[at(from.columns[e])] += y * from.values[e];
  }
  double most = 0.0;
  for (int j = 0; j < columns_; ++j) {
    if (std::abs(sum[at(j)]) < 1e-12) continue;
    const double side = sum[at(j)] > 0.0 ? high_[at(j)] : low_[at(j)];
    if (std::isinf(side)) return false;
    most += sum[at(j)] * side;
  }
  return most < sides - 1e-14 * magnitude;
}

}  // namespace accdec::exact
