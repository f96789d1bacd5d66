#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include <accdec/plan/verify/motion_proof.hpp>
#include <accdec/simulate/sample_check.hpp>
#include <accdec/simulate/tube_check.hpp>

namespace accdec {
namespace {

using Values = std::vector<double>;

/// The largest acceleration of an axis, forwards or back, with the help of friction.
double acceleration_of(const Axis& axis) {
  double by_force = unlimited;
  if (axis.force_max < unlimited && axis.mass > 0.0) {
    const double drag = axis.damping > 0.0 ? axis.damping * axis.velocity_max : 0.0;
    by_force = (axis.force_max + axis.coulomb + drag) / axis.mass;
  }
  return std::min(axis.acceleration_max, by_force);
}

double length_of(const Values& v) {
  double sum = 0.0;
  for (const double x : v) sum += x * x;
  return std::sqrt(sum);
}
double product(const Values& a, const Values& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}
/// a + f b.
Values plus(Values a, double f, const Values& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] += f * b[i];
  return a;
}

/// The integral of |f| over 0 .. 1 for a linear f from a to b.
double area(double a, double b) {
  if ((a < 0.0) == (b < 0.0)) return 0.5 * std::abs(a + b);
  const double zero = a / (a - b);  // where f is 0
  return 0.5 * (std::abs(a) * zero + std::abs(b) * (1.0 - zero));
}

/// A program as the multipliers see it: the continuous motion through the samples, see THEORY.md, "Samples and
/// continuous motion".
struct Continuous {
  const Toolpath& path;
  const Machine& machine;
  bool jerk = false;
  double wider = 0.0, later = 0.0;  // m, s
  Values radius, feed;              // of every block

  Continuous(const Toolpath& of, const Machine& on, double period)
      : path(of), machine(on), radius(tube_radii(of)), feed(feed_limits(of)) {
    double sum = 0.0;
    for (std::size_t a = 0; a < path.dimensions(); ++a) {
      sum += std::pow(acceleration_of(machine.axes[a]), 2);
      jerk = jerk || machine.axes[a].jerk_max < unlimited;
    }
    wider = std::sqrt(sum) * period * period / (jerk ? 6.0 : 8.0) + path.narrowed;
    later = jerk ? 2.0 * period : period;
    for (std::size_t b = 0; b < path.blocks(); ++b)
      radius[b] = std::max({radius[b], b > 0 ? granted(b - 1) : 0.0, granted(b)}) + wider;
    for (const PathArc& arc : path.arcs) {
      const double half = 0.5 * arc.angle / static_cast<double>(arc.last - arc.first + 1);
      for (std::size_t b = arc.first; b <= arc.last; ++b) {
        double dx = 0.0, dy = 0.0;
        const double r = std::max(arc.from(path.point(b), dx, dy), arc.from(path.point(b + 1), dx, dy));
        radius[b] += r * (1.0 - std::cos(half));  // an arc is that far from its chord
      }
    }
  }
  double granted(std::size_t joint) const { return path.joint[joint] == Joint::stop ? 0.0 : path.tolerance[joint]; }
  Values from_to(std::size_t a, std::size_t b) const {
    Values way;
    for (std::size_t i = 0; i < path.dimensions(); ++i) way.push_back(path.point(b)[i] - path.point(a)[i]);
    return way;
  }
};

/// A leg of multipliers: one or more blocks.
struct Leg {
  const MotionProof::Leg& given;
  Values way;
  double before = 0.0, after = 0.0;  // m, tolerances of the joints at its ends; 0 at stops
  double radius = 0.0, feed = 0.0;   // m; m/s
};

/// A part of the time that one leg adds, as a function of its time h.
class LegSum {
 public:
  LegSum(const Continuous& motion, const Leg& leg, const MotionProof::Leg* before, const MotionProof::Leg* after)
      : motion_(motion), leg_(leg), w_(leg.given) {
    if (before != nullptr) ends_.push_back(end(leg.before, w_.way.front(), before->way.back(), before->time));
    if (after != nullptr) ends_.push_back(end(leg.after, w_.way.back(), after->way.front(), after->time));
    ways_ = 0.5 * (product(w_.way.front(), leg.way) + product(w_.way.back(), leg.way));
    for (std::size_t k = 0; k < w_.way.size(); ++k) {
      const double share = w_.shares[k + 1] - w_.shares[k];
      const Values rest = plus(plus(w_.acceleration[k + 1], -1.0, w_.acceleration[k]), -share, w_.way[k]);
      double by_axes = 0.0;
      for (std::size_t a = 0; a < rest.size(); ++a)
        if (rest[a] != 0.0) by_axes += std::abs(rest[a]) * motion.machine.axes[a].velocity_max;
      const double whole = length_of(rest);
      feeds_ += std::min(whole > 0.0 ? whole * leg.feed : 0.0, by_axes);
      if (k == 0) continue;
      const Values turn = plus(w_.way[k - 1], -1.0, w_.way[k]);
      ways_ -= leg.radius * length_of(turn) + 0.5 * std::abs(product(turn, leg.way));
    }
  }

