#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <accdec/bounds/weighted_motion.hpp>

namespace accdec {

bool WeightedSection::jerk() const {
  return std::any_of(axes.begin(), axes.end(), [](const AxisLimits& axis) { return axis.jerk < unlimited; });
}

double WeightedSection::feed(std::size_t leg) const {
  const std::size_t first = leg > 0 ? leg - 1 : 0, last = std::min(leg + 1, legs.size() - 1);
  double most = 0.0;
  for (std::size_t i = first; i <= last; ++i) most = std::max(most, legs[i].feed);
  return most;
}

MotionWeights::MotionWeights(std::size_t axes, bool jerk, std::vector<std::vector<double>> shares)
    : axes_(axes), jerk_(jerk), shares_(std::move(shares)), begin_(1, 0) {
  for (std::size_t i = 0; i < legs(); ++i) begin_.push_back(k(i, pieces(i)));
  value.assign(begin_.back() + node(), 0.0);
}

namespace {

/// The mean of |linear function| between two values.
double mean(double a, double b) {
  const double both = std::abs(a) + std::abs(b);
  return a * b >= 0.0 ? 0.5 * both : 0.5 * (a * a + b * b) / both;
}

/// The least time of one leg by the weights.
class LegTimes {
 public:
  LegTimes(const WeightedSection& section, const MotionWeights& weights, std::size_t leg)
      : section_(section), w_(weights), leg_(leg), guess_(weights.value[weights.time(leg)]) {
    before_ = joint(0, leg > 0 ? leg - 1 : leg, section.before(leg));
    after_ = joint(w_.pieces(leg) - 1, leg + 1, section.legs[leg].tolerance);
    for (std::size_t k = 0; k < w_.pieces(leg); ++k) add_piece(k);
    const AxisVector ends = combined(0.5, before_.p, 0.5, after_.p);
    ways_ += dot(ends, section.legs[leg].way);
  }

  /// The least over all times.
  double least() const {
    constexpr double step = 1.05, longest = 6.0;
    double speed2 = 0.0;
    for (const auto& axis : section_.axes) speed2 += axis.velocity * axis.velocity;
    const auto& leg = section_.legs[leg_];
    const double way = norm(leg.way) - leg.tolerance - section_.before(leg_);
    double from = std::max(0.0, way / std::min(section_.feed(leg_), std::sqrt(speed2)));
    double least = unlimited;
    while (from < longest * guess_) {
      const double to = std::max(0.2 * guess_, step * from);
      least = std::min(least, between(from, to));
      from = to;
    }
    return std::min(least, beyond(from));
  }

 private:
  /// At most half of tolerance |f + 2 (1/h - 1/guess) p|, see weighted_time.
  struct End {
    double tolerance = 0.0;
    AxisVector p{}, f{};
  };
  /// A piece of an axis: A times its length, K at both ends, M' and J times |M|.
  struct Piece {
    double weight, k0, k1, slope, straight_slope;
  };

  AxisVector p_of(std::size_t leg, std::size_t piece) const {
    AxisVector p{};
    for (std::size_t a = 0; a < w_.axes(); ++a) p[a] = w_.value[w_.p(leg, piece) + a];
    return p;
  }
  End joint(std::size_t piece, std::size_t other, double tolerance) const {
    End end;
    end.p = p_of(leg_, piece);
    if (other == leg_ || other >= w_.legs()) return end;
    const AxisVector q = p_of(other, other < leg_ ? w_.pieces(other) - 1 : 0);
    end.tolerance = tolerance;
    end.f = combined(1.0 / guess_, end.p, -1.0 / w_.value[w_.time(other)], q);
    return end;
  }

