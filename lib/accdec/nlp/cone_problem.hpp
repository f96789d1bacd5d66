#pragma once

#include <vector>

#include <accdec/problem.hpp>

namespace accdec::nlp {

/// A second-order cone program as ECOS, CVXOPT, SCS and Clarabel take it:
///   minimise c'x  subject to  A x = b,  h - G x in K,
///   K = R_+^linear x Q_{n1} x Q_{n2} x ..,  Q_n = {(t, u) in R x R^{n-1} : |u| <= t}.
struct ConeData {
  struct Coefficient {
    int row = 0, column = 0;
    double value = 0.0;
  };
  std::vector<double> c, b, h;
  std::vector<Coefficient> a, g;  ///< of A and G; places may repeat, their values add up
  int linear = 0;                 ///< the first rows of G
  std::vector<int> cones;         ///< n1, n2, .. >= 2: the rows after those
};

/// Such a program as a problem for any solver of the registry: a cone becomes |u|^2 - t^2 <= 0 and t >= 0. A solver
/// that takes cones gets the data by `dynamic_cast<const ConeProblem*>(&problem)`. It needs nothing else but its own
/// file.
class ConeProblem : public Problem {
 public:
  /// @throws std::invalid_argument if the sizes do not match
  explicit ConeProblem(ConeData data);
  const ConeData& data() const { return data_; }

  /// h - G x; the part of each cone must lie in the cone.
  std::vector<double> slacks(std::span<const double> x) const;

  std::string name() const override { return "second-order cone program"; }
  int num_variables() const override { return static_cast<int>(data_.c.size()); }
  /// The rows of A, the linear rows of G, and two per cone.
  int num_rows() const override;
  Bound variable_bound(int) const override { return {}; }
  Bound row_bound(int i) const override;
  ProblemClass problem_class() const override {
    return data_.cones.empty() ? ProblemClass::linear : ProblemClass::general;
  }
  double objective(std::span<const double> x) const override;
  void gradient(std::span<const double> x, std::span<double> g) const override;
  void rows(std::span<const double> x, std::span<double> c) const override;
  const std::vector<Entry>& jacobian_pattern() const override { return pattern_; }
  void jacobian(std::span<const double> x, std::span<double> values) const override;
  bool has_hessian() const override { return false; }
  const std::vector<Entry>& hessian_pattern() const override { return no_hessian_; }
  void hessian(std::span<const double>, double, std::span<const double>, std::span<double>) const override {}

 private:
  /// Where a coefficient goes in the Jacobian.
  struct Place {
    int slot;
    int slack;  ///< >= 0: times this one; else as it is
    double value;
  };
  int first_cone_row() const { return static_cast<int>(data_.b.size()) + data_.linear; }

  ConeData data_;
  std::vector<Entry> pattern_, no_hessian_;
  std::vector<Place> places_;
};

}  // namespace accdec::nlp