  /// The least over all times, s.
  double least() const {
    double fastest2 = 0.0;
    for (std::size_t a = 0; a < leg_.way.size(); ++a) fastest2 += std::pow(motion_.machine.axes[a].velocity_max, 2);
    const double speed = std::min(leg_.feed, std::sqrt(fastest2)), g = w_.time;
    const double from = (length_of(leg_.way) - leg_.before - leg_.after) / speed,
                 longest = std::max(8.0 * g, 2.0 * from);
    if (!(from > 0.0)) return -unlimited;
    std::priority_queue<Span> open;
    const auto add = [&](const Place& a, const Place& b) { open.push({between(a, b), a, b}); };
    add(at(from), at(longest));
    double reached = unlimited;
    while (open.top().least < reached - 1e-5 * g) {
      const Span span = open.top();
      open.pop();
      const Place middle = at(std::sqrt(span.from.h * span.to.h));
      reached = std::min(reached, between(middle, middle));
      add(span.from, middle), add(middle, span.to);
    }
    return std::min(open.top().least, std::max(beyond(longest, false), beyond(longest, true)));
  }

 private:
  /// A time with what it costs: limits by M as it is and by a straight one, and joints.
  struct Place {
    double h, limits, straight, joints;
  };
  struct Span {
    double least;
    Place from, to;
    bool operator<(const Span& other) const { return least > other.least; }
  };
  /// Half of a joint: at most tolerance/2 |f + 2 (1/h - 1/g) p|.
  struct End {
    double tolerance;
    Values f, p;
  };

  End end(double tolerance, const Values& p, const Values& q, double other) const {
    Values f = p;
    for (std::size_t a = 0; a < f.size(); ++a) f[a] = p[a] / w_.time - q[a] / other;
    return {tolerance, std::move(f), p};
  }
  double joints(double rate) const {
    double sum = 0.0;
    for (const End& e : ends_) {
      double square = 0.0;
      for (std::size_t a = 0; a < e.p.size(); ++a)
        square += std::pow(e.f[a] + 2.0 * (rate - 1.0 / w_.time) * e.p[a], 2);
      sum += 0.5 * e.tolerance * std::sqrt(square);
    }
    return sum;
  }
  /// M of an axis at share k; `straight`: linear between both ends of the leg, which is a choice, too.
  double jerk_weight(std::size_t k, std::size_t a, bool straight) const {
    if (!(motion_.machine.axes[a].jerk_max < unlimited)) return 0.0;
    if (!straight) return w_.jerk[k][a];
    return w_.jerk.front()[a] + w_.shares[k] * (w_.jerk.back()[a] - w_.jerk.front()[a]);
  }
  /// The integral of A |h K + M'| + J h |M|; with `slope` that of A |K| + J |M|, by which it grows at most.
  double limits(double h, bool straight, bool slope = false) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < w_.way.size(); ++k) {
      const double share = w_.shares[k + 1] - w_.shares[k];
      for (std::size_t a = 0; a < leg_.way.size(); ++a) {
        const Axis& axis = motion_.machine.axes[a];
        const double m0 = jerk_weight(k, a, straight), m1 = jerk_weight(k + 1, a, straight);
        const double bend = slope ? 0.0 : (m1 - m0) / share;
        const double pull = area(h * w_.acceleration[k][a] + bend, h * w_.acceleration[k + 1][a] + bend);
        if (pull > 0.0) sum += share * acceleration_of(axis) * pull;
        if (m0 != 0.0 || m1 != 0.0) sum += share * axis.jerk_max * h * area(m0, m1);
      }
    }
    return sum;
  }
  Place at(double h) const {
    const double as_is = limits(h, false);
    return {h, as_is, motion_.jerk ? limits(h, true) : as_is, joints(1.0 / h)};
  }
  /// At least for all times between two. Limits are convex in h, and joints in 1/h: both are largest at an end.
  double between(const Place& a, const Place& b) const {
    const double lost = std::min(std::max(a.limits, b.limits), std::max(a.straight, b.straight));
    return a.h + std::min(ways_ / a.h, ways_ / b.h) - feeds_ - lost - std::max(a.joints, b.joints);
  }
  double beyond(double h, bool straight) const {
    if (limits(1.0, straight, true) > 1.0) return -unlimited;
    return h + std::min(0.0, ways_ / h) - feeds_ - limits(h, straight) - std::max(joints(1.0 / h), joints(0.0));
  }

  const Continuous& motion_;
  const Leg& leg_;
  const MotionProof::Leg& w_;
  std::vector<End> ends_;
  double ways_ = 0.0, feeds_ = 0.0;
};

