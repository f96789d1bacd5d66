#pragma once

#include <memory>
#include <span>
#include <vector>

#include <accdec/design/limit_rows.hpp>

namespace accdec {

/// (a) Smallest corner error at given order and integer delays. Variables B_1 .. B_N, per bounded corner P, Q (leg
/// distances in units of its tolerance; absent when reduced), and sigma:
///   minimise sigma  subject to  |S_j[k_j]|^2 <= sigma E_j^2  and all limits.
/// The variable sigma is (error/tolerance)^2 of the worst corner. So the optimum is <= 1 exactly if these delays are
/// possible, and the solution has the largest margin. Without any error bound, sigma bounds |S_j|^2 in units of 100 um.
/// For fixed k_j everything but power, regeneration and smallest speed is convex.
class MarginProblem : public QuadraticProblem {
 public:
  /// @param options  blend_delays are the delays
  /// @param samples  k_j, the sample at which corner j's error is bounded
  MarginProblem(const Task& task, const FormulationOptions& options, std::span<const int> samples);
  int sigma() const { return sigma_; }
  /// A start: the given filter's cumulative response and what follows from it.
  std::vector<double> start_from(const Filter& filter) const;

 private:
  int order_ = 0, sigma_ = 0;
};

/// A term scale * p(t) or scale * Q(t - d) of a row of `DelayProblem`. With B interpolated linearly, both are 1/2 sum_i
/// b_i (f_i^2 - g_i^2). For Q, f_i = max(t - d - i, 0) and g_i = max(t - d - i - 1, 0). For p, f_i = max(i + 1 - t, 0)
/// and g_i = max(i - t, 0).
struct Approach {
  int row = 0, instant = 0;
  int delay = -1;  ///< variable of Q's d; -1: this is p
  double scale = 0.0;
};

/// (b) Least weighted delay at given order with continuous delays d_j and free instants t_j of closest approach:
///   minimise sum_j w_j d_j  subject to  |S_j(t_j; d_j)|^2 <= E_j^2  and all limits.
/// B is interpolated linearly between samples, which makes S(t) the quadratic B-spline of the sampled path, C1 in t and
/// d. Limits on the blend are imposed at the integer `blend_delays`, which the caller moves. Only axes that both legs
/// move depend on them. Corners with a given delay keep it; corners without an error bound get delay 0.
class DelayProblem : public QuadraticProblem {
 public:
  DelayProblem(const Task& task, const FormulationOptions& options);
  int order() const { return order_; }
  std::vector<double> start_from(const Filter& filter, std::span<const double> delays) const;
  /// d_j of a point, one per corner of the task.
  std::vector<double> delays(std::span<const double> x) const;
  /// The terms that the quadratic part lacks. @throws std::logic_error in the reduced form
  std::vector<Approach> approaches() const;
  /// t_j of a point; -1 for corners without an error bound.
  std::vector<double> instants(std::span<const double> x) const;

  void rows(std::span<const double> x, std::span<double> c) const override;
  void jacobian(std::span<const double> x, std::span<double> values) const override;
  void hessian(std::span<const double> x, double objective_factor, std::span<const double> multipliers,
               std::span<double> values) const override;

 private:
  /// One corner with an error bound. `row_p`, `row_q` define P and Q in the sparse form; `row_error` alone stands in
  /// the reduced one.
  struct Closest {
    std::size_t corner = 0;
    int delay = -1, instant = -1, p = -1, q = -1;  // variables
    int row_p = -1, row_q = -1, row_error = -1;
    double scale_in = 0.0, scale_out = 0.0, cosine = 0.0;  // v1 T/E, v2 T/E, cos(theta)
    std::vector<int> slots_p, slots_q;      // Jacobian: B_1..B_N, then t (and d for Q); reduced: slots_p over B, t, d
    std::vector<int> hessian_t, hessian_d;  // (t, B_i), (d, B_i)
    int hessian_tt = -1, hessian_td = -1, hessian_dd = -1;
  };
  /// Variables of every corner with a closest approach, and the weighted sum of its delays. @return that sum @return
  /// that sum
  Affine add_closest(const Task& task);
  void add_error_rows(Closest& c, const std::string& name, double margin);
  /// Positions of the derivatives, after the problem is finished.
  void find_slots(Closest& c) const;
  int order_ = 0;
  bool reduced_ = false;
  std::vector<Closest> closest_;
  std::vector<double> fixed_delays_;
};

/// Filter of a point of either problem: differences of B_1 .. B_N (the first variables), rounding clipped at zero.
Filter filter_from(std::span<const double> x, int order);

}  // namespace accdec
