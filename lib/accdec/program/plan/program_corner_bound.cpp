#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include <accdec/program/plan/corner_bound.hpp>

namespace accdec {
namespace {

constexpr std::size_t steps = 24;   // of a leg's highest speed, from its feed down
constexpr double step_ratio = 1.1;  // of one to the next
constexpr int periods = 60;

/// Of a leg's speeds, step s is from feed/step_ratio^(s + 1) to feed/step_ratio^s; the last one begins at 0.
double step_part(std::size_t s) {
  return std::pow(step_ratio, -static_cast<double>(s));
}

/// Blocks between two joints that turn or stop.
struct BoundLeg {
  std::size_t first = 0, last = 0;  // blocks
  double length = 0.0, feed = 0.0, acceleration = unlimited, jerk = unlimited;
  double rests = 0.0, corners = 0.0;  // ends at rest; ends that count
  int corner_class = -1;              // of the corner at its end, where that counts

  /// From rest to v, or as much faster, with no acceleration at both ends.
  double ramp(double v) const {
    if (!(jerk < unlimited)) return acceleration < unlimited ? v / acceleration : 0.0;
    if (v * jerk >= acceleration * acceleration) return v / acceleration + acceleration / jerk;
    return 2.0 * std::sqrt(v / jerk);
  }

  /// From rest to rest: the way at v and both ramps, v as high as the length lets it come to (by bisection: length = v
  /// ramp(v)).
  double rest_to_rest() const {
    double high = feed;
    if (feed * ramp(feed) > length) {
      double low = 0.0;
      for (int i = 0; i < 60; ++i) {
        const double v = 0.5 * (low + high);
        (v * ramp(v) > length ? high : low) = v;
      }
    }
    return length / high + ramp(high);
  }

  std::size_t expected_step() const {
    std::size_t s = 0;
    while (s + 2 < steps && feed * step_part(s) * ramp(feed * step_part(s)) > step_ratio * length) ++s;
    return s;
  }

  /// What the leg takes at least at a step, without its corners.
  double time(std::size_t s) const {
    if (rests == 2.0) return rest_to_rest();
    const double v = feed * step_part(s);
    if (s + 1 == steps) return length / v;
    const double faster = v - feed * step_part(s + 1);
    return length / v + rests * 0.5 * ramp(v) - (rests + corners) * faster * ramp(faster) / (2.0 * v);
  }
};

/// Corners of the same directions, feeds and tolerance.
struct CornerClass {
  std::vector<double> in, out;  // unit vectors
  const BoundLeg *leg_in = nullptr, *leg_out = nullptr;
  double tolerance = 0.0;
  std::array<double, steps * steps> loss{};  // at least, by the steps before and after
  std::array<bool, steps * steps> solved{};
};

class ProgramCornerBound {
 public:
  ProgramCornerBound(const Toolpath& path, const Machine& machine, double sample_period)
      : path_(path), machine_(machine), n_(path.dimensions()) {
    // See the header: what splines of samples leave these by.
    double acceleration2 = 0.0;
    for (const Axis& axis : machine.axes) {
      double most = acceleration_most(axis);
      if (axis.jerk_max < unlimited) {
        jerk_ = true;
        if (axis.velocity_max < unlimited) most = std::min(most, 2.0 * std::sqrt(axis.velocity_max * axis.jerk_max));
      }
      acceleration2 += most * most;
    }
    wider_ = std::sqrt(acceleration2) * sample_period * sample_period / (jerk_ ? 6.0 : 8.0);
    saved_ = (jerk_ ? 2.0 : 1.0) * sample_period;
    make_legs();
    make_classes();
  }

  CornerBound bound(double time_limit) {
    const auto start = std::chrono::steady_clock::now();
    const auto ended = [&] {
      return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > time_limit;
    };
    // Begun where the legs would come to if they went from rest to rest.
    for (std::size_t i = 0; i < legs_.size(); ++i) step_[i] = legs_[i].expected_step();
    // The least sum with what is known of the corners, until it rests on solved linear programs only.
    for (bool again = !legs_.empty(); again;) {
      again = false;
      if (result_.classes > 0 || result_.counted == 0) result_.time = least_sum();
      for (std::size_t i = 0; i + 1 < legs_.size(); ++i) {
        if (legs_[i].corner_class < 0) continue;
        CornerClass& c = classes_[static_cast<std::size_t>(legs_[i].corner_class)];
        const std::size_t s = step_[i], t = step_[i + 1];
        if (c.solved[s * steps + t] || s + 1 == steps || t + 1 == steps) continue;
        if (ended()) {
          result_.time = least_sum();
          result_.complete = false;
          return result_;
        }
        solve(c, s, t);
        again = true;
      }
    }
    return result_;
  }

