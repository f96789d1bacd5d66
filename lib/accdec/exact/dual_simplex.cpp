#include <algorithm>
#include <cmath>

#include <accdec/exact/dual_simplex.hpp>
#include <accdec/exact/tableau_loops.hpp>

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
      slot_(at(columns)),
      value_(at(columns), 0.0),
      at_(at(columns), lower),
      dual_(stride_, 0.0),
      is_row_(stride_, 0.0),
      expressed_(stride_, 0.0),
      pivot_row_(stride_, 0.0),
      point_(at(columns), 0.0) {
  for (int j = 0; j < columns; ++j) nonbasic_[at(j)] = j, slot_[at(j)] = -1 - j;
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

void DualSimplex::set_row(int row, std::span<const int> columns, std::span<const double> values) {
  Row& r = rows_[at(row)];
  r.columns.assign(columns.begin(), columns.end());
  r.values.assign(values.begin(), values.end());
  r.is_short = columns.size() <= most_short;
  if (!r.is_short) return;
  ShortRow& s = short_rows_[at(row)];
  std::ranges::copy(columns, s.columns.begin());
  std::ranges::copy(values, s.values.begin());
  s.size = columns.size();
}

/// Whether the variable has a row of the tableau while it is basic.
bool DualSimplex::is_stored(int variable) const {
  return variable < columns_ || !rows_[at(variable - columns_)].is_short;
}

void DualSimplex::add_row(std::span<const int> columns, std::span<const double> values, double low, double high) {
  rows_.emplace_back();
  short_rows_.emplace_back();
  set_row(rows() - 1, columns, values);
  low_.push_back(low);
  high_.push_back(high);
  value_.push_back(0.0);
  at_.push_back(lower);
  slot_.push_back(unstored);
  make_basic(rows() - 1);
}

int DualSimplex::append_tableau_row(int basic) {
  basic_.push_back(basic);
  tableau_.resize(basic_.size() * stride_);
  return slot_[at(basic)] = static_cast<int>(basic_.size()) - 1;
}

/// Makes the value of a row basic that has no place yet.
void DualSimplex::make_basic(int row) {
  slot_[at(columns_ + row)] = unstored;
  if (is_stored(columns_ + row)) express(row, tableau_row(append_tableau_row(columns_ + row)));
}

/// Writes a row's value in terms of the nonbasic variables.
void DualSimplex::express(int row, double* in_nonbasics) const {
  std::fill(in_nonbasics, in_nonbasics + stride_, 0.0);
  const Row& r = rows_[at(row)];
  for (std::size_t e = 0; e < r.columns.size(); ++e) {
    const double a = r.values[e];
    const int i = slot_[at(r.columns[e])];
    if (i < 0)
      in_nonbasics[-1 - i] += a;
    else
      add_multiple(in_nonbasics, tableau_row(i), a, stride_);
  }
}

/// A basic variable's row of the tableau, until the next change of it.
const double* DualSimplex::in_nonbasics(int basic) {
  const int i = slot_[at(basic)];
  if (i != unstored) return tableau_row(i);
  express(basic - columns_, expressed_.data());
  return expressed_.data();
}

/// Entry of a basic variable's row at the position of a nonbasic row.
double DualSimplex::entry(int basic, int position) const {
  const int i = slot_[at(basic)];
  if (i != unstored) return tableau_row(i)[position];
  const Row& r = rows_[at(basic - columns_)];
  double sum = 0.0;
  for (std::size_t e = 0; e < r.columns.size(); ++e) {
    if (const int from = slot_[at(r.columns[e])]; from >= 0) sum += r.values[e] * tableau_row(from)[position];
  }
  return sum;
}

/// Makes an active row basic in exchange for another variable, if possible one with a cost: the remaining row then
/// costs nothing.
bool DualSimplex::free_row(int row) {
  const int position = -1 - slot_[at(columns_ + row)];
  int best = -1, costly = -1;
  double largest = 0.0, costly_largest = 0.0;
  for (int v = 0; v < static_cast<int>(slot_.size()); ++v) {
    if (slot_[at(v)] < 0) continue;
    const double size = std::abs(entry(v, position));
    if (size > largest) largest = size, best = v;
    if (v < columns_ && cost_[at(v)] != 0.0 && size > costly_largest) costly_largest = size, costly = v;
  }
  if (costly >= 0 && costly_largest > 1e-3 * largest) best = costly;
  if (best < 0 || largest < singular) return false;
  exchange(best, in_nonbasics(best), position);
  return true;
}

void DualSimplex::drop_tableau_row(int i) {
  const int last = static_cast<int>(basic_.size()) - 1;
  if (i != last) {
    std::copy_n(tableau_row(last), stride_, tableau_row(i));
    basic_[at(i)] = basic_[at(last)];
    slot_[at(basic_[at(i)])] = i;
  }
  basic_.pop_back();
  tableau_.resize(basic_.size() * stride_);
}

void DualSimplex::replace_row(int row, std::span<const int> columns, std::span<const double> values, double low,
                              double high) {
  set_row_bounds(row, low, high);
  const Row& old = rows_[at(row)];
  if (std::ranges::equal(old.columns, columns) && std::ranges::equal(old.values, values)) return;
  const int i = slot_[at(columns_ + row)];
  set_row(row, columns, values);
  if (i >= 0) {
    if (i != unstored) drop_tableau_row(i);
    return make_basic(row);
  }
  // The new row in terms of the old one and the other nonbasics, then solved for the old one, which goes.
  const int position = -1 - i;
  express(row, expressed_.data());
  double largest = 0.0;
  for (int j = 0; j < columns_; ++j) largest = std::max(largest, std::abs(expressed_[at(j)]));
  if (std::abs(expressed_[at(position)]) > 0.01 * largest)
    eliminate(expressed_.data(), position, -1);
  else if (!free_row(row))
    start_cold();
  else if (const int freed = slot_[at(columns_ + row)]; freed != unstored)
    express(row, tableau_row(freed));
}

void DualSimplex::remove_row(int row) {
  if (active(row) && !free_row(row)) start_cold();
  if (const int i = slot_[at(columns_ + row)]; i != unstored) drop_tableau_row(i);
  const int last = rows() - 1;
  if (row != last) {
    const auto from = at(columns_ + last), to = at(columns_ + row);
    std::swap(rows_[at(row)], rows_[at(last)]);
    short_rows_[at(row)] = short_rows_[at(last)];
    low_[to] = low_[from], high_[to] = high_[from], value_[to] = value_[from], at_[to] = at_[from];
    const int i = slot_[to] = slot_[from];
    if (i != unstored) (i < 0 ? nonbasic_[at(-1 - i)] : basic_[at(i)]) = columns_ + row;
  }
  rows_.pop_back();
  short_rows_.pop_back();
  low_.pop_back(), high_.pop_back(), value_.pop_back(), at_.pop_back(), slot_.pop_back();
}

void DualSimplex::start_cold() {
  for (int j = 0; j < columns_; ++j) {
    nonbasic_[at(j)] = j;
    slot_[at(j)] = -1 - j;
    is_row_[at(j)] = 0.0;
  }
  basic_.clear();
  tableau_.clear();
  for (int r = 0; r < rows(); ++r) make_basic(r);
}

/// Rebuilds the tableau from the rows as given, for the same basis or, if that is singular, one near it.
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
    const double* row = in_nonbasics(v);
    int best = -1;
    for (int j = 0; j < columns_; ++j) {
      const int c = nonbasic_[at(j)];
      if (c >= columns_ || wanted[at(c)] == 0) continue;
      if (best < 0 || std::abs(row[j]) > std::abs(row[best])) best = j;
    }
    if (best >= 0 && std::abs(row[best]) > singular) exchange(v, row, best);
  }
}

