#include <algorithm>
#include <cmath>

#include <accdec/exact/tableau.hpp>
#include <accdec/exact/tableau_loops.hpp>

namespace accdec::exact {
namespace {

/// A pivot of a refactorisation below this says that the basis is singular.
constexpr double singular = 1e-9;

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

}  // namespace

Tableau::Tableau(int columns)
    : given_(columns),
      width_((at(columns) + 3) / 4 * 4),
      nonbasic_(at(columns)),
      slot_(at(columns)),
      is_row_(width_, 0.0),
      expressed_(width_, 0.0),
      pivot_row_(width_, 0.0) {
  for (int j = 0; j < columns; ++j) nonbasic_[at(j)] = j, slot_[at(j)] = -1 - j;
}

/// Whether the variable has a row of the tableau while it is basic.
bool Tableau::is_stored(int variable) const {
  return variable < given_.columns() || !given_.is_short(variable - given_.columns());
}

void Tableau::add_row(std::span<const int> columns, std::span<const double> values, double low, double high) {
  given_.add_row(columns, values, low, high);
  slot_.push_back(unstored);
  make_basic(given_.rows() - 1);
}

int Tableau::append(int basic) {
  basic_.push_back(basic);
  entries_.resize(basic_.size() * width_);
  return slot_[at(basic)] = static_cast<int>(basic_.size()) - 1;
}

/// Makes the value of a row basic that has no place yet.
void Tableau::make_basic(int row) {
  slot_[at(given_.columns() + row)] = unstored;
  if (is_stored(given_.columns() + row)) express(row, writable(append(given_.columns() + row)));
}

/// Writes a row's value in terms of the nonbasic variables.
void Tableau::express(int row, double* in_nonbasics) const {
  std::fill(in_nonbasics, in_nonbasics + width_, 0.0);
  const std::span<const int> columns = given_.row_columns(row);
  const std::span<const double> values = given_.row_values(row);
  for (std::size_t e = 0; e < columns.size(); ++e) {
    const double a = values[e];
    const int i = slot_[at(columns[e])];
    if (i < 0)
      in_nonbasics[-1 - i] += a;
    else
      add_multiple(in_nonbasics, entries(i), a, width_);
  }
}

const double* Tableau::in_nonbasics(int basic) {
  const int i = slot_[at(basic)];
  if (i != unstored) return entries(i);
  express(basic - given_.columns(), expressed_.data());
  return expressed_.data();
}

double Tableau::square_in_rows(int basic) {
  return sum_of_squares(is_row_.data(), in_nonbasics(basic), width_);
}

void Tableau::compute_unstored(std::vector<double>& value) const {
  const int* const slots = slot_.data() + given_.columns();
  double* const values = value.data() + given_.columns();
  for (int r = 0; r < given_.rows(); ++r) {
    if (slots[r] == unstored) values[r] = given_.short_activity(r, value.data());
  }
}

/// Entry of a basic variable's row at the position of a nonbasic row.
double Tableau::entry(int basic, int position) const {
  const int i = slot_[at(basic)];
  if (i != unstored) return entries(i)[position];
  const std::span<const int> columns = given_.row_columns(basic - given_.columns());
  const std::span<const double> values = given_.row_values(basic - given_.columns());
  double sum = 0.0;
  for (std::size_t e = 0; e < columns.size(); ++e) {
    if (const int from = slot_[at(columns[e])]; from >= 0) sum += values[e] * entries(from)[position];
  }
  return sum;
}

/// Makes an active row basic in exchange for another variable, if possible one with a cost: the remaining row then
/// costs nothing.
bool Tableau::free_row(int row) {
  const int position = -1 - slot_[at(given_.columns() + row)];
  int best = -1, costly = -1;
  double largest = 0.0, costly_largest = 0.0;
  for (int v = 0; v < static_cast<int>(slot_.size()); ++v) {
    if (slot_[at(v)] < 0) continue;
    const double size = std::abs(entry(v, position));
    if (size > largest) largest = size, best = v;
    if (v < given_.columns() && given_.cost(v) != 0.0 && size > costly_largest) costly_largest = size, costly = v;
  }
  if (costly >= 0 && costly_largest > 1e-3 * largest) best = costly;
  if (best < 0 || largest < singular) return false;
  exchange(best, in_nonbasics(best), position);
  return true;
}

void Tableau::drop(int i) {
  const int last = static_cast<int>(basic_.size()) - 1;
  if (i != last) {
    std::copy_n(entries(last), width_, writable(i));
    basic_[at(i)] = basic_[at(last)];
    slot_[at(basic_[at(i)])] = i;
  }
  basic_.pop_back();
  entries_.resize(basic_.size() * width_);
}

void Tableau::replace_row(int row, std::span<const int> columns, std::span<const double> values) {
  if (!given_.replace_row(row, columns, values)) return;
  const int i = slot_[at(given_.columns() + row)];
  if (i >= 0) {
    if (i != unstored) drop(i);
    return make_basic(row);
  }
  // The new row in terms of the old one and the other nonbasics, then solved for the old one, which goes.
  const int position = -1 - i;
  express(row, expressed_.data());
  double largest = 0.0;
  for (int j = 0; j < given_.columns(); ++j) largest = std::max(largest, std::abs(expressed_[at(j)]));
  if (std::abs(expressed_[at(position)]) > 0.01 * largest)
    eliminate(expressed_.data(), position, -1);
  else if (!free_row(row))
    start_cold();
  else if (const int freed = slot_[at(given_.columns() + row)]; freed != unstored)
    express(row, writable(freed));
}

void Tableau::remove_row(int row) {
  const auto removed = at(given_.columns() + row);
  if (slot_[removed] < 0 && !free_row(row)) start_cold();
  if (const int i = slot_[removed]; i != unstored) drop(i);
  if (row != given_.rows() - 1) {
    const int i = slot_[removed] = slot_.back();
    if (i != unstored) (i < 0 ? nonbasic_[at(-1 - i)] : basic_[at(i)]) = static_cast<int>(removed);
  }
  slot_.pop_back();
  given_.remove_row(row);
}

void Tableau::start_cold() {
  for (int j = 0; j < given_.columns(); ++j) {
    nonbasic_[at(j)] = j;
    slot_[at(j)] = -1 - j;
    is_row_[at(j)] = 0.0;
  }
  basic_.clear();
  entries_.clear();
  for (int r = 0; r < given_.rows(); ++r) make_basic(r);
}

void Tableau::refactor() {
  std::vector<int> active_rows;
  std::vector<char> wanted(at(given_.columns()), 0);
  for (const int v : nonbasic_) {
    if (v >= given_.columns()) active_rows.push_back(v);
  }
  for (const int v : basic_) {
    if (v < given_.columns()) wanted[at(v)] = 1;
  }
  start_cold();
  for (const int v : active_rows) {
    const double* row = in_nonbasics(v);
    int best = -1;
    for (int j = 0; j < given_.columns(); ++j) {
      const int c = nonbasic_[at(j)];
      if (c >= given_.columns() || wanted[at(c)] == 0) continue;
      if (best < 0 || std::abs(row[j]) > std::abs(row[best])) best = j;
    }
    if (best >= 0 && std::abs(row[best]) > singular) exchange(v, row, best);
  }
}

/// Solves a row for the nonbasic variable at a position, and puts that into all rows of the tableau but one.
void Tableau::eliminate(const double* row, int position, int but) {
  const double inverse = 1.0 / row[position];
  for (std::size_t j = 0; j < width_; ++j) pivot_row_[j] = row[j] * -inverse;
  pivot_row_[at(position)] = inverse;
  add_multiples_of_row(entries_.data(), basic_.size(), width_, pivot_row_.data(), at(position), but);
  ++pivots_;
}

void Tableau::exchange(int out, const double* row, int position) {
  int i = slot_[at(out)];
  eliminate(row, position, i);
  const int in = nonbasic_[at(position)];
  nonbasic_[at(position)] = out;
  slot_[at(out)] = -1 - position;
  is_row_[at(position)] = out >= given_.columns() ? 1.0 : 0.0;
  if (is_stored(in)) {
    if (i == unstored) i = append(in);
    std::ranges::copy(pivot_row_, writable(i));
    basic_[at(i)] = in;
    slot_[at(in)] = i;
  } else {
    slot_[at(in)] = unstored;
    if (i != unstored) drop(i);
  }
}

}  // namespace accdec::exact
