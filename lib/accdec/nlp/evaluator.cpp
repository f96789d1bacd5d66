#include <algorithm>
#include <cmath>

#include <accdec/files.hpp>
#include <accdec/problem.hpp>

namespace accdec::nlp {

using Clock = std::chrono::steady_clock;

Counts& Counts::operator+=(const Counts& other) {
  objective += other.objective;
  gradient += other.gradient;
  rows += other.rows;
  jacobian += other.jacobian;
  hessian += other.hessian;
  residuals += other.residuals;
  evaluation_time += other.evaluation_time;
  verification_time += other.verification_time;
  return *this;
}

Evaluator::Evaluator(const Problem& problem, Limits limits) : problem_(problem), limits_(limits) {}

void Evaluator::end(Stop why) {
  if (stop_ == Stop::none) stop_ = why;
  throw StopRun();
}

void Evaluator::poll() {
  if (stop_ != Stop::none) throw StopRun();
  if (limits_.cancel != nullptr && limits_.cancel->load(std::memory_order_relaxed)) end(Stop::cancelled);
  if (seconds_since(began_) > limits_.time) end(Stop::time_limit);
}

template <class Call>
void Evaluator::guarded(std::int64_t& count, Call call) {
  poll();
  ++count;
  const auto before = Clock::now();
  const auto clock_out = [&] { counts_.evaluation_time += seconds_since(before); };
  try {
    call();
  } catch (...) {
    clock_out();
    exception_ = std::current_exception();
    end(Stop::exception);
  }
  clock_out();
}

void Evaluator::require_finite(std::span<const double> values) {
  if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); })) end(Stop::invalid_number);
}

double Evaluator::objective(std::span<const double> x) {
  if (counts_.objective >= limits_.evaluations) end(Stop::evaluation_limit);
  require_finite(x);
  double f = 0.0;
  guarded(counts_.objective, [&] { f = problem_.objective(x); });
  require_finite({&f, 1});
  objective_point_.assign(x.begin(), x.end());
  objective_value_ = f;
  consider();
  return f;
}

void Evaluator::gradient(std::span<const double> x, std::span<double> g) {
  guarded(counts_.gradient, [&] { problem_.gradient(x, g); });
  require_finite(g);
}

void Evaluator::rows(std::span<const double> x, std::span<double> c) {
  require_finite(x);
  guarded(counts_.rows, [&] { problem_.rows(x, c); });
  require_finite(c);
  rows_point_.assign(x.begin(), x.end());
  row_values_.assign(c.begin(), c.end());
  consider();
}

void Evaluator::jacobian(std::span<const double> x, std::span<double> values) {
  guarded(counts_.jacobian, [&] { problem_.jacobian(x, values); });
  require_finite(values);
}

void Evaluator::hessian(std::span<const double> x, double objective_factor, std::span<const double> multipliers,
                        std::span<double> values) {
  guarded(counts_.hessian, [&] { problem_.hessian(x, objective_factor, multipliers, values); });
  require_finite(values);
}

void Evaluator::residuals(std::span<const double> x, std::span<double> r) {
  require_finite(x);
  guarded(counts_.residuals, [&] { problem_.residuals(x, r); });
  require_finite(r);
}

void Evaluator::residual_jacobian(std::span<const double> x, std::span<double> values) {
  guarded(counts_.jacobian, [&] { problem_.residual_jacobian(x, values); });
  require_finite(values);
}

void Evaluator::consider() {
  if (objective_point_.empty() || objective_value_ >= best_objective_) return;
  const int m = problem_.num_rows();
  if (m > 0 && objective_point_ != rows_point_) return;
  const double slack = limits_.feasibility_tolerance;
  const auto outside = [&](Bound b, double v) { return v < b.lower - slack || v > b.upper + slack; };
  for (int r = 0; r < m; ++r) {
    if (outside(problem_.row_bound(r), row_values_[static_cast<std::size_t>(r)])) return;
  }
  for (int i = 0; i < problem_.num_variables(); ++i) {
    if (outside(problem_.variable_bound(i), objective_point_[static_cast<std::size_t>(i)])) return;
  }
  best_ = objective_point_;
  best_objective_ = objective_value_;
  history_.push_back({std::max(counts_.objective, counts_.rows), seconds_since(began_), best_objective_});
}

}  // namespace accdec::nlp
