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

/// Linearly interpolated step response of a point behind some taps: B(y), with knots at the integers, 0 before 0 and 1
/// after N + 1.
class Interpolated {
 public:
  /// @param order  of the designed filter, whose B are the first numbers of x
  Interpolated(std::span<const double> x, int order, std::span<const double> response)
      : order_(order + static_cast<int>(response.size()) - 1) {
    const auto designed = [&](int k) { return k <= 0 ? 0.0 : k > order ? 1.0 : x[at(k - 1)]; };
    for (int k = 1; k <= order_; ++k) {
      double sum = 0.0;
      for (std::size_t i = 0; i < response.size(); ++i) sum += response[i] * designed(k - static_cast<int>(i));
      knots_.push_back(sum);
    }
  }
  double knot(int k) const { return k <= 0 ? 0.0 : k > order_ ? 1.0 : knots_[at(k - 1)]; }
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
  int order_;
  std::vector<double> knots_;
};

/// Value at y of the hat function of knot i, and its integral from -infinity to y.
double hat(int i, double y) {
  return std::max(0.0, 1.0 - std::abs(y - i));
}
double hat_integral(int i, double y) {
  const double f = std::clamp(y - (i - 1), 0.0, 2.0);
  return f <= 1.0 ? 0.5 * f * f : 1.0 - 0.5 * (2.0 - f) * (2.0 - f);
}

/// Adds a function of the motion's knots to that of the B_i that they are made of.
template <class OfKnot>
double through(std::span<const double> response, int i, const OfKnot& of_knot) {
  double sum = 0.0;
  for (std::size_t s = 0; s < response.size(); ++s) sum += response[s] * of_knot(i + static_cast<int>(s));
  return sum;
}

}  // namespace

DelayProblem::DelayProblem(const Task& task, const FormulationOptions& options)
    : order_(options.order), reduced_(options.reduced) {
  set_name("least weighted delay");
  stop_when(options.stop);
  const Response response(task.machine, task.sample_period);
  motion_order_ = order_ + response.order(), ideal_ = response.ideal(), common_ = response.common();
  const CumulativeVariables b = add_cumulative_variables(*this, order_);
  Affine objective = add_closest(task);
  for (Closest& c : closest_) add_error_rows(c, task, options.margin);
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
      if (!corner.delay) fixed_delays_[j] = motion_order_;
      continue;
    }
    Closest c;
    c.corner = j;
    c.scale_in = corner.geometry().feed_in * task.sample_period / *corner.error_max;
    c.scale_out = corner.geometry().feed_out * task.sample_period / *corner.error_max;
    c.cosine = common_ ? corner.geometry().cos_interior() : 0.0;
    const double fixed = fixed_delays_[j], last = motion_order_ + 1.0;
    c.delay = add_variable("d " + corner.name, corner.delay ? nlp::Bound{fixed, fixed} : nlp::Bound{0.0, last});
    c.instant = add_variable("t " + corner.name, {0.0, 2.0 * last});
    c.parts = parts_of(task, corner.geometry(), c);
    if (!corner.delay) objective.add(c.delay, corner.weight);
    closest_.push_back(std::move(c));
  }
  return objective;
}

std::vector<DelayProblem::Part> DelayProblem::parts_of(const Task& task, const Corner& corner, const Closest& c) const {
  const Response response(task.machine, task.sample_period);
  if (common_) {
    const std::vector<double> taps = motion_taps(response, 0);
    return {{taps, c.scale_in, 0.0, -1, -1, {}}, {taps, 0.0, c.scale_out, -1, -1, {}}};
  }
  std::vector<Part> parts;
  for (Eigen::Index a = 0; a < corner.axes(); ++a)
    parts.push_back({motion_taps(response, static_cast<std::size_t>(a)),
                     -c.scale_in * corner.direction_in[a],
                     c.scale_out * corner.direction_out[a],
                     -1,
                     -1,
                     {}});
  return parts;
}

