#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include <accdec/machine/blend_behind.hpp>

namespace accdec {
namespace {

/// A point or velocity of a few axes, without the heap.
using Point = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 9, 1>;

/// A blend whose axes have a filter each.
class AxesBlend {
 public:
  AxesBlend(const FilterBehind& behind, const Corner& corner, int delay, double period)
      : behind_(behind), corner_(corner), delay_(delay), period_(period) {}

  int last() const { return behind_.longest_order() + delay_ + 1; }
  Point position(int k) const {
    return each([&](const Filter& f, double in, double out) {
      return period_ * (out * f.elapsed_moment(k - delay_) - in * f.remaining_moment(k));
    });
  }
  Point velocity(int k) const {
    return each(
        [&](const Filter& f, double in, double out) { return in * f.remaining(k) + out * f.cumulative(k - delay_); });
  }
  double to_leg_in(const Point& s) const { return to_ray(s, -corner_.direction_in); }
  double to_leg_out(const Point& s) const { return to_ray(s, corner_.direction_out); }

 private:
  template <class Value>
  Point each(const Value& value) const {
    Point p(corner_.axes());
    for (Eigen::Index a = 0; a < p.size(); ++a)
      p[a] = value(behind_.motion(static_cast<std::size_t>(a)), corner_.feed_in * corner_.direction_in[a],
                   corner_.feed_out * corner_.direction_out[a]);
    return p;
  }
  static double to_ray(const Point& s, const Point& along) { return (s - std::max(0.0, s.dot(along)) * along).norm(); }

  const FilterBehind& behind_;
  const Corner& corner_;
  int delay_;
  double period_;
};

/// Largest distance from the nearer leg on a chord at whose ends different legs are nearer. Both distances are convex
/// along the chord, so it is where they are equal.
double between(const AxesBlend& blend, const Point& from, const Point& to) {
  const auto ahead = [&](double t) {
    const Point s = from + t * (to - from);
    return blend.to_leg_in(s) - blend.to_leg_out(s);
  };
  double low = 0.0, high = 1.0;
  const bool first = ahead(0.0) < 0.0;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    ((ahead(middle) < 0.0) == first ? low : high) = middle;
  }
  return blend.to_leg_in(from + low * (to - from));
}

double from_origin(const Point& from, const Point& to) {
  const Point step = to - from;
  const double length2 = step.squaredNorm();
  const double t = length2 > 0.0 ? std::clamp(-from.dot(step) / length2, 0.0, 1.0) : 0.0;
  return (from + t * step).norm();
}

}  // namespace

namespace {

/// Distance of a point from the line.
double off(const Point& point, const Eigen::VectorXd& direction) {
  return (point - point.dot(direction) * direction).norm();
}

}  // namespace

double off_line(const FilterBehind& behind, const Eigen::VectorXd& direction, double step) {
  Point lag = step * direction;
  for (Eigen::Index a = 0; a < lag.size(); ++a) lag[a] *= behind.motion(static_cast<std::size_t>(a)).mean_delay();
  return off(lag, direction);
}

double off_line_after(const FilterBehind& behind, const Eigen::VectorXd& direction, double step, int k) {
  Point gone = step * direction;
  for (Eigen::Index a = 0; a < gone.size(); ++a)
    gone[a] *= behind.motion(static_cast<std::size_t>(a)).elapsed_moment(k);
  return off(gone, direction);
}

CornerMeasures measure(const FilterBehind& behind, const Corner& corner, int delay, double sample_period) {
  if (!behind.differs()) return measure(Blend(behind.motion(), corner, delay, sample_period));
  const AxesBlend blend(behind, corner, delay, sample_period);
  Point before = blend.position(0);
  CornerMeasures m;
  m.corner_error = m.polyline_error = before.norm();
  m.speed_min = blend.velocity(0).norm();
  m.contour_deviation = std::max({std::min(blend.to_leg_in(before), blend.to_leg_out(before)),
                                  off_line(behind, corner.direction_in, corner.feed_in * sample_period),
                                  off_line(behind, corner.direction_out, corner.feed_out * sample_period)});
  for (int k = 1; k <= blend.last(); ++k) {
    const Point here = blend.position(k);
    const double error = here.norm(), speed = blend.velocity(k).norm();
    if (error < m.corner_error) m.corner_error = error, m.corner_error_sample = k;
    if (speed < m.speed_min) m.speed_min = speed, m.speed_min_sample = k;
    m.polyline_error = std::min(m.polyline_error, from_origin(before, here));
    const double in = blend.to_leg_in(here), out = blend.to_leg_out(here);
    m.contour_deviation = std::max(m.contour_deviation, std::min(in, out));
    if ((blend.to_leg_in(before) < blend.to_leg_out(before)) != (in < out))
      m.contour_deviation = std::max(m.contour_deviation, between(blend, before, here));
    before = here;
  }
  return m;
}

double corner_error(const FilterBehind& behind, const Corner& corner, int delay, double sample_period) {
  if (!behind.differs()) return corner_error(Blend(behind.motion(), corner, delay, sample_period));
  const AxesBlend blend(behind, corner, delay, sample_period);
  double least = blend.position(0).norm();
  for (int k = 1; k <= blend.last(); ++k) least = std::min(least, blend.position(k).norm());
  return least;
}

}  // namespace accdec