  void add_piece(std::size_t piece) {
    const double length = w_.length(leg_, piece);
    const AxisVector p = p_of(leg_, piece);
    AxisVector left{};
    double by_axes = 0.0;
    for (std::size_t a = 0; a < w_.axes(); ++a) {
      const double k0 = w_.value[w_.k(leg_, piece) + a], k1 = w_.value[w_.k(leg_, piece + 1) + a];
      left[a] = k1 - k0 - length * p[a];
      if (left[a] != 0.0) by_axes += section_.axes[a].velocity * std::abs(left[a]);
      Piece part{section_.axes[a].acceleration * length, k0, k1, 0.0, 0.0};
      if (w_.jerk() && section_.axes[a].jerk < unlimited) {
        const double m0 = w_.value[w_.m(leg_, piece) + a], m1 = w_.value[w_.m(leg_, piece + 1) + a];
        part.slope = (m1 - m0) / length;
        jerk_ += section_.axes[a].jerk * length * mean(m0, m1);
        const double first = w_.value[w_.m(leg_, 0) + a], last = w_.value[w_.m(leg_, w_.pieces(leg_)) + a];
        part.straight_slope = last - first;
        if (piece == 0) straight_jerk_ += section_.axes[a].jerk * mean(first, last);
      }
      pieces_.push_back(part);
    }
    const double whole = norm(left);
    feed_ += whole > 0.0 ? std::min(section_.feed(leg_) * whole, by_axes) : 0.0;
    if (piece == 0) return;
    const AxisVector change = combined(1.0, p_of(leg_, piece - 1), -1.0, p);
    const auto& leg = section_.legs[leg_];
    ways_ -= 0.5 * std::abs(dot(change, leg.way)) + leg.radius * norm(change);
  }

  double limits(double time, bool straight) const {
    double sum = time * (straight ? straight_jerk_ : jerk_);
    for (const Piece& piece : pieces_) {
      const double slope = straight ? piece.straight_slope : piece.slope;
      sum += piece.weight * mean(time * piece.k0 + slope, time * piece.k1 + slope);
    }
    return sum;
  }
  /// How fast that grows at most.
  double steepest(bool straight) const {
    double sum = straight ? straight_jerk_ : jerk_;
    for (const Piece& piece : pieces_) sum += piece.weight * mean(piece.k0, piece.k1);
    return sum;
  }
  double joints(double rate) const {
    double sum = 0.0;
    for (const End* end : {&before_, &after_}) {
      if (end->tolerance > 0.0)
        sum += 0.5 * end->tolerance * norm(combined(1.0, end->f, 2.0 * (rate - 1.0 / guess_), end->p));
    }
    return sum;
  }
  /// Least of sum + slope h + part/h; `to` may be unlimited if the slope is not below 0.
  static double least(double sum, double slope, double part, double from, double to) {
    if (from == 0.0 && part < 0.0) return -unlimited;
    const auto at = [&](double h) { return sum + (slope != 0.0 ? slope * h : 0.0) + (part != 0.0 ? part / h : 0.0); };
    const double value = std::min(at(from), at(to));
    if (!(slope > 0.0 && part > 0.0)) return value;
    return std::min(value, at(std::clamp(std::sqrt(part / slope), from, to)));
  }
  double between(double from, double to) const {
    // In 1/h the joints are below their chord; from 0 on below a line of their largest slope.
    double most = before_.tolerance * norm(before_.p) + after_.tolerance * norm(after_.p);
    const double at = joints(1.0 / to);
    if (from > 0.0) most = (joints(1.0 / from) - at) / (1.0 / from - 1.0 / to);
    double best = -unlimited;
    for (const bool straight : {false, true}) {
      if (straight && jerk_ == 0.0) break;
      const double low = limits(from, straight), slope = (limits(to, straight) - low) / (to - from);
      const double sum = -feed_ - low + slope * from - at + most / to;
      best = std::max(best, least(sum, 1.0 - slope, ways_ - most, from, to));
    }
    return best;
  }
  double beyond(double from) const {
    const double at = joints(1.0 / from), none = joints(0.0), slope = (at - none) * from;
    double best = -unlimited;
    for (const bool straight : {false, true}) {
      const double grows = 1.0 - steepest(straight);
      if (grows < 0.0) continue;
      const double sum = -feed_ - limits(from, straight) + (1.0 - grows) * from - none;
      best = std::max(best, least(sum, grows, ways_ - slope, from, unlimited));
    }
    return best;
  }

  const WeightedSection& section_;
  const MotionWeights& w_;
  const std::size_t leg_;
  const double guess_;
  End before_, after_;
  std::vector<Piece> pieces_;
  double feed_ = 0.0, ways_ = 0.0, jerk_ = 0.0, straight_jerk_ = 0.0;
};

}  // namespace

double weighted_time(const WeightedSection& section, const MotionWeights& weights) {
  double sum = 0.0;
  for (std::size_t i = 0; i < section.legs.size(); ++i) sum += LegTimes(section, weights, i).least();
  return sum;
}

}  // namespace accdec