void DelayProblem::add_error_rows(Closest& c, const Task& task, double margin) {
  const std::string& name = task.corners[c.corner].name;
  const auto reserve = [&](int row, bool delay) {
    for (int i = 0; i < order_; ++i) reserve_jacobian(row, i);
    reserve_jacobian(row, c.instant);
    if (delay) reserve_jacobian(row, c.delay);
  };
  if (reduced_) {
    c.row_error = add_row("corner error, corner " + name, {-nlp::infinity, 1.0 - margin});
    reserve(c.row_error, true);
    return;
  }
  for (std::size_t i = 0; i < c.parts.size(); ++i) {
    Part& part = c.parts[i];
    const std::string& axis = common_ ? name : task.machine.axes[i].name;
    part.variable = common_ ? add_variable((i == 0 ? "P " : "Q ") + name, {0.0, nlp::infinity})
                            : add_variable(fmt::format("S {} {}", axis, name), {-nlp::infinity, nlp::infinity});
    part.row = add_row(common_ ? (i == 0 ? "distance in, corner " : "distance out, corner ") + name
                               : fmt::format("position {}, corner {}", axis, name),
                       {0.0, 0.0});
    add_to_row(part.row, {0.0, {{part.variable, -1.0}}});
    reserve(part.row, part.out != 0.0);
  }
  for (int i = 0; i < order_; ++i) {
    reserve_hessian(c.instant, i);
    reserve_hessian(c.delay, i);
  }
  reserve_hessian(c.instant, c.instant);
  reserve_hessian(c.instant, c.delay);
  reserve_hessian(c.delay, c.delay);
  c.row_error = add_row("corner error, corner " + name, {-nlp::infinity, 1.0 - margin});
  const auto form = [](const Part& part) { return Affine{0.0, {{part.variable, 1.0}}}; };
  for (const Part& part : c.parts) add_product(c.row_error, 1.0, form(part), form(part));
  if (common_) add_product(c.row_error, 2.0 * c.cosine, form(c.parts[0]), form(c.parts[1]));
}

void DelayProblem::find_slots(Closest& c) const {
  for (Part& part : c.parts) {
    for (const auto& extra : rows_[at(reduced_ ? c.row_error : part.row)].extra) part.slots.push_back(extra.second);
  }
  if (reduced_) return;
  for (int i = 0; i < order_; ++i) {
    c.hessian_t.push_back(hessian_slot(c.instant, i));
    c.hessian_d.push_back(hessian_slot(c.delay, i));
  }
  c.hessian_tt = hessian_slot(c.instant, c.instant);
  c.hessian_td = hessian_slot(c.instant, c.delay);
  c.hessian_dd = hessian_slot(c.delay, c.delay);
}

std::vector<Approach> DelayProblem::approaches() const {
  if (reduced_ || !ideal_) throw std::logic_error("the reduced form, or one behind a response, has no such rows");
  std::vector<Approach> found;
  for (const Closest& c : closest_) {
    found.push_back({c.parts[0].row, c.instant, -1, c.scale_in});
    found.push_back({c.parts[1].row, c.instant, c.delay, c.scale_out});
  }
  return found;
}

std::vector<double> DelayProblem::part_values(std::span<const double> x, const Closest& e) const {
  std::vector<double> values;
  const double t = x[at(e.instant)], d = x[at(e.delay)];
  for (const Part& part : e.parts) {
    const Interpolated b(x, order_, part.response);
    values.push_back((part.in != 0.0 ? part.in * b.remaining(t) : 0.0) +
                     (part.out != 0.0 ? part.out * b.integral(t - d) : 0.0));
  }
  return values;
}

void DelayProblem::rows(std::span<const double> x, std::span<double> c) const {
  QuadraticProblem::rows(x, c);
  for (const Closest& e : closest_) {
    const std::vector<double> values = part_values(x, e);
    double error = common_ ? 2.0 * e.cosine * values[0] * values[1] : 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      error += values[i] * values[i];
      if (!reduced_) c[at(e.parts[i].row)] += values[i];
    }
    if (reduced_) c[at(e.row_error)] += error;
  }
}

