#include <algorithm>
#include <cmath>

#include <accdec/exact/dual_simplex.hpp>
#include <accdec/exact/tableau_loops.hpp>

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

DualSimplex::DualSimplex(int columns)
    : basis_(columns),
      answer_(columns),
      value_(nth(columns), 0.0),
      at_(nth(columns), lower),
      dual_(basis_.width(), 0.0) {}

void DualSimplex::add_row(std::span<const int> columns, std::span<const double> values, double low, double high) {
  basis_.add_row(columns, values, low, high);
  value_.push_back(0.0);
  at_.push_back(lower);
}

void DualSimplex::replace_row(int row, std::span<const int> columns, std::span<const double> values, double low,
                              double high) {
  set_row_bounds(row, low, high);
  basis_.replace_row(row, columns, values);
}

void DualSimplex::remove_row(int row) {
  basis_.remove_row(row);
  const auto to = nth(columns() + row);
  value_[to] = value_.back(), at_[to] = at_.back();
  value_.pop_back(), at_.pop_back();
}

DualSimplex::Status DualSimplex::solve() {
  for (int v = 0; v < given().variables(); ++v) {
    if (given().low(v) <= given().high(v)) continue;
    answer_.take_contradiction(given(), v);
    return Status::trouble;
  }
  Status status = attempt();
  if (status != Status::trouble) return status;
  basis_.refactor();
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
  for (int j = 0; j < columns(); ++j) {
    const At state = at_[nth(basis_.nonbasic(j))];
    if (state < far_below) continue;
    return std::abs(dual_[nth(j)]) > dual_tolerance ? Status::unbounded : Status::trouble;
  }
  return answer_.take_point(basis_, value_, dual_) ? Status::optimal : Status::trouble;
}

void DualSimplex::compute_duals() {
  std::fill(dual_.begin(), dual_.end(), 0.0);
  for (int j = 0; j < columns(); ++j) {
    if (basis_.nonbasic(j) < columns()) dual_[nth(j)] = given().cost(basis_.nonbasic(j));
  }
  const std::span<const int> basic = basis_.basic();
  for (std::size_t i = 0; i < basic.size(); ++i) {
    if (basic[i] >= columns() || given().cost(basic[i]) == 0.0) continue;
    add_multiple(dual_.data(), basis_.entries(static_cast<int>(i)), given().cost(basic[i]), basis_.width());
  }
}

bool DualSimplex::dual_feasible() const {
  for (int j = 0; j < columns(); ++j) {
    const int v = basis_.nonbasic(j);
    if (given().fixed(v)) continue;
    const double d = dual_[nth(j)];
    if ((d > dual_tolerance && at_[nth(v)] != lower) || (d < -dual_tolerance && at_[nth(v)] != upper)) return false;
  }
  return true;
}

/// Puts every nonbasic variable at the bound its reduced cost asks for.
void DualSimplex::settle_nonbasics() {
  for (int j = 0; j < columns(); ++j) {
    const int variable = basis_.nonbasic(j);
    const auto v = nth(variable);
    const double d = dual_[nth(j)], low = given().low(variable), high = given().high(variable);
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
      case far_below: value_[v] = given().least_activity(variable, far); break;
      case far_above: value_[v] = given().most_activity(variable, far); break;
    }
  }
}

void DualSimplex::compute_basics() {
  std::vector<double>& x = scratch_;
  x.assign(basis_.width(), 0.0);
  for (int j = 0; j < columns(); ++j) x[nth(j)] = value_[nth(basis_.nonbasic(j))];
  const std::span<const int> basic = basis_.basic();
  for (std::size_t i = 0; i < basic.size(); ++i)
    value_[nth(basic[i])] = dot(basis_.entries(static_cast<int>(i)), x.data(), basis_.width());
  basis_.compute_unstored(value_);
}

