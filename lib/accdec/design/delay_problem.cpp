#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/design/formulation.hpp>

namespace accdec {
namespace {

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

/// Linearly interpolated step response of a point: B(y), with knots at the integers, 0 before 0 and 1 after N + 1.
class Interpolated {
 public:
  Interpolated(std::span<const double> x, int order) : x_(x), order_(order) {}
  double knot(int k) const { return k <= 0 ? 0.0 : k > order_ ? 1.0 : x_[at(k - 1)]; }
  double value(double y) const {
    const int k = cell(y);
    return knot(k) + (y - k) * (knot(k + 1) - knot(k));
  }
  double slope(double y) const {
    const int k = cell(y);
    return knot(k + 1) - knot(k);
  }
  /// integral of B from -infinity to y
  double integral(double y) const {
    if (y <= 0.0) return 0.0;
    const int k = std::min(cell(y), order_ + 1);
    double sum = 0.0;
    for (int j = 1; j <= k; ++j) sum += knot(j);
    sum -= 0.5 * knot(k);
    const double f = std::min(y, order_ + 1.0) - k;
    return sum + f * knot(k) + 0.5 * f * f * (knot(k + 1) - knot(k)) + std::max(0.0, y - (order_ + 1.0));
  }
  /// integral of 1 - B from y to infinity
  double remaining(double y) const {
    if (y >= order_ + 1.0) return 0.0;
    const int k = std::max(cell(y), 0);
    double sum = 0.0;
    for (int j = k + 1; j <= order_; ++j) sum += 1.0 - knot(j);
    const double f = k + 1.0 - std::max(y, 0.0);  // part of cell k that is left
    const double left = 1.0 - value(std::max(y, 0.0)), right = 1.0 - knot(k + 1);
    return sum - 0.5 * right + 0.5 * f * (left + right) + std::max(0.0, -y);
  }