/// Solves a row for the nonbasic variable at a position, and puts that into all rows of the tableau but one.
void DualSimplex::eliminate(const double* row, int position, int but) {
  const double inverse = 1.0 / row[position];
  for (std::size_t j = 0; j < stride_; ++j) pivot_row_[j] = row[j] * -inverse;
  pivot_row_[at(position)] = inverse;
  add_multiples_of_row(tableau_.data(), basic_.size(), stride_, pivot_row_.data(), at(position), but);
  ++pivots_;
}

/// A basic variable, with its row, for the nonbasic one at a position.
void DualSimplex::exchange(int out, const double* row, int position) {
  int i = slot_[at(out)];
  eliminate(row, position, i);
  const int in = nonbasic_[at(position)];
  nonbasic_[at(position)] = out;
  slot_[at(out)] = -1 - position;
  is_row_[at(position)] = out >= columns_ ? 1.0 : 0.0;
  if (is_stored(in)) {
    if (i == unstored) i = append_tableau_row(in);
    std::ranges::copy(pivot_row_, tableau_row(i));
    basic_[at(i)] = in;
    slot_[at(in)] = i;
  } else {
    slot_[at(in)] = unstored;
    if (i != unstored) drop_tableau_row(i);
  }
}

}  // namespace accdec::exact