DualSimplex::Status DualSimplex::iterate() {
  const int most = 200 + 30 * given().variables();
  for (int count = 1; count <= most; ++count) {
    if (count % 16 == 0 && stop_ && stop_()) return Status::stopped;
    // After this many pivots the method may be cycling.
    if (count % (5 * given().variables() + 50) == 0) perturb();
    const int v = leaving_variable();
    if (v < 0) return Status::optimal;
    const double* row = basis_.in_nonbasics(v);
    const double above = value_[nth(v)] - given().high(v), below = given().low(v) - value_[nth(v)];
    const double sigma = above > below ? 1.0 : -1.0;
    const int position = entering_position(row, sigma, std::max(above, below));
    if (position < 0) return answer_.take_ray(basis_, v, row, sigma) ? Status::infeasible : Status::trouble;
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
    const double x = value_[nth(v)], infeasibility = std::max(x - given().high(v), given().low(v) - x);
    if (!(infeasibility > primal_tolerance)) return;
    const double own = v >= columns() ? 1.0 : 1e-6, square = infeasibility * infeasibility;
    if (square <= own * largest) return;
    const double rate = square / (own + basis_.square_in_rows(v));
    if (rate > largest) largest = rate, best = v;
  };
  for (const int v : basis_.basic()) consider(v);
  for (int v = columns(); v < given().variables(); ++v) {
    if (basis_.is_unstored(v)) consider(v);
  }
  return best;
}

/// The column that enters; sets `flips_`. @return -1: there is none
int DualSimplex::entering_position(const double* row, double sigma, double infeasibility) {
  ratio_test_.begin();
  for (int j = 0; j < columns(); ++j) {
    const double a = sigma * row[j];
    if (std::abs(a) < smallest_entry) continue;
    const int v = basis_.nonbasic(j);
    if (given().fixed(v)) continue;
    const At state = at_[nth(v)];
    const bool rises = state == lower || state == far_below || state == free;
    const bool falls = state == upper || state == far_above || state == free;
    if ((a < 0.0 && rises) || (a > 0.0 && falls)) {
      const double d = state == free ? 0.0 : std::max(0.0, falls ? -dual_[nth(j)] : dual_[nth(j)]);
      const double size = std::abs(a);
      ratio_test_.add({j, d, size, state >= free ? infinity : size * (given().high(v) - given().low(v))});
    }
  }
  return ratio_test_.choose(infeasibility, flips_);
}

/// Moves the nonbasic variables in `flips_` to their other bounds.
void DualSimplex::flip() {
  if (flips_.empty()) return;
  std::vector<double>& moves = scratch_;
  moves.assign(basis_.width(), 0.0);
  for (const int j : flips_) {
    const int v = basis_.nonbasic(j);
    const bool rises = at_[nth(v)] == lower;
    const double from = rises ? given().low(v) : given().high(v), to = rises ? given().high(v) : given().low(v);
    moves[nth(j)] = to - from;
    value_[nth(v)] = to;
    at_[nth(v)] = rises ? upper : lower;
  }
  const std::span<const int> basic = basis_.basic();
  for (std::size_t k = 0; k < basic.size(); ++k)
    value_[nth(basic[k])] += dot(basis_.entries(static_cast<int>(k)), moves.data(), basis_.width());
}

void DualSimplex::step(int leaving, const double* row, int position, double sigma) {
  // Reduced costs.
  const double a = sigma * row[position];
  const double t = std::max(0.0, -dual_[nth(position)] / a);
  add_multiple(dual_.data(), row, t * sigma, basis_.width());
  dual_[nth(position)] = -sigma * t;
  flip();
  // Values.
  if (!flips_.empty() && basis_.is_unstored(leaving))
    value_[nth(leaving)] = given().activity(leaving - columns(), value_);
  const double bound = sigma > 0.0 ? given().high(leaving) : given().low(leaving);
  const double move = (bound - value_[nth(leaving)]) / row[position];
  const std::span<const int> basic = basis_.basic();
  for (std::size_t k = 0; k < basic.size(); ++k)
    value_[nth(basic[k])] += basis_.entries(static_cast<int>(k))[position] * move;
  const int entering = basis_.nonbasic(position);
  value_[nth(entering)] += move;
  value_[nth(leaving)] = bound;
  at_[nth(leaving)] = sigma > 0.0 ? upper : lower;
  basis_.exchange(leaving, row, position);
  basis_.compute_unstored(value_);
  reset_wrong_duals();
}

/// Sets reduced costs to 0 that are on the wrong side by less than the tolerance.
void DualSimplex::reset_wrong_duals() {
  for (int j = 0; j < columns(); ++j) {
    const At state = at_[nth(basis_.nonbasic(j))];
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
  for (int j = 0; j < columns(); ++j) {
    random_ = random_ * 1664525u + 1013904223u;
    const double by = 1e-7 * (1.0 + static_cast<double>(random_ >> 8) / 16777216.0);
    const At state = at_[nth(basis_.nonbasic(j))];
    if (state == lower) dual_[nth(j)] += by;
    if (state == upper) dual_[nth(j)] -= by;
  }
}

}  // namespace accdec::exact
