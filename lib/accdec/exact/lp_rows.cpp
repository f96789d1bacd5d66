#include <algorithm>
#include <cmath>

#include <accdec/exact/lp_rows.hpp>

namespace accdec::exact {
namespace {

std::size_t place(int i) {
  return static_cast<std::size_t>(i);
}

}  // namespace

LpRows::LpRows(int columns)
    : columns_(columns), cost_(place(columns), 0.0), low_(place(columns), 0.0), high_(place(columns), infinity) {}

void LpRows::set_bounds(int variable, double low, double high) {
  low_[place(variable)] = low, high_[place(variable)] = high;
}

void LpRows::set_row(int row, std::span<const int> columns, std::span<const double> values) {
  Row& r = rows_[place(row)];
  r.columns.assign(columns.begin(), columns.end());
  r.values.assign(values.begin(), values.end());
  if (!is_short(row)) return;
  ShortRow& s = short_rows_[place(row)];
  std::ranges::copy(columns, s.columns.begin());
  std::ranges::copy(values, s.values.begin());
  s.size = columns.size();
}

void LpRows::add_row(std::span<const int> columns, std::span<const double> values, double low, double high) {
  rows_.emplace_back();
  short_rows_.emplace_back();
  set_row(rows() - 1, columns, values);
  low_.push_back(low);
  high_.push_back(high);
}

bool LpRows::replace_row(int row, std::span<const int> columns, std::span<const double> values) {
  if (std::ranges::equal(row_columns(row), columns) && std::ranges::equal(row_values(row), values)) return false;
  set_row(row, columns, values);
  return true;
}

void LpRows::remove_row(int row) {
  const int last = rows() - 1;
  if (row != last) {
    std::swap(rows_[place(row)], rows_[place(last)]);
    short_rows_[place(row)] = short_rows_[place(last)];
    set_bounds(columns_ + row, low(columns_ + last), high(columns_ + last));
  }
  rows_.pop_back();
  short_rows_.pop_back();
  low_.pop_back(), high_.pop_back();
}

double LpRows::activity(int row, std::span<const double> x) const {
  double sum = 0.0;
  const Row& r = rows_[place(row)];
  for (std::size_t e = 0; e < r.columns.size(); ++e) sum += r.values[e] * x[place(r.columns[e])];
  return sum;
}

double LpRows::least_activity(int variable, double far) const {
  double sum = 0.0;
  if (variable < columns_) return std::min(high(variable), 0.0) - far;
  const Row& row = rows_[place(variable - columns_)];
  for (std::size_t e = 0; e < row.columns.size(); ++e) {
    const double a = row.values[e], side = a > 0.0 ? low(row.columns[e]) : high(row.columns[e]);
    if (a != 0.0) sum += a * side;
  }
  return std::max(sum, std::min(high(variable), 0.0) - far) - 1.0;
}

double LpRows::most_activity(int variable, double far) const {
  double sum = 0.0;
  if (variable < columns_) return std::max(low(variable), 0.0) + far;
  const Row& row = rows_[place(variable - columns_)];
  for (std::size_t e = 0; e < row.columns.size(); ++e) {
    const double a = row.values[e], side = a > 0.0 ? high(row.columns[e]) : low(row.columns[e]);
    if (a != 0.0) sum += a * side;
  }
  return std::min(sum, std::max(low(variable), 0.0) + far) + 1.0;
}

bool LpRows::refutes(std::vector<double>& ray) const {
  std::vector<double> sum(place(columns_), 0.0);
  double sides = 0.0, magnitude = 1.0;
  for (int r = 0; r < rows(); ++r) {
    double& y = ray[place(r)];
    if (std::abs(y) < 1e-13) y = 0.0;
    if (y == 0.0) continue;
    const double side = y > 0.0 ? low(columns_ + r) : high(columns_ + r);
    if (std::isinf(side)) {
      // The columns' bounds imply as much without this row.
      y = 0.0;
      continue;
    }
    sides += y * side;
    magnitude += std::abs(y * side);
    const Row& from = rows_[place(r)];
    for (std::size_t e = 0; e < from.columns.size(); ++e) sum[place(from.columns[e])] += y * from.values[e];
  }
  double most = 0.0;
  for (int j = 0; j < columns_; ++j) {
    if (std::abs(sum[place(j)]) < 1e-12) continue;
    const double side = sum[place(j)] > 0.0 ? high(j) : low(j);
    if (std::isinf(side)) return false;
    most += sum[place(j)] * side;
  }
  return most < sides - 1e-14 * magnitude;
}

}  // namespace accdec::exact
