#include <algorithm>
#include <cmath>

#include <accdec/bounds/corner_bound.hpp>
#include <accdec/bounds/plane_bound.hpp>

namespace accdec {
namespace {

double length_of(const PlaneLeg& leg) {
  return leg.way / dot(leg.tube.pace, leg.tube.direction);
}
/// m/s of a motion along it.
double feed_of(const PlaneLeg& leg) {
  return 1.0 / dot(leg.tube.pace, leg.tube.direction);
}
/// The least that a motion saves at a corner by cutting it, against the pace, s.
double cut(const PlaneLeg& in, const PlaneLeg& out) {
  return norm(combined(1.0, in.tube.pace, -1.0, out.tube.pace)) * in.tolerance;
}
AxisVector scaled(const AxisVector& v, double factor) {
  return combined(factor, v, 0.0, v);
}
/// The normal of planes on which the way at the pace is the same.
AxisVector pace_normal(const PlaneLeg& leg) {
  return scaled(leg.tube.pace, 1.0 / dot(leg.tube.pace, leg.tube.direction));
}

}  // namespace

double PlaneBound::acceleration_along(const AxisVector& direction) const {
  double least = unlimited;
  for (std::size_t a = 0; a < n_; ++a) {
    if (direction[a] != 0.0) least = std::min(least, acceleration_most(machine_.axes[a]) / std::abs(direction[a]));
  }
  return least;
}

/// The speed of a corner passed at constant acceleration within its tolerance.
double PlaneBound::corner_speed(const PlaneLeg& in, const PlaneLeg& out) const {
  const double feed = std::min(feed_of(in), feed_of(out));
  const AxisVector change = combined(1.0, out.tube.direction, -1.0, in.tube.direction);
  const double turn = norm(change), along = acceleration_along(change);
  return turn > 0.0 && along < unlimited ? std::min(feed, std::sqrt(8.0 * along * in.tolerance / turn)) : feed;
}

void PlaneBound::make_planes(const std::vector<PlaneLeg>& legs) {
  const std::size_t count = legs.size();
  planes_.assign(count, {});
  const auto tolerance = [&](std::size_t i) { return i == 0 || i == count ? 0.0 : legs[i - 1].tolerance; };
  const auto speed = [&](std::size_t i) { return i == 0 || i == count ? 0.0 : corner_speed(legs[i - 1], legs[i]); };
  /// Direction of the acceleration at a corner.
  const auto turn = [&](std::size_t i) {
    if (i == 0) return legs[0].tube.direction;
    if (i == count) return scaled(legs[count - 1].tube.direction, -1.0);
    const AxisVector change = combined(1.0, legs[i].tube.direction, -1.0, legs[i - 1].tube.direction);
    return scaled(change, 1.0 / std::max(norm(change), 1e-12));
  };
  std::vector<double> place(count), reached(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double length = length_of(legs[i]), v1 = speed(i), v2 = speed(i + 1);
    const double a = acceleration_along(legs[i].tube.direction);
    place[i] = 0.5 * length + (a < unlimited ? (v2 * v2 - v1 * v1) / (4.0 * a) : 0.0);
    place[i] = std::clamp(place[i], 0.15 * length, 0.85 * length);
    reached[i] = a < unlimited ? std::sqrt(v1 * v1 + 2.0 * a * place[i]) : unlimited;
  }
  const auto put = [&](std::size_t i, const AxisVector& normal, bool tilted) {
    const double width = norm(normal), length = length_of(legs[i]);
    const double least = 1.01 * width * tolerance(i) + 1e-9, most = length - 1.01 * width * tolerance(i + 1) - 1e-9;
    if (!(least < most)) return false;
    const double at = std::clamp(place[i], least, most);
    planes_[i] = {true, normal, at, length - at, tilted};
    return true;
  };
  for (std::size_t i = 0; i < count; ++i) put(i, pace_normal(legs[i]), false);
  std::vector<bool> has(count);
  for (std::size_t i = 0; i < count; ++i) has[i] = planes_[i].exists;
  for (std::size_t i = 0; i < count; ++i) {
    const bool alone = (i > 0 && !has[i - 1]) || (i + 1 < count && !has[i + 1]);
    if (!has[i] || alone || !(reached[i] < 1.2 * feed_of(legs[i])) || !(legs[i].tube.feed < unlimited)) continue;
    const AxisVector& u = legs[i].tube.direction;
    const AxisVector difference = combined(1.0, turn(i), -1.0, turn(i + 1));
    const double along = dot(difference, u);
    if (!(along > 0.1)) continue;
    const AxisVector aside = combined(1.0 / along, difference, -1.0, u);
    const double tilt = norm(aside);
    put(i, combined(1.0, u, std::min(tilt, 1.0 / std::max(tilt, 1e-12)), aside), true);
  }
}

double PlaneBound::found(const PlaneWindow& window) {
  std::vector<std::int64_t> key;
  const auto note = [&](double value, double unit) {
    key.push_back(value < unlimited ? std::llround(value / unit) : -1);
  };
  for (const TubeLeg* leg : {window.in, window.out}) {
    if (leg == nullptr) continue;
    for (const double value : leg->direction) note(value, 1e-9);
    note(leg->feed, 1e-9);
    note(leg->radius, 1e-12);
  }
  for (const AxisVector* normal : {&window.before_normal, &window.after_normal}) {
    for (const double value : *normal) note(value, 1e-9);
  }
  for (const double value : {window.tolerance, window.before, window.after}) note(value, 1e-11);
  const auto [entry, is_new] = known_.try_emplace(std::move(key), 0.0);
  if (is_new) entry->second = more_() ? plane_time(window, machine_, n_, more_) : 0.0;
  return entry->second;
}

double PlaneBound::window(const PlaneLeg& in, const Plane& from, const PlaneLeg& out, const Plane& to) {
  PlaneWindow window{&in.tube, &out.tube, in.tolerance, from.normal, to.normal, from.second, to.first};
  // Straight to the corner and away from it.
  const double straight = from.second / norm(from.normal) + to.first / norm(to.normal) - 2.0 * in.tolerance;
  double time = std::max(found(window), straight / std::max(feed_of(in), feed_of(out)));
  if (!from.tilted && !to.tilted)
    time = std::max(time, from.second / feed_of(in) + to.first / feed_of(out) - cut(in, out));
  return time;
}

double PlaneBound::rest(const PlaneLeg& leg, const AxisVector& normal, double way) {
  PlaneWindow window;
  TubeLeg out = leg.tube;
  // Seen from the end at rest.
  if (dot(normal, leg.tube.direction) < 0.0) out.direction = scaled(leg.tube.direction, -1.0);
  window.out = &out;
  window.after_normal = normal;
  window.after = way;
  return found(window);
}

/// From every tenth window, s.
double PlaneBound::expected(const std::vector<PlaneLeg>& legs) {
  double sum = 0.0, way = 0.0, ways = 0.0;
  for (std::size_t i = 0; i < legs.size(); ++i) {
    ways += legs[i].way;
    if (i % 10 != 0 || i + 1 == legs.size() || !planes_[i].exists || !planes_[i + 1].exists) continue;
    sum += window(legs[i], planes_[i], legs[i + 1], planes_[i + 1]);
    way += planes_[i].second / feed_of(legs[i]) + planes_[i + 1].first / feed_of(legs[i + 1]);
  }
  return way > 0.0 ? sum / way * ways : unlimited;
}

double PlaneBound::time(const std::vector<PlaneLeg>& legs, double known) {
  make_planes(legs);
  const std::size_t count = legs.size();
  // At rest both ends of the section are as good as planes across its first and last leg.
  if (!planes_.front().exists || !planes_.back().exists) return -1.0;
  if (expected(legs) < 0.9 * known) return -1.0;
  double sum = rest(legs.front(), planes_.front().normal, planes_.front().first) +
               rest(legs.back(), scaled(planes_.back().normal, -1.0), planes_.back().second);
  for (std::size_t i = 0; i + 1 < count;) {
    std::size_t next = i + 1;
    while (!planes_[next].exists) ++next;
    if (next == i + 1) {
      sum += window(legs[i], planes_[i], legs[next], planes_[next]);
    } else {
      double time = planes_[i].second / feed_of(legs[i]) + planes_[next].first / feed_of(legs[next]);
      for (std::size_t k = i; k < next; ++k) time += (k > i ? legs[k].way : 0.0) - cut(legs[k], legs[k + 1]);
      sum += std::max(0.0, time);
    }
    i = next;
  }
  return sum;
}

}  // namespace accdec
