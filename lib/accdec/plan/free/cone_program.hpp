#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <accdec/simulate.hpp>

namespace accdec {

/// A value of an axis that is a sum of few unknowns: `constant` plus coefficients times unknowns.
struct LinearForm {
  double constant = 0.0;
  int count = 0;
  std::array<int, 5> unknown{};
  std::array<double, 5> coefficient{};
  void add(int index, double factor);
};

/// A point that is a sum of up to two samples and a shift along one direction: |constant + w0 x0 + w1 x1 + z shift|.
/// Samples are named by their first unknown; -1: none.
struct LinearPoint {
  std::array<double, program_axis_count> constant{}, shift{};
  std::array<int, 2> sample{-1, -1};
  std::array<double, 2> weight{};
  bool shifted = false;  ///< `shift` times the last unknown is part of it
};

/// Convex program over positions ordered by sample. The last unknown is made as large as possible. Forms are bounded
/// by |form| <= 1, points lie within a radius of a segment. All Newton steps are banded: forms and points may
/// only join unknowns at most `band` apart.
///
/// Primal-dual interior point after Mehrotra (S. Boyd, L. Vandenberghe: Convex Optimization, 11.7), started from
/// any guess.
class ConeProgram {
 public:
  /// @param unknowns  positions of samples one after another, `dimensions` each, and the one that is maximised
  ConeProgram(std::size_t unknowns, std::size_t dimensions, std::size_t band);

  /// |form| <= 1
  void bound(const LinearForm& form) { rows_.push_back({form, {}, {}, {}, {}, 0.0}); }
  /// The point lies within `radius` > 0 of the segment from a to b.
  void within(const LinearPoint& point, const double* a, const double* b, double radius);

  /// @param z  the guess; becomes the answer  @param maximise  else any point within the bounds
  /// @returns whether all bounds hold to 5e-8 and nothing better is left
  bool solve(std::vector<double>& z, bool maximise);
  int iterations() const { return iterations_; }

 private:
  struct Row {
    LinearForm form;
    std::array<double, 2> slack, dual, dslack, ddual;  // of the upper and of the lower bound
    double value;
  };
  struct Ball {
    LinearPoint point;
    std::array<double, program_axis_count> a, along;  // the segment begins in a; its direction
    double length, scale;                             // of the segment; 1/radius
    double slack, dual, dslack, ddual, value;         // value: (distance^2/radius^2 - 1)/2
    std::array<double, program_axis_count> gradient;  // with respect to the point
    bool beside;                                      // nearest to the inside of the segment
  };

  void evaluate(const std::vector<double>& z);
  void start();
  double gap() const;
  double violation() const;
  void assemble();
  bool factor();
  void solve_factored(std::vector<double>& x) const;
  void newton(double centre, bool second_order, bool maximise);
  double step_length() const;
  double ball_change(const Ball& ball, const std::vector<double>& d) const;
  void add_ball_gradient(const Ball& ball, double factor, std::vector<double>& to) const;
  void assemble_ball(const Ball& ball);
  double& entry(int i, int j) { return i >= j ? at(i, j) : at(j, i); }
  double& at(int i, int j) {
    return matrix_[static_cast<std::size_t>(i) * (band_ + 1) + static_cast<std::size_t>(i - j)];
  }

  std::size_t unknowns_, n_, band_;
  std::vector<Row> rows_;
  std::vector<Ball> balls_;
  std::vector<double> matrix_, step_;
  int iterations_ = 0;
};

}  // namespace accdec