 private:
  int cell(double y) const { return static_cast<int>(std::floor(std::clamp(y, -1.0, order_ + 2.0))); }
  std::span<const double> x_;
  int order_;
};

/// Value at y of the hat function of knot i, and its integral from -infinity to y.
double hat(int i, double y) {
  return std::max(0.0, 1.0 - std::abs(y - i));
}
double hat_integral(int i, double y) {
  const double f = std::clamp(y - (i - 1), 0.0, 2.0);
  return f <= 1.0 ? 0.5 * f * f : 1.0 - 0.5 * (2.0 - f) * (2.0 - f);
}

}  // namespace

DelayProblem::DelayProblem(const Task& task, const FormulationOptions& options)
    : order_(options.order), reduced_(options.reduced) {
  set_name("least weighted delay");
  const CumulativeVariables b = add_cumulative_variables(*this, order_);
  Affine objective = add_closest(task);
  for (Closest& c : closest_) add_error_rows(c, task.corners[c.corner].name, options.margin);
  add_limit_rows(*this, b, task, options);
  set_objective(std::move(objective));
  if (reduced_) omit_hessian();
  finish();
  for (Closest& c : closest_) find_slots(c);
}

Affine DelayProblem::add_closest(const Task& task) {
  Affine objective;
  fixed_delays_.assign(task.corners.size(), 0.0);
  for (std::size_t j = 0; j < task.corners.size(); ++j) {
    const TaskCorner& corner = task.corners[j];
    if (corner.delay) fixed_delays_[j] = *corner.delay;
    if (!corner.error_max) continue;
    if (*corner.error_max == 0.0) {
      // Exact stop: there is no closest approach to find, and its distance rows would lose their constraint
      // qualification.
      if (!corner.delay) fixed_delays_[j] = order_;
      continue;
    }
    Closest c;
    c.corner = j;
    c.scale_in = corner.geometry().feed_in * task.sample_period / *corner.error_max;
    c.scale_out = corner.geometry().feed_out * task.sample_period / *corner.error_max;
    c.cosine = corner.geometry().cos_interior();
    const double fixed = fixed_delays_[j];
    c.delay = add_variable("d " + corner.name, corner.delay ? nlp::Bound{fixed, fixed} : nlp::Bound{0.0, order_ + 1.0});
    c.instant = add_variable("t " + corner.name, {0.0, 2.0 * (order_ + 1.0)});
    if (!corner.delay) objective.add(c.delay, corner.weight);
    closest_.push_back(c);
  }
  return objective;
}

void DelayProblem::add_error_rows(Closest& c, const std::string& name, double margin) {
  if (reduced_) {
    c.row_error = add_row("corner error, corner " + name, {-nlp::infinity, 1.0 - margin});
    for (int i = 0; i < order_; ++i) reserve_jacobian(c.row_error, i);
    reserve_jacobian(c.row_error, c.instant);
    reserve_jacobian(c.row_error, c.delay);
    return;
  }
  c.p = add_variable("P " + name, {0.0, nlp::infinity});
  c.q = add_variable("Q " + name, {0.0, nlp::infinity});
  c.row_p = add_row("distance in, corner " + name, {0.0, 0.0});
  c.row_q = add_row("distance out, corner " + name, {0.0, 0.0});
  add_to_row(c.row_p, {0.0, {{c.p, -1.0}}});
  add_to_row(c.row_q, {0.0, {{c.q, -1.0}}});
  for (const int row : {c.row_p, c.row_q}) {
    for (int i = 0; i < order_; ++i) reserve_jacobian(row, i);
    reserve_jacobian(row, c.instant);
  }
  reserve_jacobian(c.row_q, c.delay);
  for (int i = 0; i < order_; ++i) {
    reserve_hessian(c.instant, i);
    reserve_hessian(c.delay, i);
  }
  reserve_hessian(c.instant, c.instant);
  reserve_hessian(c.instant, c.delay);
  reserve_hessian(c.delay, c.delay);
  c.row_error = add_row("corner error, corner " + name, {-nlp::infinity, 1.0 - margin});
  const Affine p{0.0, {{c.p, 1.0}}}, q{0.0, {{c.q, 1.0}}};
  add_product(c.row_error, 1.0, p, p);
  add_product(c.row_error, 1.0, q, q);
  add_product(c.row_error, 2.0 * c.cosine, p, q);
}

void DelayProblem::find_slots(Closest& c) const {
  const auto slots = [&](int row) {
    std::vector<int> found;
    for (const auto& extra : rows_[at(row)].extra) found.push_back(extra.second);
    return found;
  };
  c.slots_p = slots(reduced_ ? c.row_error : c.row_p);
  if (reduced_) return;
  c.slots_q = slots(c.row_q);
  for (int i = 0; i < order_; ++i) {
    c.hessian_t.push_back(hessian_slot(c.instant, i));
    c.hessian_d.push_back(hessian_slot(c.delay, i));
  }
  c.hessian_tt = hessian_slot(c.instant, c.instant);
  c.hessian_td = hessian_slot(c.instant, c.delay);
  c.hessian_dd = hessian_slot(c.delay, c.delay);
}

std::vector<Approach> DelayProblem::approaches() const {
  if (reduced_) throw std::logic_error("the reduced form has no rows of distances");
  std::vector<Approach> found;
  for (const Closest& c : closest_) {
    found.push_back({c.row_p, c.instant, -1, c.scale_in});
    found.push_back({c.row_q, c.instant, c.delay, c.scale_out});
  }
  return found;
}

void DelayProblem::rows(std::span<const double> x, std::span<double> c) const {
  QuadraticProblem::rows(x, c);
  const Interpolated b(x, order_);
  for (const Closest& e : closest_) {
    const double t = x[at(e.instant)], d = x[at(e.delay)];
    const double p = e.scale_in * b.remaining(t), q = e.scale_out * b.integral(t - d);
    if (reduced_) {
      c[at(e.row_error)] += p * p + q * q + 2.0 * e.cosine * p * q;
    } else {
      c[at(e.row_p)] += p;
      c[at(e.row_q)] += q;
    }
  }
}

void DelayProblem::jacobian(std::span<const double> x, std::span<double> values) const {
  QuadraticProblem::jacobian(x, values);
  const Interpolated b(x, order_);
  const auto n = at(order_);
  for (const Closest& e : closest_) {
    const double t = x[at(e.instant)], m = t - x[at(e.delay)];
    double weight_p = 1.0, weight_q = 1.0;  // d(row)/dP and d(row)/dQ
    if (reduced_) {
      const double p = e.scale_in * b.remaining(t), q = e.scale_out * b.integral(m);
      weight_p = 2.0 * (p + e.cosine * q);
      weight_q = 2.0 * (q + e.cosine * p);
    }
    const std::vector<int>& slots_q = reduced_ ? e.slots_p : e.slots_q;
    for (std::size_t i = 0; i < n; ++i) {
      const int knot = static_cast<int>(i) + 1;
      values[at(e.slots_p[i])] += weight_p * e.scale_in * (hat_integral(knot, t) - 1.0);
      values[at(slots_q[i])] += weight_q * e.scale_out * hat_integral(knot, m);
    }
    values[at(e.slots_p[n])] += weight_p * e.scale_in * (b.value(t) - 1.0);
    values[at(slots_q[n])] += weight_q * e.scale_out * b.value(m);
    values[at(slots_q[n + 1])] -= weight_q * e.scale_out * b.value(m);
  }
}

void DelayProblem::hessian(std::span<const double> x, double objective_factor, std::span<const double> multipliers,
                           std::span<double> values) const {
  QuadraticProblem::hessian(x, objective_factor, multipliers, values);
  const Interpolated b(x, order_);
  for (const Closest& e : closest_) {
    const double t = x[at(e.instant)], m = t - x[at(e.delay)];
    const double p = multipliers[at(e.row_p)] * e.scale_in, q = multipliers[at(e.row_q)] * e.scale_out;
    // Each hat has width 2: only the two knots around t, and around t - d, contribute.
    const auto around = [&](double y, auto add) {
      const int k = static_cast<int>(std::floor(std::clamp(y, -1.0, order_ + 2.0)));
      for (const int knot : {k, k + 1}) {
        if (knot >= 1 && knot <= order_) add(at(knot - 1), hat(knot, y));
      }
    };
    around(t, [&](std::size_t i, double h) { values[at(e.hessian_t[i])] += p * h; });
    around(m, [&](std::size_t i, double h) {
      values[at(e.hessian_t[i])] += q * h;
      values[at(e.hessian_d[i])] -= q * h;
    });
    values[at(e.hessian_tt)] += p * b.slope(t) + q * b.slope(m);
    values[at(e.hessian_td)] -= q * b.slope(m);
    values[at(e.hessian_dd)] += q * b.slope(m);
  }
}

std::vector<double> DelayProblem::start_from(const Filter& filter, std::span<const double> delays) const {
  std::vector<double> x(at(num_variables()), 0.0);
  for (int k = 1; k <= order_; ++k) x[at(k - 1)] = filter.cumulative(k);
  for (const Closest& e : closest_) {
    x[at(e.delay)] = delays[e.corner];
    // Starts where the distances left and gone are equal: the apex for equal feeds, near it otherwise.
    const Interpolated b(x, order_);
    double low = 0.0, high = order_ + 1.0 + delays[e.corner];
    for (int i = 0; i < 60; ++i) {
      const double t = 0.5 * (low + high);
      (e.scale_in * b.remaining(t) > e.scale_out * b.integral(t - x[at(e.delay)]) ? low : high) = t;
    }
    x[at(e.instant)] = low;
    if (!reduced_) {
      x[at(e.p)] = e.scale_in * b.remaining(low);
      x[at(e.q)] = e.scale_out * b.integral(low - x[at(e.delay)]);
    }
  }
  // Auxiliary response variables: their rows read "definition - variable", so the row at variable 0 is the value.
  std::vector<double> c(at(num_rows()));
  rows(x, c);
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    if (!rows_[r].name.starts_with("definition of ")) continue;
    for (const auto& term : rows_[r].affine.terms) {
      if (term.first >= order_) x[at(term.first)] = c[r];
    }
  }
  return x;
}

std::vector<double> DelayProblem::delays(std::span<const double> x) const {
  std::vector<double> d = fixed_delays_;
  for (const Closest& e : closest_) d[e.corner] = x[at(e.delay)];
  return d;
}

std::vector<double> DelayProblem::instants(std::span<const double> x) const {
  std::vector<double> t(fixed_delays_.size(), -1.0);
  for (const Closest& e : closest_) t[e.corner] = x[at(e.instant)];
  return t;
}

}  // namespace accdec