void require(bool right, const MotionProof& proof, const char* what) {
  if (!right) throw std::invalid_argument(fmt::format("the multipliers from block {} on: {}", proof.first, what));
}

void check_shape(const Continuous& motion, const MotionProof& proof) {
  const std::size_t axes = motion.path.dimensions();
  const auto rows = [&](const std::vector<Values>& table, std::size_t count) {
    return table.size() == count && std::all_of(table.begin(), table.end(), [&](const Values& row) {
             return row.size() == axes &&
                    std::all_of(row.begin(), row.end(), [](double x) { return std::isfinite(x); });
           });
  };
  require(!proof.legs.empty(), proof, "there is no leg");
  std::size_t next = proof.first;
  const MotionProof::Leg* before = nullptr;
  for (const MotionProof::Leg& leg : proof.legs) {
    require(leg.last >= next && leg.last < motion.path.blocks(), proof, "legs are not in order");
    next = leg.last + 1;
    const Values& s = leg.shares;
    require(s.size() > 1 && s.front() == 0.0 && s.back() == 1.0, proof, "shares are not from 0 to 1");
    require(std::adjacent_find(s.begin(), s.end(), [](double a, double b) { return !(a < b); }) == s.end(), proof,
            "shares do not rise");
    require(leg.time > 0.0 && leg.time < unlimited, proof, "a leg takes no time");
    require(rows(leg.acceleration, s.size()) && rows(leg.way, s.size() - 1), proof, "a table has the wrong size");
    require(motion.jerk ? rows(leg.jerk, s.size()) : leg.jerk.empty(), proof, "jerk has the wrong size");
    if (before != nullptr) {
      require(before->acceleration.back() == leg.acceleration.front(), proof, "acceleration jumps at a joint");
      require(!motion.jerk || before->jerk.back() == leg.jerk.front(), proof, "jerk jumps at a joint");
    }
    before = &leg;
  }
}

/// One section from stop to stop, s.
double section_time(const Continuous& motion, const MotionProof& proof) {
  check_shape(motion, proof);
  const Toolpath& path = motion.path;
  require(proof.first == 0 || path.joint[proof.first - 1] == Joint::stop, proof, "they do not begin at a stop");
  std::vector<Leg> legs;
  std::size_t first = proof.first;
  for (const MotionProof::Leg& given : proof.legs) {
    Leg& leg = legs.emplace_back(Leg{given, motion.from_to(first, given.last + 1)});
    if (first > proof.first) leg.before = motion.granted(first - 1) + motion.wider;
    if (&given != &proof.legs.back()) leg.after = motion.granted(given.last) + motion.wider;
    for (std::size_t b = first; b <= given.last; ++b) {
      require((path.joint[b] == Joint::stop) == (b == given.last && &given == &proof.legs.back()), proof,
              "a stop is no end of them");
      // A motion near a block is as near to the leg, but for what the block's ends are off it.
      double off2 = 0.0;
      for (const std::size_t end : {b, b + 1})
        off2 = std::max(
            off2, segment_distance2(path.point(first), path.point(given.last + 1), path.point(end), path.dimensions()));
      leg.radius = std::max(leg.radius, motion.radius[b] + std::sqrt(off2));
      leg.feed = std::max(leg.feed, motion.feed[b]);
    }
    require(leg.radius < unlimited && leg.after < unlimited, proof, "a tolerance is not limited");
    first = given.last + 1;
  }
  Values feeds;
  for (const Leg& leg : legs) feeds.push_back(leg.feed);
  double sum = 0.0;
  for (std::size_t i = 0; i < legs.size(); ++i) {
    // Beside a joint a motion may be as fast as on the other leg.
    for (const std::size_t j : {i > 0 ? i - 1 : i, std::min(i + 1, legs.size() - 1)})
      legs[i].feed = std::max(legs[i].feed, feeds[j]);
    sum += LegSum(motion, legs[i], i > 0 ? &proof.legs[i - 1] : nullptr,
                  i + 1 < legs.size() ? &proof.legs[i + 1] : nullptr)
               .least();
  }
  return sum;
}

}  // namespace

double proved_time(const Toolpath& path, const Machine& machine, double sample_period,
                   const std::vector<MotionProof>& proofs) {
  constexpr double rounding = 1.0 - 1e-8;
  const Continuous motion(path, machine, sample_period);
  double time = path.dwells();
  std::size_t next = 0;
  for (const MotionProof& proof : proofs) {
    require(proof.first >= next, proof, "they are not in order");
    time += std::max(0.0, rounding * section_time(motion, proof) - motion.later);
    next = proof.legs.back().last + 1;
  }
  return time;
}

}  // namespace accdec
