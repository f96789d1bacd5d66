#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <fmt/format.h>

#include <accdec/design/row_builder.hpp>

namespace accdec {

template <class OfMotion>
void RowBuilder::supply_rows(const std::string& event, int k, const TaskCorner& corner, bool first,
                             const OfMotion& legs) {
  const Machine& machine = task_.machine;
  const Corner& g = corner.geometry();
  struct Moved {
    Affine force, speed, friction;  // the friction is a power
    bool reverses;
  };
  std::vector<Moved> moved;
  double most = 0.0;
  for (std::size_t a = 0; a < machine.axes.size(); ++a) {
    const Axis& axis = machine.axes[a];
    const double v1 = g.feed_in * g.direction_in[index(a)], v2 = g.feed_out * g.direction_out[index(a)];
    const double last = first ? v1 : v2;
    const auto [in, out, gains_in, gains_out] = legs(motions_[a]);
    const Affine v = v1 * in + last * out;
    if (v.terms.empty() && v.constant == 0.0) continue;
    // Friction takes its force times |V|. If an axis reverses, the speeds of both legs together are no less.
    moved.push_back({axis.mass / period_ * (v1 * gains_in + last * gains_out) + axis.damping * v, v,
                     axis.coulomb * (std::abs(v1) * in + std::abs(last) * out), v1 * v2 < 0.0 && !in.terms.empty()});
    most += largest(moved.back().force) * largest(v) + largest(moved.back().friction);
  }
  const auto add = [&](LimitKind kind, double bound, double sign) {
    if (bound == unlimited || one_ * bound > most) return;
    const int row = problem_.add_row(fmt::format("{}, {}, k = {}", to_string(kind), event, k), {-nlp::infinity, one_});
    for (const Moved& axis : moved) {
      product(row, sign / bound, axis.force, axis.speed);
      if (!(axis.reverses && sign < 0.0)) problem_.add_to_row(row, sign / bound * axis.friction);
    }
  };
  add(LimitKind::power_total, machine.power_total_max, 1.0);
  add(LimitKind::regeneration_total, machine.regeneration_total_max, -1.0);
}

void RowBuilder::supply(const TaskCorner& corner, int delay) {
  if (!limits_supply(task_.machine)) return;
  const std::string at = ", corner " + corner.name;
  using Motion = CumulativeVariables;
  for (int k = 1; k <= longest() + 1; ++k) {
    supply_rows("start" + at, k, corner, true, [&](const Motion& b) {
      return Legs{{}, b.cumulative(k), {}, b.tap(k - 1)};
    });
    supply_rows("stop" + at, k, corner, false, [&](const Motion& b) {
      return Legs{{}, b.remaining(k), {}, -1.0 * b.tap(k - 1)};
    });
  }
  for (int k = 1; k <= longest() + delay + 1; ++k)
    supply_rows("blend" + at, k, corner, false, [&](const Motion& b) {
      return Legs{b.remaining(k), b.cumulative(k - delay), -1.0 * b.tap(k - 1), b.tap(k - 1 - delay)};
    });
}

void RowBuilder::speed(const TaskCorner& corner, int delay) {
  if (corner.speed_min <= 0.0) return;
  const Corner& g = corner.geometry();
  const double least = (1.0 + options_.margin) * (1.0 + options_.margin);
  for (int k = 1; k <= longest() + delay + 1; ++k) {
    const int row =
        problem_.add_row(fmt::format("smallest speed, corner {}, k = {}", corner.name, k), {least, nlp::infinity});
    for (std::size_t a = 0; a < motions_.size(); ++a) {
      const double in = g.feed_in * g.direction_in[index(a)], out = g.feed_out * g.direction_out[index(a)];
      const Affine v =
          1.0 / corner.speed_min * (in * motions_[a].remaining(k) + out * motions_[a].cumulative(k - delay));
      product(row, 1.0, v, v);
    }
  }
}

void RowBuilder::contour(const TaskCorner& corner, int delay, double time) {
  if (!corner.contour_max || !(*corner.contour_max > 0.0)) return;  // a bound of zero is an exact stop
  if (!response_.common()) return contour_of_axes(corner, delay, time);
  const CumulativeVariables& b = motions_.front();
  const int k = static_cast<int>(time);
  const double scale = period_ * std::sin(std::acos(corner.geometry().cos_interior())) / *corner.contour_max;
  const auto row = [&](double feed, const Affine& now, const Affine& next) {
    const Affine gone = scale * feed * ((1.0 - time + k) * now + (time - k) * next);
    affine("contour of corner " + corner.name, gone, {-nlp::infinity, one_});
  };
  row(corner.geometry().feed_out, b.elapsed_moment(k - delay), b.elapsed_moment(k + 1 - delay));
  row(corner.geometry().feed_in, b.remaining_moment(k), b.remaining_moment(k + 1));
}

void RowBuilder::vibration(const Mode& mode, const std::vector<double>& frequencies) {
  if (mode.residual_max >= 1.0 && !mode.of_axis()) return;
  const double fastest = mode.of_axis() ? fastest_leg(task_, mode.axis) : 0.0;
  // A mode of an axis is bounded at starts and stops, and at blends with given delays.
  const auto bound = [&](double f, double damping) {
    if (!mode.of_axis()) return mode.residual_max;
    const double natural = 2.0 * std::numbers::pi * f, damped = natural * std::sqrt(1.0 - damping * damping);
    double most = fastest;
    for (std::size_t j = 0; options_.mode_blends && j < task_.corners.size(); ++j)
      most = std::max(most, legs_together(mode, task_.corners[j], options_.blend_delays[j], damping * natural, damped));
    return mode.displacement_max * damped / most;
  };
  for (const double f : frequencies) {
    for (const double damping : {mode.damping_low, mode.damping_high}) {
      if (bound(f, damping) < 1.0) vibration(bound(f, damping), f, damping);
      if (mode.damping_high == mode.damping_low) break;
    }
  }
}

void RowBuilder::vibration(double bound, double frequency, double damping) {
  const double natural = 2.0 * std::numbers::pi * frequency * period_;
  const double w = natural * std::sqrt(1.0 - damping * damping);
  Affine real, imaginary;
  for (int i = 0; i <= command_.order(); ++i) {
    const double left = std::exp(-damping * natural * (command_.order() - i));
    real += left * std::cos(w * i) * command_.tap(i);
    imaginary += left * std::sin(w * i) * command_.tap(i);
  }
  std::string name = fmt::format("vibration at {:.6g} Hz", frequency);
  if (damping > 0.0) name += fmt::format(", damping {:.6g}", damping);
  if (bound == 0.0) {
    affine(name + ", cosine", real, {0.0, 0.0});
    affine(name + ", sine", imaginary, {0.0, 0.0});
    return;
  }
  if (!options_.reduced) {
    real = defined_variable("C at " + name, real);
    imaginary = defined_variable("S at " + name, imaginary);
  }
  const int row = problem_.add_row(name, {-nlp::infinity, one_ * one_});
  for (const Affine& part : {real, imaginary}) problem_.add_product(row, 1.0 / (bound * bound), part, part);
}

void RowBuilder::symmetry() {
  for (int k = 1; 2 * k <= b_.order() + 1; ++k) {
    affine(fmt::format("symmetry, k = {}", k), b_.cumulative(k) + b_.cumulative(b_.order() + 1 - k), {1.0, 1.0});
  }
}

double RowBuilder::legs_together(const Mode& mode, const TaskCorner& corner, int delay, double decay,
                                 double damped) const {
  const Corner& g = corner.geometry();
  const double v1 = g.feed_in * g.direction_in[mode.axis], v2 = g.feed_out * g.direction_out[mode.axis];
  return std::abs(v2 - v1 * std::exp(std::complex<double>(-decay, -damped) * (delay * period_)));
}

void RowBuilder::contour_of_axes(const TaskCorner& corner, int delay, double time) {
  const Corner& g = corner.geometry();
  for (int k = 0; k <= longest() + delay + 1; ++k) {
    const Eigen::VectorXd &along = k <= time ? g.direction_in : g.direction_out,
                          &other = k <= time ? g.direction_out : g.direction_in;
    const Eigen::VectorXd across = other - other.dot(along) * along;
    if (!(across.norm() > 1e-9)) continue;  // legs along one line
    Affine off;
    for (Eigen::Index a = 0; a < along.size(); ++a) {
      const CumulativeVariables& b = motions_[static_cast<std::size_t>(a)];
      const double part = period_ * across[a] / across.norm() / *corner.contour_max;
      off += part * g.feed_out * g.direction_out[a] * b.elapsed_moment(k - delay);
      off += -part * g.feed_in * g.direction_in[a] * b.remaining_moment(k);
    }
    affine("contour of corner " + corner.name, off, {-one_, one_});
  }
}

double contour_time(const Filter& motion, const Corner& corner, int delay) {
  const auto ahead = [&](int k) {
    return corner.feed_in * motion.remaining_moment(k) - corner.feed_out * motion.elapsed_moment(k - delay);
  };
  int k = 0;
  while (k < motion.order() + delay && ahead(k + 1) > 0.0) ++k;
  const double before = ahead(k), after = ahead(k + 1);
  return before > after ? k + std::clamp(before / (before - after), 0.0, 1.0) : k;
}

}  // namespace accdec
