#include <algorithm>
#include <cmath>

#include <accdec/exact/dual_simplex.hpp>
#include <accdec/exact/tableau_loops.hpp>

// The iterations of the dual simplex method.

namespace accdec::exact {
namespace {

constexpr double dual_tolerance = 1e-9;
constexpr double smallest_pivot = 1e-8;
constexpr double smallest_entry = 1e-11;  ///< entries of a pivot row below this are rounding
constexpr double far = 1e7;               ///< stands for an infinite bound until the basis is dual feasible

std::size_t nth(int i) {
  return static_cast<std::size_t>(i);
}

}  // namespace

DualSimplex::Status DualSimplex::solve() {
  for (int j = 0; j < static_cast<int>(low_.size()); ++j) {
    if (low_[nth(j)] <= high_[nth(j)]) continue;
    multipliers_.assign(nth(rows()), 0.0);
    if (j >= columns_)
      multipliers_[nth(j - columns_)] = 1.0;  // both sides of one row: no ray of this form tells them apart
    return Status::trouble;
  }
  Status status = attempt();
  if (status != Status::trouble) return status;
  refactor();
  status = attempt();
  if (status != Status::trouble) return status;
  start_cold();
  return attempt();
}

DualSimplex::Status DualSimplex::attempt() {
  moved_ = false;
  compute_duals();
  settle_nonbasics();
  compute_basics();
  for (int round = 0; round < 6; ++round) {
    const Status status = iterate();
    if (status != Status::optimal) return status;
    if (!moved_) break;
    // Moved reduced costs are reset. Bounded variables with a wrong sign go to their other bound.
    moved_ = false;
    compute_duals();
    if (dual_feasible()) break;
    if (round == 5) return Status::trouble;
    settle_nonbasics();
    compute_basics();
  }
  for (int j = 0; j < columns_; ++j) {
    const At state = at_[nth(nonbasic_[nth(j)])];
    if (state < far_below) continue;
    return std::abs(dual_[nth(j)]) > dual_tolerance ? Status::unbounded : Status::trouble;
  }
  return take_point() ? Status::optimal : Status::trouble;
}

void DualSimplex::compute_duals() {
  std::fill(dual_.begin(), dual_.end(), 0.0);
  for (int j = 0; j < columns_; ++j) {
    if (nonbasic_[nth(j)] < columns_) dual_[nth(j)] = cost_[nth(nonbasic_[nth(j)])];
  }
  for (std::size_t i = 0; i < basic_.size(); ++i) {
    if (basic_[i] >= columns_ || cost_[nth(basic_[i])] == 0.0) continue;
    const double c = cost_[nth(basic_[i])];
    add_multiple(dual_.data(), tableau_row(static_cast<int>(i)), c, stride_);
  }
}

bool DualSimplex::dual_feasible() {
  for (int j = 0; j < columns_; ++j) {
    const int v = nonbasic_[nth(j)];
    if (low_[nth(v)] == high_[nth(v)]) continue;
    const double d = dual_[nth(j)];
    if ((d > dual_tolerance && at_[nth(v)] != lower) || (d < -dual_tolerance && at_[nth(v)] != upper)) return false;
  }
  return true;
}

/// Puts every nonbasic variable at the bound its reduced cost asks for.
void DualSimplex::settle_nonbasics() {
  for (int j = 0; j < columns_; ++j) {
    const auto v = nth(nonbasic_[nth(j)]);
    const double d = dual_[nth(j)], low = low_[v], high = high_[v];
    const bool has_low = low > -infinity, has_high = high < infinity;
    // If the bound that it asks for is missing, a reduced cost this small counts as rounding.
    const bool rounding = std::abs(d) < 1e-7;
    if (has_low && (d > dual_tolerance || !has_high || (d >= -dual_tolerance && value_[v] - low <= high - value_[v])) &&
        (d >= -dual_tolerance || rounding || has_high)) {
      at_[v] = lower;
    } else if (has_high && (d < dual_tolerance || rounding)) {
      at_[v] = upper;
    } else if (!has_low && !has_high && rounding) {
      at_[v] = free;
    } else {
      at_[v] = d > 0.0 ? far_below : far_above;
    }
    switch (at_[v]) {
      case lower: value_[v] = low; break;
      case upper: value_[v] = high; break;
      case free: value_[v] = 0.0; break;
      case far_below: value_[v] = least_activity(static_cast<int>(v)); break;
      case far_above: value_[v] = most_activity(static_cast<int>(v)); break;
    }
  }
}

/// A bound slightly below the least value that the columns' bounds allow; no solution lies there.
double DualSimplex::least_activity(int variable) const {
  double sum = 0.0;
  if (variable < columns_) return std::min(high_[nth(variable)], 0.0) - far;
  const Row& row = rows_[nth(variable - columns_)];
  for (std::size_t e = 0; e < row.columns.size(); ++e) {
    const double a = row.values[e], side = a > 0.0 ? low_[nth(row.columns[e])] : high_[nth(row.columns[e])];
    if (a != 0.0) sum += a * side;
  }
  return std::max(sum, std::min(high_[nth(variable)], 0.0) - far) - 1.0;
}

double DualSimplex::most_activity(int variable) const {
  double sum = 0.0;
  if (variable < columns_) return std::max(low_[nth(variable)], 0.0) + far;
  const Row& row = rows_[nth(variable - columns_)];
  for (std::size_t e = 0; e < row.columns.size(); ++e) {
    const double a = row.values[e], side = a > 0.0 ? high_[nth(row.columns[e])] : low_[nth(row.columns[e])];
    if (a != 0.0) sum += a * side;
  }
  return std::min(sum, std::max(low_[nth(variable)], 0.0) + far) + 1.0;
}

void DualSimplex::compute_basics() {
  std::vector<double>& x = scratch_values_;
  x.assign(stride_, 0.0);
  for (int j = 0; j < columns_; ++j) x[nth(j)] = value_[nth(nonbasic_[nth(j)])];
  for (std::size_t i = 0; i < basic_.size(); ++i)
    value_[nth(basic_[i])] = dot(tableau_row(static_cast<int>(i)), x.data(), stride_);
  compute_unstored();
}

/// Computes the values of basic rows that the tableau does not hold, from the columns' values.
void DualSimplex::compute_unstored() {
  const int* const slots = slot_.data() + columns_;
  double* const values = value_.data() + columns_;
  for (std::size_t r = 0; r < short_rows_.size(); ++r) {
    if (slots[r] != unstored) continue;
    const ShortRow& row = short_rows_[r];
    double sum = 0.0;
    for (std::size_t e = 0; e < row.size; ++e) sum += row.values[e] * value_[nth(row.columns[e])];
    values[r] = sum;
  }
}

DualSimplex::Status DualSimplex::iterate() {
  const int most = 200 + 30 * (columns_ + rows());
  for (int count = 1; count <= most; ++count) {
    if (count % 16 == 0 && stop_ && stop_()) return Status::stopped;
    // After this many pivots the method may be cycling.
    if (count % (5 * (columns_ + rows()) + 50) == 0) perturb();
    const int v = leaving_variable();
    if (v < 0) return Status::optimal;
    const double* row = in_nonbasics(v);
    const double above = value_[nth(v)] - high_[nth(v)], below = low_[nth(v)] - value_[nth(v)];
    const double sigma = above > below ? 1.0 : -1.0;
    const int position = entering_position(row, sigma, std::max(above, below));
    if (position < 0) return take_ray(v, row, sigma) ? Status::infeasible : Status::trouble;
    if (std::abs(row[position]) < smallest_pivot) return Status::trouble;
    step(v, row, position, sigma);
  }
  return Status::trouble;
}

/// Largest infeasibility in the norm of the row of the basis' inverse.
int DualSimplex::leaving_variable() {
  int best = -1;
  double largest = 0.0;
  const auto consider = [&](int v) {
    const double x = value_[nth(v)], infeasibility = std::max(x - high_[nth(v)], low_[nth(v)] - x);
    if (!(infeasibility > primal_tolerance)) return;
    const double own = v >= columns_ ? 1.0 : 1e-6, square = infeasibility * infeasibility;
    if (square <= own * largest) return;
    const double rate = square / (own + sum_of_squares(is_row_.data(), in_nonbasics(v), stride_));
    if (rate > largest) largest = rate, best = v;
  };
  for (const int v : basic_) consider(v);
  for (int v = columns_; v < static_cast<int>(slot_.size()); ++v) {
    if (slot_[nth(v)] == unstored) consider(v);
  }
  return best;
}

/// The column that enters; sets `flips_`. @return -1: there is none
int DualSimplex::entering_position(const double* row, double sigma, double infeasibility) {
  ratio_test_.begin();
  for (int j = 0; j < columns_; ++j) {
    const double a = sigma * row[j];
    if (std::abs(a) < smallest_entry) continue;
    const auto v = nth(nonbasic_[nth(j)]);
    if (low_[v] == high_[v]) continue;
    const At state = at_[v];
    const bool rises = state == lower || state == far_below || state == free;
    const bool falls = state == upper || state == far_above || state == free;
    if ((a < 0.0 && rises) || (a > 0.0 && falls)) {
      const double d = state == free ? 0.0 : std::max(0.0, falls ? -dual_[nth(j)] : dual_[nth(j)]);
      const double size = std::abs(a);
      ratio_test_.add({j, d, size, state >= free ? infinity : size * (high_[v] - low_[v])});
    }
  }
  return ratio_test_.choose(infeasibility, flips_);
}

/// Moves the nonbasic variables in `flips_` to their other bounds.
void DualSimplex::flip() {
  if (flips_.empty()) return;
  std::vector<double>& moves = scratch_values_;
  moves.assign(stride_, 0.0);
  for (const int j : flips_) {
    const auto v = nth(nonbasic_[nth(j)]);
    const bool rises = at_[v] == lower;
    moves[nth(j)] = rises ? high_[v] - low_[v] : low_[v] - high_[v];
    value_[v] = rises ? high_[v] : low_[v];
    at_[v] = rises ? upper : lower;
  }
  for (std::size_t k = 0; k < basic_.size(); ++k)
    value_[nth(basic_[k])] += dot(tableau_row(static_cast<int>(k)), moves.data(), stride_);
}

void DualSimplex::step(int leaving, const double* row, int position, double sigma) {
  // Reduced costs.
  const double a = sigma * row[position];
  const double t = std::max(0.0, -dual_[nth(position)] / a);
  add_multiple(dual_.data(), row, t * sigma, stride_);
  dual_[nth(position)] = -sigma * t;
  flip();
  // Values.
  if (!flips_.empty() && slot_[nth(leaving)] == unstored) value_[nth(leaving)] = activity(leaving - columns_, value_);
  const double bound = sigma > 0.0 ? high_[nth(leaving)] : low_[nth(leaving)];
  const double move = (bound - value_[nth(leaving)]) / row[position];
  for (std::size_t k = 0; k < basic_.size(); ++k)
    value_[nth(basic_[k])] += tableau_[k * stride_ + nth(position)] * move;
  const int entering = nonbasic_[nth(position)];
  value_[nth(entering)] += move;
  value_[nth(leaving)] = bound;
  at_[nth(leaving)] = sigma > 0.0 ? upper : lower;
  exchange(leaving, row, position);
  compute_unstored();
  // Reduced costs on the wrong side by less than the tolerance.
  for (int j = 0; j < columns_; ++j) {
    const At state = at_[nth(nonbasic_[nth(j)])];
    double& d = dual_[nth(j)];
    const bool wrong =
        ((state == lower || state == far_below) && d < 0.0) || ((state == upper || state == far_above) && d > 0.0);
    if (!wrong) continue;
    if (std::abs(d) > 1e-12) moved_ = true;
    d = 0.0;
  }
}

/// Moves the reduced costs away from zero, each by a different amount, to break ties.
void DualSimplex::perturb() {
  moved_ = true;
  for (int j = 0; j < columns_; ++j) {
    random_ = random_ * 1664525u + 1013904223u;
    const double by = 1e-7 * (1.0 + static_cast<double>(random_ >> 8) / 16777216.0);
    const At state = at_[nth(nonbasic_[nth(j)])];
    if (state == lower) dual_[nth(j)] += by;
    if (state == upper) dual_[nth(j)] -= by;
  }
}

}  // namespace accdec::exact
