#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <vector>

#include <accdec/bounds/bound_rows.hpp>
#include <accdec/bounds/corner_bound.hpp>

namespace accdec {
namespace {

/// The linear program of one corner, columns in [0, 1], costs -1 each. Column k is the speed of leg 1 in period k over
/// its highest, column count + k that of leg 2; the corner's moment is the beginning of period `before`.
class CornerLinearProgram {
 public:
  CornerLinearProgram(const BoundCorner& corner, const Machine& machine, std::size_t dimensions, double period)
      : corner_(corner),
        dimensions_(dimensions),
        period_(period),
        before_(static_cast<int>(std::ceil(corner.reach_in / period))),
        count_(before_ + static_cast<int>(std::ceil(corner.reach_out / period))),
        rows_(2 * count_) {
    for (std::size_t a = 0; a < dimensions; ++a) {
      add_differences(a, {1.0, -1.0}, acceleration_most(machine.axes[a]) * period);
      add_differences(a, {1.0, -2.0, 1.0}, machine.axes[a].jerk_max * period * period);
    }
    add_feed();
    add_tolerance();
  }

  CornerDual loss() const {
    CornerDual loss;
    loss.period = period_;
    const auto columns = static_cast<std::size_t>(2 * count_);
    const std::vector<double> zeros(columns, 0.0), ones(columns, 1.0), costs(columns, -1.0);
    const BoundRows::Multipliers found = rows_.multipliers(costs, zeros, ones);
    loss.sides = found.sides;
    loss.in.assign(found.part.begin(), found.part.begin() + count_);
    loss.out.assign(found.part.begin() + count_, found.part.end());
    return loss;
  }

 private:
  /// |sum of both legs' differences of the speed of axis a| <= most, inside the window. Its ends are left free.
  void add_differences(std::size_t a, const std::vector<double>& difference, double most) {
    if (!(most < unlimited)) return;
    const double in = corner_.in[a] * corner_.speed_in, out = corner_.out[a] * corner_.speed_out;
    if (in == 0.0 && out == 0.0) return;
    const int length = static_cast<int>(difference.size());
    for (int k = length - 1; k < count_; ++k) {
      std::vector<std::pair<int, double>> entries;
      for (int i = 0; i < length; ++i) {
        const double factor = difference[static_cast<std::size_t>(i)] / most;
        if (in != 0.0) entries.emplace_back(k - i, in * factor);
        if (out != 0.0) entries.emplace_back(count_ + k - i, out * factor);
      }
      rows_.add(entries, -1.0, 1.0);
    }
  }

  /// Both legs together are not faster than the feed, in the direction between them.
  void add_feed() {
    double cosine = 0.0;
    for (std::size_t a = 0; a < dimensions_; ++a) cosine += corner_.in[a] * corner_.out[a];
    const double half = std::sqrt(std::max(0.0, 0.5 * (1.0 + cosine))), feed = corner_.feed;
    for (int k = 0; k < count_ && half > 0.5; ++k) {
      rows_.add({{k, half * corner_.speed_in / feed}, {count_ + k, half * corner_.speed_out / feed}}, -BoundRows::none,
                1.0);
    }
  }

  /// -p u1 + q u2 is within the tolerance. At the moment p is the distance left on leg 1, and q the distance gone on
  /// leg 2.
  void add_tolerance() {
    double cosine = 0.0;
    for (std::size_t a = 0; a < dimensions_; ++a) cosine += corner_.in[a] * corner_.out[a];
    cosine = std::clamp(cosine, -1.0, 1.0);
    const double sine = std::sqrt(1.0 - cosine * cosine);
    constexpr int sides = 32;
    // In units of the tolerance; an exact corner keeps a thousandth of a micrometre.
    const double tolerance = std::max(corner_.tolerance, 1e-9);
    for (int i = 0; i < sides; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / sides, x = std::cos(angle), y = std::sin(angle);
      const double along_in = -x, along_out = cosine * x + sine * y;
      std::vector<std::pair<int, double>> entries;
      for (int k = before_; k < count_; ++k) entries.emplace_back(k, along_in * corner_.speed_in * period_ / tolerance);
      for (int k = 0; k < before_; ++k) {
        entries.emplace_back(count_ + k, along_out * corner_.speed_out * period_ / tolerance);
      }
      rows_.add(entries, -BoundRows::none, 1.0);
    }
  }

  const BoundCorner& corner_;
  const std::size_t dimensions_;
  const double period_;
  const int before_, count_;
  BoundRows rows_;
};

}  // namespace

double acceleration_most(const Axis& axis) {
  double most = axis.acceleration_max;
  if (axis.force_max < unlimited && axis.mass > 0.0 && (axis.damping == 0.0 || axis.velocity_max < unlimited)) {
    // Friction helps to brake.
    const double friction = axis.coulomb + (axis.damping == 0.0 ? 0.0 : axis.damping * axis.velocity_max);
    most = std::min(most, (axis.force_max + friction) / axis.mass);
  }
  return most;
}

Machine without_jerk_limits(Machine machine) {
  for (Axis& axis : machine.axes) axis.jerk_max = unlimited;
  return machine;
}

SplineSlack spline_slack(const Machine& machine, double sample_period) {
  double acceleration2 = 0.0;
  bool jerk = false;
  for (const Axis& axis : machine.axes) {
    double most = acceleration_most(axis);
    if (axis.jerk_max < unlimited) {
      jerk = true;
      if (axis.velocity_max < unlimited) most = std::min(most, 2.0 * std::sqrt(axis.velocity_max * axis.jerk_max));
    }
    acceleration2 += most * most;
  }
  return {std::sqrt(acceleration2) * sample_period * sample_period / (jerk ? 6.0 : 8.0),
          (jerk ? 2.0 : 1.0) * sample_period};
}

double CornerDual::at(double of_in, double of_out) const {
  // The columns x lie in [0, c] with costs -1/c, where c = of_in or of_out; the multipliers are s times the given ones.
  // Then sum (1 - x/c) is at least (number of columns) + s sides - sum of max(0, 1 + c s part). For speeds with a
  // common factor c, s = 1/c is exact.
  double best = -unlimited;
  for (const double part_in : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    const double c = std::pow(of_in, part_in) * std::pow(of_out, 1.0 - part_in);
    double lost = static_cast<double>(in.size()) + sides / c;
    for (const double part : in) lost -= std::max(0.0, 1.0 + part * (of_in / c));
    for (const double part : out) lost -= std::max(0.0, 1.0 + part * (of_out / c));
    best = std::max(best, lost);
    if (of_in == of_out) break;
  }
  return period * best;
}

CornerDual corner_loss(const BoundCorner& corner, const Machine& machine, std::size_t dimensions, int periods) {
  const double period = (corner.reach_in + corner.reach_out) / periods;
  return CornerLinearProgram(corner, machine, dimensions, period).loss();
}

}  // namespace accdec
