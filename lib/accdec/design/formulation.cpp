#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <accdec/design/formulation.hpp>

namespace accdec {

namespace {

/// Largest value over variables in [0, 1].
double largest(const Affine& a) {
  double sum = a.constant;
  for (const auto& [index, coefficient] : a.terms) sum += std::max(coefficient, 0.0);
  return sum;
}

}  // namespace

MarginProblem::MarginProblem(const Task& task, const FormulationOptions& options, std::span<const int> samples)
    : order_(options.order), reduced_(options.reduced) {
  set_name("least corner error");
  stop_when(options.stop);
  const CumulativeVariables b = add_cumulative_variables(*this, options.order);
  const Response response(task.machine, task.sample_period);
  const CumulativeVariables motion = b.behind(motion_taps(response, 0));
  sigma_ = add_variable("sigma", {0.0, nlp::infinity});
  // The largest sigma, with both legs' distances largest and along one line. It makes the box finite, which population
  // methods need.
  double sigma_max = 1.0;
  bool any_bound = false;
  for (const TaskCorner& corner : task.corners) any_bound = any_bound || corner.error_max.has_value();
  for (std::size_t j = 0; j < task.corners.size(); ++j) {
    const TaskCorner& corner = task.corners[j];
    if (any_bound && !corner.error_max) continue;
    // A tolerance of zero is an exact stop, which the delay alone guarantees.
    const double unit = any_bound ? *corner.error_max : 100e-6;
    if (unit == 0.0) continue;
    if (!response.common()) {
      const int row = add_row("corner error, corner " + corner.name, {-nlp::infinity, 0.0});
      sigma_max = std::max(sigma_max, add_axes(row, b, task, corner, samples[j], options.blend_delays[j], unit));
      add_to_row(row, {0.0, {{sigma_, -1.0}}});
      continue;
    }
    const double in = corner.geometry().feed_in * task.sample_period / unit,
                 out = corner.geometry().feed_out * task.sample_period / unit;
    const int k = samples[j], m = k - options.blend_delays[j];
    Affine p = in * motion.remaining_moment(k), q = out * motion.elapsed_moment(m);
    sigma_max = std::max(sigma_max, std::pow(largest(p) + largest(q), 2));
    if (!options.reduced) {
      const int ip = add_variable("P " + corner.name, {0.0, nlp::infinity}),
                iq = add_variable("Q " + corner.name, {0.0, nlp::infinity});
      add_to_row(add_row("distance in, corner " + corner.name, {0.0, 0.0}), p + Affine{0.0, {{ip, -1.0}}});
      add_to_row(add_row("distance out, corner " + corner.name, {0.0, 0.0}), q + Affine{0.0, {{iq, -1.0}}});
      p = {0.0, {{ip, 1.0}}};
      q = {0.0, {{iq, 1.0}}};
    }
    const int row = add_row("corner error, corner " + corner.name, {-nlp::infinity, 0.0});
    add_product(row, 1.0, p, p);
    add_product(row, 1.0, q, q);
    add_product(row, 2.0 * corner.geometry().cos_interior(), p, q);
    add_to_row(row, {0.0, {{sigma_, -1.0}}});
  }
  add_limit_rows(*this, b, task, options);
  set_variable_bound(sigma_, {0.0, sigma_max});
  set_objective({0.0, {{sigma_, 1.0}}});
  if (options.reduced) omit_hessian();
  finish();
}

double MarginProblem::add_axes(int row, const CumulativeVariables& b, const Task& task, const TaskCorner& corner,
                               int sample, int delay, double unit) {
  const Response response(task.machine, task.sample_period);
  const Corner& g = corner.geometry();
  const double step = task.sample_period / unit;
  double squares = 0.0;
  for (Eigen::Index a = 0; a < g.axes(); ++a) {
    const CumulativeVariables motion = b.behind(motion_taps(response, static_cast<std::size_t>(a)));
    Affine position = -g.feed_in * step * g.direction_in[a] * motion.remaining_moment(sample);
    position += g.feed_out * step * g.direction_out[a] * motion.elapsed_moment(sample - delay);
    squares += std::pow(std::max(largest(position), largest(-1.0 * position)), 2);
    if (!reduced_) {
      const std::string& axis = task.machine.axes[static_cast<std::size_t>(a)].name;
      const int s = add_variable(fmt::format("S {} {}", axis, corner.name), {-nlp::infinity, nlp::infinity});
      add_to_row(add_row(fmt::format("position {}, corner {}", axis, corner.name), {0.0, 0.0}),
                 position + Affine{0.0, {{s, -1.0}}});
      position = {0.0, {{s, 1.0}}};
    }
    add_product(row, 1.0, position, position);
  }
  return squares;
}

namespace {

/// Sets every variable that a row "affine - variable = 0" defines.
void fill_defined(const nlp::Problem& problem, int first, std::vector<double>& x) {
  std::vector<double> c(static_cast<std::size_t>(problem.num_rows()));
  problem.rows(x, c);
  for (const nlp::Entry& e : problem.jacobian_pattern()) {
    const nlp::Bound bound = problem.row_bound(e.row);
    const bool definition = bound.lower == 0.0 && bound.upper == 0.0;
    if (definition && e.column >= first && x[static_cast<std::size_t>(e.column)] == 0.0) {
      x[static_cast<std::size_t>(e.column)] = c[static_cast<std::size_t>(e.row)];
    }
  }
}

void fill_cumulative(const Filter& filter, int order, std::vector<double>& x) {
  for (int k = 1; k <= order; ++k) x[static_cast<std::size_t>(k - 1)] = filter.cumulative(k);
}

}  // namespace

std::vector<double> MarginProblem::start_from(const Filter& filter) const {
  std::vector<double> x(static_cast<std::size_t>(num_variables()), 0.0);
  fill_cumulative(filter, order_, x);
  fill_defined(*this, order_ + 1, x);
  x[static_cast<std::size_t>(sigma_)] = std::max(1.0, least_sigma(x));
  return x;
}

double MarginProblem::least_sigma(std::span<const double> x) const {
  std::vector<double> point(x.begin(), x.end()), c(static_cast<std::size_t>(num_rows()));
  point[static_cast<std::size_t>(sigma_)] = 0.0;
  rows(point, c);
  double sigma = 0.0;
  for (const nlp::Entry& e : jacobian_pattern()) {
    if (e.column == sigma_) sigma = std::max(sigma, c[static_cast<std::size_t>(e.row)]);
  }
  return sigma;
}

Filter filter_from(std::span<const double> x, int order) {
  std::vector<double> taps(static_cast<std::size_t>(order) + 1);
  double previous = 0.0;
  for (int i = 0; i <= order; ++i) {
    const double next = i == order ? 1.0 : x[static_cast<std::size_t>(i)];
    taps[static_cast<std::size_t>(i)] = std::max(0.0, next - previous);
    previous = next;
  }
  return Filter(std::move(taps));
}

}  // namespace accdec
