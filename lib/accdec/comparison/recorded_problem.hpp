#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <vector>

#include <accdec/problem.hpp>

namespace accdec::comparison {

/// A problem that records the points at which its objective was evaluated. They can then be judged by another measure
/// after the run instead of during it. Not thread-safe: for one run of one solver.
class RecordedProblem final : public nlp::Problem {
 public:
  /// Objective of a point if it holds everything, infinite otherwise.
  using Judge = std::function<double(const std::vector<double>&)>;

  /// The clock starts here. Keeps a reference: `problem` must outlive the object.
  /// @param most_bytes  memory for points; when it is full they are judged at once, which costs time of the run
  RecordedProblem(const nlp::Problem& problem, Judge judge, std::size_t most_bytes = 64'000'000);

  const nlp::Problem& recorded() const { return problem_; }
  /// Every new best point by the judge, in order. Judges the points not judged yet.
  const std::vector<nlp::Improvement>& history();
  /// The last of these; empty if there is none.
  const std::vector<double>& best() const { return best_; }
  double best_objective() const { return best_objective_; }

  std::string name() const override { return problem_.name(); }
  int num_variables() const override { return problem_.num_variables(); }
  int num_rows() const override { return problem_.num_rows(); }
  nlp::Bound variable_bound(int i) const override { return problem_.variable_bound(i); }
  nlp::Bound row_bound(int i) const override { return problem_.row_bound(i); }
  bool is_integer(int i) const override { return problem_.is_integer(i); }
  std::string variable_name(int i) const override { return problem_.variable_name(i); }
  std::string row_name(int i) const override { return problem_.row_name(i); }
  nlp::ProblemClass problem_class() const override { return problem_.problem_class(); }
  double objective(std::span<const double> x) const override;
  void gradient(std::span<const double> x, std::span<double> g) const override { problem_.gradient(x, g); }
  void rows(std::span<const double> x, std::span<double> c) const override;
  const std::vector<nlp::Entry>& jacobian_pattern() const override { return problem_.jacobian_pattern(); }
  void jacobian(std::span<const double> x, std::span<double> values) const override { problem_.jacobian(x, values); }
  bool has_hessian() const override { return problem_.has_hessian(); }
  const std::vector<nlp::Entry>& hessian_pattern() const override { return problem_.hessian_pattern(); }
  void hessian(std::span<const double> x, double objective_factor, std::span<const double> multipliers,
               std::span<double> values) const override {
    problem_.hessian(x, objective_factor, multipliers, values);
  }
  int num_residuals() const override { return problem_.num_residuals(); }
  void residuals(std::span<const double> x, std::span<double> r) const override { problem_.residuals(x, r); }
  void residual_jacobian(std::span<const double> x, std::span<double> values) const override {
    problem_.residual_jacobian(x, values);
  }

 private:
  struct Point {
    std::int64_t evaluations;
    double time;
    std::vector<double> x;
  };
  void judge_points() const;

  const nlp::Problem& problem_;
  Judge judge_;
  std::size_t most_points_;
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  // Solvers see problems as const; the recorded points are not part of the problem.
  mutable std::int64_t objectives_ = 0, rows_ = 0;
  mutable std::vector<Point> points_;
  mutable std::vector<nlp::Improvement> history_;
  mutable std::vector<double> best_;
  mutable double best_objective_ = nlp::infinity;
};

}  // namespace accdec::comparison
