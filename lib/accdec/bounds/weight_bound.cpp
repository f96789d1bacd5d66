#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <accdec/bounds/corner_bound.hpp>
#include <accdec/bounds/weight_bound.hpp>
#include <accdec/bounds/weight_search.hpp>
#include <accdec/simulate/sample_check.hpp>

namespace accdec {
namespace {

using SectionLeg = WeightedSection::Leg;

/// Legs first .. end as one, with a tube that is wider by what they are off it.
SectionLeg joined(const std::vector<SectionLeg>& legs, std::size_t first, std::size_t end) {
  SectionLeg whole = legs[first];
  std::vector<AxisVector> inside;
  for (std::size_t i = first + 1; i < end; ++i) {
    inside.push_back(whole.way);
    whole.way = combined(1.0, whole.way, 1.0, legs[i].way);
    whole.radius = std::max(whole.radius, legs[i].radius);
    whole.feed = std::max(whole.feed, legs[i].feed);
  }
  whole.tolerance = legs[end - 1].tolerance;
  double off2 = 0.0;
  const AxisVector begin{};
  for (const AxisVector& point : inside)
    off2 = std::max(off2, segment_distance2(begin.data(), whole.way.data(), point.data(), point.size()));
  whole.radius += std::sqrt(off2);
  return whole;
}

/// Leaves joints out until every leg is so many times as long as the tolerances at its ends.
/// @returns the first of the legs that become one, for each; none if that fails
std::vector<std::size_t> long_legs(const std::vector<SectionLeg>& legs) {
  constexpr double times = 4.0;
  std::vector<AxisVector> joints(1);
  for (const SectionLeg& leg : legs) joints.push_back(combined(1.0, joints.back(), 1.0, leg.way));
  const auto is_long = [&](std::size_t first, std::size_t end) {
    const double tolerances = (first > 0 ? legs[first - 1].tolerance : 0.0) + legs[end - 1].tolerance;
    return norm(combined(1.0, joints[end], -1.0, joints[first])) >= times * tolerances;
  };
  std::vector<std::size_t> begins{0};
  for (std::size_t end = 1; end < legs.size(); ++end) {
    if (is_long(begins.back(), end)) begins.push_back(end);
  }
  // If the last leg is short, it is joined to those before it.
  while (!begins.empty() && !is_long(begins.back(), legs.size())) begins.pop_back();
  return begins;
}

/// Six digits: whatever the weights are, they give a bound.
double rounded(double value, double largest) {
  const double unit = std::pow(10.0, std::floor(std::log10(largest)) - 6.0);
  return largest > 0.0 ? std::round(value / unit) * unit : 0.0;
}

/// Weights as others read them: a value for every axis of the program.
void write_down(const MotionWeights& w, const std::vector<std::size_t>& moved, std::size_t dimensions,
                std::vector<MotionProof::Leg>& legs) {
  std::array<double, 3> largest{};  // of K, M and p
  const auto each = [&](const auto& visit) {
    for (std::size_t leg = 0; leg < w.legs(); ++leg) {
      for (std::size_t k = 0; k <= w.pieces(leg); ++k) {
        visit(leg, 0, k, w.k(leg, k));
        if (w.jerk()) visit(leg, 1, k, w.m(leg, k));
        if (k < w.pieces(leg)) visit(leg, 2, k, w.p(leg, k));
      }
    }
  };
  each([&](std::size_t, std::size_t kind, std::size_t, std::size_t at) {
    for (std::size_t a = 0; a < w.axes(); ++a) largest[kind] = std::max(largest[kind], std::abs(w.value[at + a]));
  });
  each([&](std::size_t leg, std::size_t kind, std::size_t, std::size_t at) {
    MotionProof::Leg& to = legs[leg];
    std::vector<double>& row = (kind == 0   ? to.acceleration
                                : kind == 1 ? to.jerk
                                            : to.way)
                                   .emplace_back(dimensions, 0.0);
    for (std::size_t a = 0; a < w.axes(); ++a) row[moved[a]] = rounded(w.value[at + a], largest[kind]);
  });
  for (std::size_t leg = 0; leg < w.legs(); ++leg) {
    legs[leg].shares = w.shares(leg);
    legs[leg].time = rounded(w.value[w.time(leg)], w.value[w.time(leg)]);
  }
}

/// Times that are about what is known of all: at full speed, and a part of what they take from rest and to rest.
void guess_times(WeightedSection& section, double known) {
  double at_speed = 0.0, from_rest = 0.0;
  std::vector<double> slower;
  for (SectionLeg& leg : section.legs) {
    const double length = norm(leg.way);
    double speed = leg.feed, acceleration = unlimited, jerk = unlimited;
    for (std::size_t a = 0; a < section.axes.size(); ++a) {
      const double part = std::abs(leg.way[a]) / length;
      if (part == 0.0) continue;
      speed = std::min(speed, section.axes[a].velocity / part);
      acceleration = std::min(acceleration, section.axes[a].acceleration / part);
      jerk = std::min(jerk, section.axes[a].jerk / part);
    }
    leg.guess = length / speed;
    at_speed += leg.guess;
    slower.push_back(std::max(2.0 * std::sqrt(length / acceleration), std::cbrt(32.0 * length / jerk)));
    from_rest += slower.back();
    leg.reach = 1.2 * (speed / acceleration + acceleration / jerk);
  }
  const double part = std::clamp((1.05 * known - at_speed) / from_rest, 0.02, 1.0);
  for (std::size_t i = 0; i < slower.size(); ++i) section.legs[i].guess += part * slower[i];
}

}  // namespace

double weight_bound(const std::vector<WeightLeg>& legs, const Machine& machine, std::size_t dimensions, double known,
                    double& work_left, const std::function<bool()>& more, MotionProof* proof) {
  WeightedSection section;
  std::vector<std::size_t> moved;
  for (std::size_t a = 0; a < dimensions; ++a) {
    const auto moves = [a](const WeightLeg& leg) { return leg.tube.direction[a] != 0.0; };
    if (std::none_of(legs.begin(), legs.end(), moves)) continue;
    const Axis& axis = machine.axes[a];
    moved.push_back(a);
    section.axes.push_back({axis.velocity_max, acceleration_most(axis), axis.jerk_max});
    if (!(section.axes.back().acceleration < unlimited && axis.velocity_max < unlimited)) return 0.0;
  }
  for (const WeightLeg& leg : legs) {
    if (!(leg.tube.radius < unlimited && leg.tolerance < unlimited)) return 0.0;
    SectionLeg& way = section.legs.emplace_back();
    const double length = leg.way / dot(leg.tube.pace, leg.tube.direction);
    for (std::size_t i = 0; i < moved.size(); ++i) way.way[i] = length * leg.tube.direction[moved[i]];
    way.radius = leg.tube.radius;
    way.tolerance = leg.tolerance;
    way.feed = leg.tube.feed;
  }
  const std::vector<std::size_t> begins = long_legs(section.legs);
  if (begins.empty()) return 0.0;
  std::vector<SectionLeg> all;
  std::vector<MotionProof::Leg> written;
  for (std::size_t i = 0; i < begins.size(); ++i) {
    const std::size_t end = i + 1 < begins.size() ? begins[i + 1] : legs.size();
    all.push_back(joined(section.legs, begins[i], end));
    written.emplace_back().last = legs[end - 1].last;
  }
  section.legs = std::move(all);
  guess_times(section, known);
  std::optional<MotionWeights> best;
  const double time = largest_weighted_time(section, work_left, more, &best);
  if (proof != nullptr && best) {
    write_down(*best, moved, dimensions, written);
    proof->legs = std::move(written);
  }
  return time;
}

}  // namespace accdec
