#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/Core>
#include <fmt/format.h>

#include <accdec/instances/cone_rows.hpp>

namespace accdec::instances {
namespace {

[[noreturn]] void not_convex(const Instance::Row& row) {
  throw std::invalid_argument(fmt::format("row \"{}\" is not convex: no cone holds it", row.name));
}

/// Affine forms whose squares add up to x' Q x, by Gaussian elimination; empty if Q has a negative direction.
std::vector<Affine> squares(Eigen::MatrixXd q, const std::vector<int>& variables) {
  const double zero = 1e-14 * std::max(1e-300, q.cwiseAbs().maxCoeff());
  std::vector<Affine> parts;
  for (Eigen::Index i = 0; i < q.rows(); ++i) {
    const Eigen::VectorXd column = q.col(i);
    if (column(i) <= zero) {
      if (column(i) < -zero || column.cwiseAbs().maxCoeff() > zero) return {};
      continue;
    }
    const double root = std::sqrt(column(i));
    Affine part;
    for (Eigen::Index j = i; j < q.rows(); ++j) {
      if (std::abs(column(j)) > zero) part.add(variables[static_cast<std::size_t>(j)], column(j) / root);
    }
    parts.push_back(std::move(part));
    q -= column * column.transpose() / column(i);
  }
  return parts;
}

}  // namespace

bool nonlinear(const Instance::Row& row) {
  return !row.body.products.empty() || !row.approaches.empty();
}

ConvexRow convex_row(const Instance::Row& row) {
  if (!row.approaches.empty() || std::isfinite(row.bound.lower) == std::isfinite(row.bound.upper)) not_convex(row);
  const double sign = std::isfinite(row.bound.upper) ? 1.0 : -1.0;
  std::vector<int> variables;
  for (const auto& p : row.body.products) variables.insert(variables.end(), {p.first, p.second});
  std::sort(variables.begin(), variables.end());
  variables.erase(std::unique(variables.begin(), variables.end()), variables.end());
  const auto place = [&](int variable) {
    return std::lower_bound(variables.begin(), variables.end(), variable) - variables.begin();
  };
  const auto n = static_cast<Eigen::Index>(variables.size());
  Eigen::MatrixXd q = Eigen::MatrixXd::Zero(n, n);
  for (const auto& p : row.body.products) {
    q(place(p.first), place(p.second)) += 0.5 * sign * p.coefficient;
    q(place(p.second), place(p.first)) += 0.5 * sign * p.coefficient;
  }
  ConvexRow convex;
  convex.parts = squares(q, variables);
  if (convex.parts.empty()) not_convex(row);
  convex.slack = -sign * row.body.affine;
  convex.slack.constant += sign * (sign > 0.0 ? row.bound.upper : row.bound.lower);
  return convex;
}

}  // namespace accdec::instances
