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
  /// The least sigma with which the errors of a point hold. @param x  its own sigma does not matter
  double least_sigma(std::span<const double> x) const;
  /// A start: the given filter's cumulative response and what follows from it.
  std::vector<double> start_from(const Filter& filter) const;

 private:
  /// Adds the squares of one corner's distance to a row, axis by axis: behind different servos the legs bend. @return
  /// their largest value
  double add_axes(int row, const CumulativeVariables& b, const Task& task, const TaskCorner& corner, int sample,
                  int delay, double unit);
  int order_ = 0, sigma_ = 0;
  bool reduced_ = false;
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
/// move depend on them. Behind a response B is that of the motion. If axes respond differently, S(t) has a row for
/// every axis. Corners with a given delay keep it; corners without an error bound get delay 0.
class DelayProblem : public QuadraticProblem {
 public:
  DelayProblem(const Task& task, const FormulationOptions& options);
  int order() const { return order_; }
  bool ideal() const { return ideal_; }  ///< no response of the machine behind the taps
  std::vector<double> start_from(const Filter& filter, std::span<const double> delays) const;
  /// d_j of a point, one per corner of the task.
  std::vector<double> delays(std::span<const double> x) const;
  /// The terms that the quadratic part lacks. @throws std::logic_error in the reduced form and behind a response
  std::vector<Approach> approaches() const;
  /// t_j of a point; -1 for corners without an error bound.
  std::vector<double> instants(std::span<const double> x) const;

  void rows(std::span<const double> x, std::span<double> c) const override;
  void jacobian(std::span<const double> x, std::span<double> values) const override;
  void hessian(std::span<const double> x, double objective_factor, std::span<const double> multipliers,
               std::span<double> values) const override;

 private:
  /// in * p(t) + out * Q(t - d), of the motion behind these taps. `row` defines its variable in the sparse form; in the
  /// reduced one there is only the row of the error.
  struct Part {
    std::vector<double> response;
    double in = 0.0, out = 0.0;
    int variable = -1, row = -1;
    std::vector<int> slots;  // Jacobian: B_1..B_N, then t and d
  };
  /// One corner with an error bound. Its distance squared, in units of the bound, is the sum of the squares of its
  /// parts and 2 cosine times the product of the first two. These are P and Q, or one an axis, with a cosine of 0.
  struct Closest {
    std::size_t corner = 0;
    int delay = -1, instant = -1, row_error = -1;          // variables, row
    double scale_in = 0.0, scale_out = 0.0, cosine = 0.0;  // v1 T/E, v2 T/E, cos(theta)
    std::vector<Part> parts;
    std::vector<int> hessian_t, hessian_d;  // (t, B_i), (d, B_i)
    int hessian_tt = -1, hessian_td = -1, hessian_dd = -1;
  };
  /// Variables of every corner with a closest approach, and the weighted sum of its delays. @return
  /// that sum
  Affine add_closest(const Task& task);
  std::vector<Part> parts_of(const Task& task, const Corner& corner, const Closest& c) const;
  void add_error_rows(Closest& c, const Task& task, double margin);
  std::vector<double> part_values(std::span<const double> x, const Closest& c) const;
  /// Positions of the derivatives, after the problem is finished.
  void find_slots(Closest& c) const;
  int order_ = 0, motion_order_ = 0;
  bool reduced_ = false, ideal_ = true, common_ = true;
  std::vector<Closest> closest_;
  std::vector<double> fixed_delays_;
};

/// Filter of a point of either problem: differences of B_1 .. B_N (the first variables), rounding clipped at zero.
Filter filter_from(std::span<const double> x, int order);

}  // namespace accdec
