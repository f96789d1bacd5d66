#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include <Eigen/Core>
#include <fmt/format.h>

#include <accdec/nlp/derivative_check.hpp>

namespace accdec::nlp {
namespace {

using Kind = WrongDerivative::Kind;
using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;
using Point = std::vector<double>;

std::span<double> view(Vector& v) {
  return {v.data(), static_cast<std::size_t>(v.size())};
}

class Checker {
 public:
  Checker(const Problem& problem, std::span<const double> x, double tolerance, double step)
      : problem_(problem), x_(x.begin(), x.end()), tolerance_(tolerance), step_(step) {}

  std::vector<WrongDerivative> run() {
    compare(
        Kind::gradient, [&](const Point& x) { return Vector::Constant(1, problem_.objective(x)); },
        gradient(x_).transpose());
    if (problem_.num_rows() > 0)
      compare(
          Kind::jacobian, [&](const Point& x) { return rows(x); }, jacobian(x_));
    if (problem_.num_residuals() > 0)
      compare(
          Kind::residual_jacobian, [&](const Point& x) { return residuals(x); }, residual_jacobian());
    if (problem_.has_hessian()) {
      // Irrational multipliers, so that errors of two rows do not cancel.
      multipliers_.resize(static_cast<std::size_t>(problem_.num_rows()));
      for (std::size_t r = 0; r < multipliers_.size(); ++r) multipliers_[r] = std::sin(1.0 + static_cast<double>(r));
      compare(
          Kind::hessian, [&](const Point& x) { return lagrangian_gradient(x); }, hessian());
    }
    return std::move(found_);
  }

 private:
  int n() const { return problem_.num_variables(); }

  Vector gradient(const Point& x) const {
    Vector g = Vector::Zero(n());
    problem_.gradient(x, view(g));
    return g;
  }
  Vector rows(const Point& x) const {
    Vector c(problem_.num_rows());
    problem_.rows(x, view(c));
    return c;
  }
  Vector residuals(const Point& x) const {
    Vector r(problem_.num_residuals());
    problem_.residuals(x, view(r));
    return r;
  }
  Matrix jacobian(const Point& x) const {
    Point values(problem_.jacobian_pattern().size());
    problem_.jacobian(x, values);
    Matrix j = Matrix::Zero(problem_.num_rows(), n());
    for (std::size_t e = 0; e < values.size(); ++e) {
      j(problem_.jacobian_pattern()[e].row, problem_.jacobian_pattern()[e].column) += values[e];
    }
    return j;
  }
  Matrix residual_jacobian() const {
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> j(problem_.num_residuals(), n());
    problem_.residual_jacobian(x_, {j.data(), static_cast<std::size_t>(j.size())});
    return j;
  }
  Vector lagrangian_gradient(const Point& x) const {
    Vector g = gradient(x);
    Point values(problem_.jacobian_pattern().size());
    problem_.jacobian(x, values);
    for (std::size_t e = 0; e < values.size(); ++e) {
      const Entry& entry = problem_.jacobian_pattern()[e];
      g[entry.column] += multipliers_[static_cast<std::size_t>(entry.row)] * values[e];
    }
    return g;
  }
  Matrix hessian() const {
    Point values(problem_.hessian_pattern().size());
    problem_.hessian(x_, 1.0, multipliers_, values);
    Matrix h = Matrix::Zero(n(), n());
    for (std::size_t e = 0; e < values.size(); ++e) {
      const Entry& entry = problem_.hessian_pattern()[e];
      h(entry.row, entry.column) += values[e];
      if (entry.row != entry.column) h(entry.column, entry.row) += values[e];
    }
    return h;
  }

  void compare(Kind kind, const std::function<Vector(const Point&)>& function, const Matrix& analytic) {
    const Vector here = function(x_);
    const double size = here.cwiseAbs().maxCoeff();
    for (int i = 0; i < n(); ++i) {
      const double h = step_ * std::max(1.0, std::abs(x_[static_cast<std::size_t>(i)]));
      const auto moved = [&](double s) {
        Point to = x_;
        to[static_cast<std::size_t>(i)] += s;
        return function(to);
      };
      const auto central = [&](double s) { return Vector((moved(s) - moved(-s)) / (2.0 * s)); };
      const auto one_sided = [&](double s) {
        return Vector((4.0 * moved(s) - 3.0 * here - moved(2.0 * s)) / (2.0 * s));
      };
      const Vector numeric = (4.0 * central(0.5 * h) - central(h)) / 3.0;
      Vector left, right;
      for (Eigen::Index r = 0; r < numeric.size(); ++r) {
        // A second derivative is compared once, in the lower triangle.
        if (kind == Kind::hessian && r < i) continue;
        const double a = analytic(r, i), allowed = tolerance_ * std::max({1.0, std::abs(a), size});
        if (std::abs(a - numeric[r]) <= allowed) continue;
        if (left.size() == 0) left = one_sided(-0.25 * h), right = one_sided(0.25 * h);
        if (std::min(std::abs(a - left[r]), std::abs(a - right[r])) <= allowed) continue;
        found_.push_back({kind, kind == Kind::gradient ? -1 : static_cast<int>(r), i, a, numeric[r],
                          words(kind, static_cast<int>(r), i, a, numeric[r])});
      }
    }
  }

  std::string words(Kind kind, int row, int column, double analytic, double numeric) const {
    const std::string by = problem_.variable_name(column);
    std::string what;
    switch (kind) {
      case Kind::gradient: what = "gradient by " + by; break;
      case Kind::jacobian: what = "Jacobian of row " + problem_.row_name(row) + " by " + by; break;
      case Kind::hessian: what = "Hessian by " + problem_.variable_name(row) + " and " + by; break;
      case Kind::residual_jacobian: what = fmt::format("Jacobian of residual {} by {}", row + 1, by); break;
    }
    return fmt::format("{}: {:.10g} given, {:.10g} found", what, analytic, numeric);
  }

  const Problem& problem_;
  Point x_, multipliers_;
  double tolerance_, step_;
  std::vector<WrongDerivative> found_;
};

}  // namespace

std::vector<WrongDerivative> check_derivatives(const Problem& problem, std::span<const double> x, double tolerance,
                                               double step) {
  if (static_cast<int>(x.size()) != problem.num_variables()) {
    throw std::invalid_argument(fmt::format("{} values for {} variables", x.size(), problem.num_variables()));
  }
  return Checker(problem, x, tolerance, step).run();
}

}  // namespace accdec::nlp
