#include <algorithm>
#include <cmath>

#include <accdec/exact/contour_path.hpp>

namespace accdec::exact {
namespace {

/// Times this close to an end of their range, in samples, are not split off.
constexpr double closest = 1e-7;
/// Relative part by which the linear program may miss the tolerance.
constexpr double rounding = 1e-9;

}  // namespace

ContourPath::ContourPath(const LimitModel& model, const Filter& filter, std::size_t j)
    : behind_(filter, model.task().machine, model.task().sample_period),
      filter_(behind_.motion()),
      in_(model.scale_in(j)),
      out_(model.scale_out(j)),
      bound_(model.contour_bound(j)) {}

double ContourPath::left(double time) const {
  const double k = std::floor(time);
  const double here = filter_.remaining_moment(static_cast<int>(k)),
               next = filter_.remaining_moment(static_cast<int>(k) + 1);
  return in_ * (here + (time - k) * (next - here));
}

double ContourPath::gone(double time) const {
  const double m = std::floor(time);
  const double here = filter_.elapsed_moment(static_cast<int>(m)),
               next = filter_.elapsed_moment(static_cast<int>(m) + 1);
  return out_ * (here + (time - m) * (next - here));
}

double ContourPath::crossing(int delay, const CornerBox& range) const {
  double low = range.c1, high = range.c2;
  for (int i = 0; i < 80 && low < high; ++i) {
    const double middle = 0.5 * (low + high);
    (left(middle) > gone(middle - delay) ? low : high) = middle;
  }
  return high;
}

double ContourPath::missed(int delay, double time) const {
  return std::max(left(time), gone(time - delay)) - bound_;
}

std::optional<MissedContour> missed_contour(const LimitModel& model, const Filter& filter, const Box& box) {
  std::optional<MissedContour> most;
  for (std::size_t j = 0; j < box.corners.size() && box.contour_rows(); ++j) {
    if (!model.contour(j)) continue;
    const CornerBox& c = box.corners[j];
    const ContourPath path(model, filter, j);
    const double at = path.crossing(c.d2, c), by = path.missed(c.d2, at);
    if (by <= rounding * model.contour_bound(j) || at - c.c1 < closest || c.c2 - at < closest) continue;
    if (!most || by > most->by) most = MissedContour{static_cast<int>(j), at, by};
  }
  return most;
}

bool contour_holds(const LimitModel& model, const Filter& filter, const Box& box, std::size_t j, int delay) {
  if (!model.contour(j) || !box.contour_rows()) return true;
  const ContourPath path(model, filter, j);
  return path.missed(delay, path.crossing(delay, box.corners[j])) <= rounding * model.contour_bound(j);
}

Box at_crossings(const LimitModel& model, const Filter& filter, Box box) {
  for (std::size_t j = 0; j < box.corners.size(); ++j) {
    if (!model.contour(j)) continue;
    CornerBox& c = box.corners[j];
    c.c1 = c.c2 = ContourPath(model, filter, j).crossing(c.d1, c);
  }
  return box;
}

}  // namespace accdec::exact
