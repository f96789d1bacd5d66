#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include <accdec/bounds/bound_leg.hpp>
#include <accdec/bounds/corner_bound.hpp>
#include <accdec/bounds/filter_bound.hpp>
#include <accdec/machine/limits.hpp>

namespace accdec {
namespace {

constexpr int periods = 60;

/// Corners of the same directions, feeds and tolerance.
struct CornerClass {
  std::size_t leg = 0;  // before the first of them
  double tolerance = 0.0;
  double way = 0.0;          // upper bound on what cutting the corner saves of either leg
  std::vector<double> loss;  // at least, by the steps before and after; empty until one of them is solved
  std::vector<bool> solved;  // the same
};

class ProgramCornerBound {
 public:
  ProgramCornerBound(const Toolpath& path, const Machine& machine, double sample_period)
      : path_(path), machine_(machine), n_(path.dimensions()) {
    const SplineSlack slack = spline_slack(machine, sample_period);
    wider_ = slack.wider + path.narrowed, saved_ = slack.saved;
    make_legs();
    make_classes();
  }

  CornerBound bound(const Deadline& deadline) {
    // Starts with the speeds that the legs would reach from rest to rest.
    for (std::size_t i = 0; i < legs_.size(); ++i) step_[i] = legs_[i].expected_step();
    // The least sum with the present bounds of the corners, until it uses only solved linear programs.
    for (bool again = !legs_.empty(); again;) {
      again = false;
      if (result_.classes > 0 || result_.counted == 0) result_.time = least_sum();
      for (std::size_t i = 0; i + 1 < legs_.size(); ++i) {
        if (legs_[i].corner_class < 0) continue;
        CornerClass& c = classes_[static_cast<std::size_t>(legs_[i].corner_class)];
        const std::size_t s = step_[i], t = step_[i + 1];
        if (s + 1 == bound_steps || t + 1 == bound_steps || (!c.solved.empty() && c.solved[s * bound_steps + t]))
          continue;
        if (result_.classes == corner_programs_max || deadline.over()) {
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

  bool chord(std::size_t leg) const { return is_chord(path_, legs_[leg].first) || is_chord(path_, legs_[leg].last); }
  bool stops(std::size_t leg) const { return path_.joint[legs_[leg].last] == Joint::stop; }

  /// Length of each leg that a parabola needs to cut the corner by its tolerance; none at rest.
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
      return !chord(i) && legs_[i].ramp(legs_[i].feed) > 0.0 &&
             legs_[i].length >= 1.5 * (cuts[i] + (i > 0 ? cuts[i - 1] : 0.0));
    };
    std::map<std::vector<long long>, int> known;
    for (std::size_t i = 0; i < legs_.size(); ++i) {
      const double rest = chord(i) ? 0.0 : 1.0;
      if (i == 0 || stops(i - 1)) legs_[i].rests += rest;
      if (stops(i)) {
        legs_[i].rests += rest;
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

  /// Corners are in one class if their directions, feeds and tolerances agree to nine digits.
  int class_of(std::size_t i, const std::vector<double>& in, const std::vector<double>& out,
               std::map<std::vector<long long>, int>& known) {
    std::vector<long long> key;
    key.reserve(2 * n_ + 3);
    for (const double u : in) key.push_back(std::llround(u * 1e9));
    for (const double u : out) key.push_back(std::llround(u * 1e9));
    for (const double feed : {legs_[i].feed, legs_[i + 1].feed}) key.push_back(std::llround(feed * 1e9));
    const double tolerance = path_.tolerance[legs_[i].last] + wider_;
    key.push_back(std::llround(tolerance * 1e12));
    const auto [entry, is_new] = known.try_emplace(std::move(key), static_cast<int>(classes_.size()));
    if (is_new) {
      double cosine = 0.0;
      for (std::size_t a = 0; a < n_; ++a) cosine += in[a] * out[a];
      const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
      const double way = cosine > 0.0 ? tolerance / std::max(sine, 1e-12) : tolerance;
      const double shorter = std::min(legs_[i].length, legs_[i + 1].length);
      classes_.push_back({i, tolerance, std::min(way, shorter + tolerance), {}, {}});
    }
    return entry->second;
  }

  /// A bound before any linear program, by the leg before (0) or after (1) the corner and its step. At the corner's
  /// moment the legs have p to go and q gone, with |q u2 - p u1| <= e. So moving both at once saves at most p/v1 +
  /// q/v2.
  double saving(const CornerClass& c, std::size_t after, std::size_t s) const {
    return c.way / (legs_[c.leg + after].feed * step_part(s));
  }

  void solve(CornerClass& c, std::size_t s, std::size_t t) {
    const BoundLeg &leg_in = legs_[c.leg], &leg_out = legs_[c.leg + 1];
    std::vector<double> u, w;
    unit(leg_in.last, u);
    unit(leg_out.first, w);
    const double in = leg_in.feed * step_part(s), out = leg_out.feed * step_part(t);
    const BoundCorner corner{u.data(),
                             w.data(),
                             in,
                             out,
                             std::max(leg_in.feed, leg_out.feed),
                             1.1 * leg_in.ramp(in),
                             1.1 * leg_out.ramp(out),
                             c.tolerance};
    const CornerDual loss = corner_loss(corner, machine_, n_, periods);
    if (c.loss.empty()) {
      c.solved.resize(bound_steps * bound_steps);
      c.loss.resize(bound_steps * bound_steps);
      for (std::size_t k = 0; k < c.loss.size(); ++k)
        c.loss[k] = -saving(c, 0, k / bound_steps) - saving(c, 1, k % bound_steps);
    }
    for (std::size_t i = 0; i + 1 < bound_steps; ++i) {
      for (std::size_t j = 0; j + 1 < bound_steps; ++j) {
        double& known = c.loss[i * bound_steps + j];
        known = std::max(known, loss.at(step_part(i) / step_part(s), step_part(j) / step_part(t)));
      }
    }
    c.solved[s * bound_steps + t] = true;
    ++result_.classes;
  }

  /// The least sum over all steps of all legs; `step_` becomes those of the least.
  double least_sum() {
    std::vector<std::array<std::uint8_t, bound_steps>> from(legs_.size());
    std::array<double, bound_steps> best{};
    double before = path_.dwells();  // and of earlier sections between stops
    for (std::size_t i = 0; i < legs_.size(); ++i) {
      std::array<double, bound_steps> earlier = best;
      const int corner = i > 0 ? legs_[i - 1].corner_class : -1;
      const CornerClass* c = corner < 0 ? nullptr : &classes_[static_cast<std::size_t>(corner)];
      if (c != nullptr && c->loss.empty()) {
        // For any step after it.
        for (std::size_t k = 0; k < bound_steps; ++k) earlier[k] -= saving(*c, 0, k);
      }
      const std::size_t least =
          static_cast<std::size_t>(std::min_element(earlier.begin(), earlier.end()) - earlier.begin());
      for (std::size_t t = 0; t < bound_steps; ++t) {
        std::size_t s = least;
        double sum = earlier[least];
        if (c != nullptr && c->loss.empty()) sum -= saving(*c, 1, t);
        if (c != nullptr && !c->loss.empty()) {
          const double* loss = c->loss.data();
          sum = earlier[s] + loss[s * bound_steps + t];
          for (std::size_t k = 0; k < bound_steps; ++k) {
            if (earlier[k] + loss[k * bound_steps + t] < sum) sum = earlier[s = k] + loss[k * bound_steps + t];
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
  double wider_ = 0.0, saved_ = 0.0;
  std::vector<BoundLeg> legs_;
  std::vector<CornerClass> classes_;
  std::vector<std::size_t> step_;
  CornerBound result_;
};

}  // namespace

CornerBound program_corner_bound(const Toolpath& path, const Machine& machine, double sample_period,
                                 const Deadline& deadline) {
  const Machine of_path = program_machine(machine, path);
  if (!limits_jerk(of_path)) return ProgramCornerBound(path, of_path, sample_period).bound(deadline);
  CornerBound bound = ProgramCornerBound(path, of_path, sample_period).bound(deadline.within(0.5 * deadline.left()));
  const Machine freer = without_jerk_limits(of_path);
  CornerBound other = ProgramCornerBound(path, freer, sample_period).bound(deadline);
  // Corners that count for either: which of them is the larger bound depends on the deadline.
  bound.counted = other.counted = std::max(bound.counted, other.counted);
  return other.time > bound.time ? other : bound;
}

}  // namespace accdec