 private:
  double unit(std::size_t block, std::vector<double>& u) const {
    const double* p = path_.point(block);
    double length = 0.0;
    u.resize(n_);
    for (std::size_t a = 0; a < n_; ++a) length = std::hypot(length, u[a] = p[n_ + a] - p[a]);
    for (double& value : u) value /= length;
    return length;
  }

  void make_legs() {
    std::vector<double> u;
    for (std::size_t b = 0; b < path_.blocks(); ++b) {
      const double length = unit(b, u);
      if (b == 0 || path_.joint[b - 1] != Joint::straight) {
        BoundLeg leg;
        leg.first = b;
        for (std::size_t a = 0; a < n_; ++a) {
          if (u[a] == 0.0) continue;
          leg.acceleration = std::min(leg.acceleration, acceleration_most(machine_.axes[a]) / std::abs(u[a]));
          leg.jerk = std::min(leg.jerk, machine_.axes[a].jerk_max / std::abs(u[a]));
        }
        legs_.push_back(leg);
      }
      BoundLeg& leg = legs_.back();
      double feed = length / path_.duration[b];
      for (std::size_t a = 0; a < n_; ++a) {
        if (u[a] != 0.0) feed = std::min(feed, machine_.axes[a].velocity_max / std::abs(u[a]));
      }
      leg.last = b;
      leg.length += length;
      leg.feed = std::max(leg.feed, feed);
    }
    step_.assign(legs_.size(), 0);
  }

  bool stops(std::size_t leg) const { return path_.joint[legs_[leg].last] == Joint::stop; }

  /// What a parabola would take of each leg to cut the corner by its tolerance; none at rest.
  double cut(std::size_t leg, const std::vector<double>& in, const std::vector<double>& out) const {
    double across = 0.0;
    for (std::size_t a = 0; a < n_; ++a) across = std::hypot(across, out[a] - in[a]);
    return 4.0 * (path_.tolerance[legs_[leg].last] + wider_) / across;
  }

  /// Which corners count, and their classes.
  void make_classes() {
    std::vector<double> in, out, cuts(legs_.size(), 0.0);
    for (std::size_t i = 0; i + 1 < legs_.size(); ++i) {
      if (stops(i)) continue;
      ++result_.corners;
      unit(legs_[i].last, in);
      unit(legs_[i + 1].first, out);
      cuts[i] = cut(i, in, out);
    }
    const auto long_enough = [&](std::size_t i) {
      return legs_[i].ramp(legs_[i].feed) > 0.0 && legs_[i].length >= 1.5 * (cuts[i] + (i > 0 ? cuts[i - 1] : 0.0));
    };
    std::map<std::vector<long long>, int> known;
    for (std::size_t i = 0; i < legs_.size(); ++i) {
      if (i == 0 || stops(i - 1)) legs_[i].rests += 1.0;
      if (stops(i)) {
        legs_[i].rests += 1.0;
      } else if (long_enough(i) && long_enough(i + 1)) {
        ++result_.counted;
        unit(legs_[i].last, in);
        unit(legs_[i + 1].first, out);
        legs_[i].corners += 1.0;
        legs_[i + 1].corners += 1.0;
        legs_[i].corner_class = class_of(i, in, out, known);
      }
    }
  }

  /// Alike are corners whose directions, feeds and tolerance agree to nine digits.
  int class_of(std::size_t i, const std::vector<double>& in, const std::vector<double>& out,
               std::map<std::vector<long long>, int>& known) {
    std::vector<long long> key;
    for (const double u : in) key.push_back(std::llround(u * 1e9));
    for (const double u : out) key.push_back(std::llround(u * 1e9));
    for (const double feed : {legs_[i].feed, legs_[i + 1].feed}) key.push_back(std::llround(feed * 1e9));
    const double tolerance = path_.tolerance[legs_[i].last] + wider_;
    key.push_back(std::llround(tolerance * 1e12));
    const auto [entry, is_new] = known.try_emplace(std::move(key), static_cast<int>(classes_.size()));
    if (is_new) {
      CornerClass c;
      c.in = in;
      c.out = out;
      c.leg_in = &legs_[i];
      c.leg_out = &legs_[i + 1];
      c.tolerance = tolerance;
      c.loss = least_losses(c);
      classes_.push_back(std::move(c));
    }
    return entry->second;
  }