void DelayProblem::jacobian(std::span<const double> x, std::span<double> values) const {
  QuadraticProblem::jacobian(x, values);
  const auto n = at(order_);
  for (const Closest& e : closest_) {
    const double t = x[at(e.instant)], m = t - x[at(e.delay)];
    const std::vector<double> parts = reduced_ ? part_values(x, e) : std::vector<double>();
    for (std::size_t p = 0; p < e.parts.size(); ++p) {
      const Part& part = e.parts[p];
      const Interpolated b(x, order_, part.response);
      double weight = 1.0;  // d(row)/d(part)
      if (reduced_) weight = 2.0 * (parts[p] + (common_ ? e.cosine * parts[1 - p] : 0.0));
      const double in = weight * part.in, out = weight * part.out;
      for (std::size_t i = 0; i < n; ++i) {
        values[at(part.slots[i])] += through(part.response, static_cast<int>(i) + 1, [&](int knot) {
          return (in != 0.0 ? in * (hat_integral(knot, t) - 1.0) : 0.0) +
                 (out != 0.0 ? out * hat_integral(knot, m) : 0.0);
        });
      }
      values[at(part.slots[n])] += in * (b.value(t) - 1.0) + out * b.value(m);
      if (part.out != 0.0) values[at(part.slots[n + 1])] -= out * b.value(m);
    }
  }
}

void DelayProblem::hessian(std::span<const double> x, double objective_factor, std::span<const double> multipliers,
                           std::span<double> values) const {
  QuadraticProblem::hessian(x, objective_factor, multipliers, values);
  for (const Closest& e : closest_) {
    const double t = x[at(e.instant)], m = t - x[at(e.delay)];
    for (const Part& part : e.parts) {
      const Interpolated b(x, order_, part.response);
      const double p = multipliers[at(part.row)] * part.in, q = multipliers[at(part.row)] * part.out;
      // Each hat has width 2: only the two knots around t, and around t - d, contribute.
      const auto around = [&](double y, auto add) {
        const int k = static_cast<int>(std::floor(std::clamp(y, -1.0, motion_order_ + 2.0)));
        for (const int knot : {k, k + 1}) {
          for (std::size_t s = 0; s < part.response.size(); ++s) {
            const int i = knot - static_cast<int>(s);
            if (i >= 1 && i <= order_) add(at(i - 1), part.response[s] * hat(knot, y));
          }
        }
      };
      if (p != 0.0) around(t, [&](std::size_t i, double h) { values[at(e.hessian_t[i])] += p * h; });
      if (q != 0.0)
        around(m, [&](std::size_t i, double h) {
          values[at(e.hessian_t[i])] += q * h;
          values[at(e.hessian_d[i])] -= q * h;
        });
      values[at(e.hessian_tt)] += p * b.slope(t) + q * b.slope(m);
      values[at(e.hessian_td)] -= q * b.slope(m);
      values[at(e.hessian_dd)] += q * b.slope(m);
    }
  }
}

std::vector<double> DelayProblem::start_from(const Filter& filter, std::span<const double> delays) const {
  std::vector<double> x(at(num_variables()), 0.0);
  for (int k = 1; k <= order_; ++k) x[at(k - 1)] = filter.cumulative(k);
  for (const Closest& e : closest_) {
    x[at(e.delay)] = delays[e.corner];
    // Starts where the distances left and gone are equal: the apex for equal feeds, near it otherwise.
    const Interpolated b(x, order_, e.parts.front().response);
    double low = 0.0, high = motion_order_ + 1.0 + delays[e.corner];
    for (int i = 0; i < 60; ++i) {
      const double t = 0.5 * (low + high);
      (e.scale_in * b.remaining(t) > e.scale_out * b.integral(t - x[at(e.delay)]) ? low : high) = t;
    }
    x[at(e.instant)] = low;
    const std::vector<double> values = part_values(x, e);
    for (std::size_t i = 0; !reduced_ && i < values.size(); ++i) x[at(e.parts[i].variable)] = values[i];
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
