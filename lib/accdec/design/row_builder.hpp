#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <accdec/design/limit_rows.hpp>
#include <accdec/machine/limits.hpp>

// Internal to this folder: the rows of a task's limits, one kind after another.

namespace accdec {

class RowBuilder {
 public:
  RowBuilder(QuadraticProblem& problem, const CumulativeVariables& b, const Task& task,
             const FormulationOptions& options);

  void taps();
  /// A limit on the n-th difference of the acceleration, at start and stop of the fastest leg.
  void ramp(const AxisLimit& limit, int n);
  /// Start and stop of one axis at the task's largest speeds.
  void start_and_stop(std::size_t a);
  /// Blend of one corner on an axis that both legs move.
  void blend(std::size_t a, const TaskCorner& corner, int delay);
  /// The supply that all axes share, while a corner's leg 1 starts, its legs meet, and leg 2 stops.
  void supply(const TaskCorner& corner, int delay);
  void speed(const TaskCorner& corner, int delay);
  /// The path is near leg 1 before the time, near leg 2 after it.
  void contour(const TaskCorner& corner, int delay, double time);
  void vibration(const Mode& mode, const std::vector<double>& frequencies);
  void vibration(double bound, double frequency, double damping);
  void symmetry();

 private:
  static Eigen::Index index(std::size_t a) { return static_cast<Eigen::Index>(a); }
  static Affine dry(const Axis& axis) { return {axis.coulomb, {}}; }
  /// Order of the longest motion.
  int longest() const {
    int order = command_.order();
    for (const CumulativeVariables& motion : motions_) order = std::max(order, motion.order());
    return order;
  }

  /// Speed that the legs of a blend give a mode together, with their phase. @param decay, damped  1/s
  double legs_together(const Mode& mode, const TaskCorner& corner, int delay, double decay, double damped) const;

  /// If axes respond differently: the distance from the line of leg 1 up to the time, from that of leg 2 behind it.
  void contour_of_axes(const TaskCorner& corner, int delay, double time);

  /// Parts of both legs' velocities at one sample, and their changes since the sample before.
  struct Legs {
    Affine in, out, gains_in, gains_out;
  };
  /// Rows of the total power at one sample.
  /// @param legs  behind the response of an axis  @param first  its `out` is of leg 1: the start
  template <class OfMotion>
  void supply_rows(const std::string& event, int k, const TaskCorner& corner, bool first, const OfMotion& legs);

  /// The n-th difference of a sequence. @param ago  its value j samples ago
  template <class Sequence>
  static Affine difference(int n, const Sequence& ago) {
    Affine sum = ago(0);
    for (int j = 1; j <= n; ++j) sum += difference_weight(n, j) * ago(j);
    return sum;
  }

  void affine(std::string name, const Affine& value, nlp::Bound bound);

  /// The largest tap that the acceleration allows, before the control's smoothing.
  double tap_max() const;
  /// Largest size of a form for any taps. Without a response, rows are short, and this is not asked.
  double largest(const Affine& form) const;

  /// row += coefficient * left * right
  void product(int row, double coefficient, Affine left, Affine right);

  /// A new variable equal to an affine form, so that dense forms appear only in linear rows.
  Affine defined_variable(const std::string& name, const Affine& value);

  /// Row for one limit of one axis at one sample, scaled to +-1. None if the axis has no such limit. `quantity` is the
  /// bounded value, or the force of a power at the given speed.
  void bounded(const Axis& axis, const std::string& event, int k, LimitKind kind, const Affine& quantity,
               const Affine& speed = {1.0, {}});

  /// Rows of the lines of a force-speed curve. @param direction  sign of the speed that counts
  void along_curve(const Axis& axis, const std::string& event, int k, const Affine& force, const Affine& speed,
                   double direction);

  QuadraticProblem& problem_;
  const CumulativeVariables& b_;
  const Task& task_;
  const FormulationOptions& options_;
  double period_, one_;
  Response response_;
  double tap_max_;
  CumulativeVariables command_;
  std::vector<CumulativeVariables> motions_;  // of each axis
};

}  // namespace accdec