  /// Before any linear program: at the corner's moment the legs have p to go and q gone, |q u2 - p u1| <= e; so no
  /// more than p/v1 + q/v2 is saved by moving both at once.
  std::array<double, steps * steps> least_losses(const CornerClass& c) const {
    double cosine = 0.0;
    for (std::size_t a = 0; a < n_; ++a) cosine += c.in[a] * c.out[a];
    const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
    double way = cosine > 0.0 ? c.tolerance / std::max(sine, 1e-12) : c.tolerance;
    way = std::min(way, std::min(c.leg_in->length, c.leg_out->length) + c.tolerance);
    std::array<double, steps * steps> losses{};
    for (std::size_t s = 0; s < steps; ++s) {
      for (std::size_t t = 0; t < steps; ++t) {
        losses[s * steps + t] = -way * (1.0 / (c.leg_in->feed * step_part(s)) + 1.0 / (c.leg_out->feed * step_part(t)));
      }
    }
    return losses;
  }

  void solve(CornerClass& c, std::size_t s, std::size_t t) {
    const double in = c.leg_in->feed * step_part(s), out = c.leg_out->feed * step_part(t);
    const BoundCorner corner{c.in.data(),
                             c.out.data(),
                             in,
                             out,
                             std::max(c.leg_in->feed, c.leg_out->feed),
                             1.1 * c.leg_in->ramp(in),
                             1.1 * c.leg_out->ramp(out),
                             c.tolerance};
    const CornerDual loss = corner_loss(corner, machine_, n_, periods);
    for (std::size_t i = 0; i + 1 < steps; ++i) {
      for (std::size_t j = 0; j + 1 < steps; ++j) {
        double& known = c.loss[i * steps + j];
        known = std::max(known, loss.at(step_part(i) / step_part(s), step_part(j) / step_part(t)));
      }
    }
    c.solved[s * steps + t] = true;
    ++result_.classes;
  }

  /// Over all steps of all legs; `step_` becomes those of the least.
  double least_sum() {
    std::vector<std::array<std::uint8_t, steps>> from(legs_.size());
    std::array<double, steps> best{};
    double before = path_.dwell_first;  // of earlier sections between stops
    for (const auto& dwell : path_.dwell) before += dwell.second;
    for (std::size_t i = 0; i < legs_.size(); ++i) {
      const std::array<double, steps> earlier = best;
      const std::size_t least =
          static_cast<std::size_t>(std::min_element(earlier.begin(), earlier.end()) - earlier.begin());
      const int corner = i > 0 ? legs_[i - 1].corner_class : -1;
      for (std::size_t t = 0; t < steps; ++t) {
        std::size_t s = least;
        double sum = earlier[least];
        if (corner >= 0) {
          const double* loss = classes_[static_cast<std::size_t>(corner)].loss.data();
          sum = earlier[s] + loss[s * steps + t];
          for (std::size_t k = 0; k < steps; ++k) {
            if (earlier[k] + loss[k * steps + t] < sum) sum = earlier[s = k] + loss[k * steps + t];
          }
        }
        best[t] = sum + legs_[i].time(t);
        from[i][t] = static_cast<std::uint8_t>(s);
      }
      if (stops(i)) before -= saved_;
    }
    std::size_t s = static_cast<std::size_t>(std::min_element(best.begin(), best.end()) - best.begin());
    const double sum = before + best[s];
    for (std::size_t i = legs_.size(); i-- > 0;) {
      step_[i] = s;
      s = from[i][s];
    }
    return std::max(0.0, sum);
  }

  const Toolpath& path_;
  const Machine& machine_;
  const std::size_t n_;
  bool jerk_ = false;
  double wider_ = 0.0, saved_ = 0.0;
  std::vector<BoundLeg> legs_;
  std::vector<CornerClass> classes_;
  std::vector<std::size_t> step_;
  CornerBound result_;
};

}  // namespace

CornerBound program_corner_bound(const Toolpath& path, const Machine& machine, double sample_period,
                                 double time_limit) {
  if (machine.axes.size() == path.dimensions())
    return ProgramCornerBound(path, machine, sample_period).bound(time_limit);
  CornerBound result;
  result.time = path.dwell_first;
  for (const auto& dwell : path.dwell) result.time += dwell.second;
  return result;
}

}  // namespace accdec
