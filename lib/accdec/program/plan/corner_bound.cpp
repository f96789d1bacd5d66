#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include <coin/ClpSimplex.hpp>

#include <accdec/program/plan/corner_bound.hpp>

namespace accdec {
namespace {

/// The most that an axis may accelerate by at any speed up to its limit: friction helps to brake.
double acceleration_most(const Axis& axis) {
  double most = axis.acceleration_max;
  if (axis.force_max < unlimited && axis.mass > 0.0 && (axis.damping == 0.0 || axis.velocity_max < unlimited)) {
    const double friction = axis.damping == 0.0 ? 0.0 : axis.damping * axis.velocity_max;
    most = std::min(most, (axis.force_max + friction) / axis.mass);
  }
  return most;
}

/// Rows low <= A x <= high over columns in [0, 1], to minimise cost x.
class Rows {
 public:
  explicit Rows(int columns) : columns_(columns) {}
  void add(const std::vector<std::pair<int, double>>& entries, double low, double high) {
    for (const auto& [column, value] : entries) {
      index_.push_back(column);
      value_.push_back(value);
    }
    start_.push_back(static_cast<CoinBigIndex>(index_.size()));
    low_.push_back(low);
    high_.push_back(high);
  }

  /// A lower bound of the least cost, from whatever multipliers the solver ends with; 0 if it fails. All costs are
  /// `cost`.
  double bound(double cost) const {
    const int rows = static_cast<int>(low_.size());
    const auto n = static_cast<std::size_t>(columns_);
    const std::vector<double> zeros(n, 0.0), ones(n, 1.0), costs(n, cost);
    CoinPackedMatrix matrix(false, columns_, rows, static_cast<CoinBigIndex>(index_.size()), value_.data(),
                            index_.data(), start_.data(), nullptr);
    ClpSimplex lp;
    lp.setLogLevel(0);
    // Rows are scaled already; Clp's own scaling ends with duals that do not hold for the rows as they are.
    lp.scaling(0);
    lp.loadProblem(matrix, zeros.data(), ones.data(), costs.data(), low_.data(), high_.data());
    lp.setMaximumSeconds(5.0);
    lp.dual();
    const double* dual = lp.dualRowSolution();
    if (dual == nullptr) return 0.0;
    // cost x >= sum of y (A x) + sum of min(0, cost - A'y), by the sides of the rows that the signs of y name.
    double bound = 0.0;
    std::vector<double> reduced = costs;
    for (int r = 0; r < rows; ++r) {
      const auto i = static_cast<std::size_t>(r);
      const double side = dual[r] > 0.0 ? low_[i] : high_[i];
      if (dual[r] == 0.0 || !(std::abs(side) < 1e29)) continue;
      bound += dual[r] * side;
      for (CoinBigIndex k = start_[i]; k < start_[i + 1]; ++k) {
        reduced[static_cast<std::size_t>(index_[static_cast<std::size_t>(k)])] -=
            dual[r] * value_[static_cast<std::size_t>(k)];
      }
    }
    for (const double value : reduced) bound += std::min(0.0, value);
    return bound;
  }

 private:
  int columns_;
  std::vector<int> index_;
  std::vector<double> value_, low_, high_;
  std::vector<CoinBigIndex> start_{0};
};

/// The linear program of one corner. Column k is the speed of leg 1 in period k over its feed, column count + k that
/// of leg 2; the corner's moment is the beginning of period `before`.
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

  /// Lost: all periods, less what both legs go in them over their feeds.
  double lost() const { return period_ * std::max(0.0, count_ + rows_.bound(-1.0)); }

 private:
  /// |sum of both legs' differences of the speed of axis a| <= most, inside the window: what it shows at its ends is
  /// left free.
  void add_differences(std::size_t a, const std::vector<double>& difference, double most) {
    if (!(most < unlimited)) return;
    const double in = corner_.in[a] * corner_.feed_in, out = corner_.out[a] * corner_.feed_out;
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

  /// Both legs together no faster than the higher feed, in the direction between them.
  void add_feed() {
    double cosine = 0.0;
    for (std::size_t a = 0; a < dimensions_; ++a) cosine += corner_.in[a] * corner_.out[a];
    const double half = std::sqrt(std::max(0.0, 0.5 * (1.0 + cosine))),
                 feed = std::max(corner_.feed_in, corner_.feed_out);
    for (int k = 0; k < count_ && half > 0.5; ++k) {
      rows_.add({{k, half * corner_.feed_in / feed}, {count_ + k, half * corner_.feed_out / feed}}, -COIN_DBL_MAX, 1.0);
    }
  }

  /// -p u1 + q u2 within the tolerance: p is what leg 1 has still to go at the moment, q what leg 2 has gone.
  void add_tolerance() {
    double cosine = 0.0;
    for (std::size_t a = 0; a < dimensions_; ++a) cosine += corner_.in[a] * corner_.out[a];
    cosine = std::clamp(cosine, -1.0, 1.0);
    const double sine = std::sqrt(1.0 - cosine * cosine);
    constexpr int sides = 64;
    // In units of the tolerance; an exact corner keeps a thousandth of a micrometre.
    const double tolerance = std::max(corner_.tolerance, 1e-9);
    for (int i = 0; i < sides; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / sides, x = std::cos(angle), y = std::sin(angle);
      const double along_in = -x, along_out = cosine * x + sine * y;
      std::vector<std::pair<int, double>> entries;
      for (int k = before_; k < count_; ++k) entries.emplace_back(k, along_in * corner_.feed_in * period_ / tolerance);
      for (int k = 0; k < before_; ++k) {
        entries.emplace_back(count_ + k, along_out * corner_.feed_out * period_ / tolerance);
      }
      rows_.add(entries, -COIN_DBL_MAX, 1.0);
    }
  }

  const BoundCorner& corner_;
  const std::size_t dimensions_;
  const double period_;
  const int before_, count_;
  Rows rows_;
};

/// What a leg can do by itself.
struct BoundLeg {
  std::vector<double> unit;
  double length = 0.0, feed = 0.0;
  double ramp = 0.0;  // s from rest to the feed at least
  bool long_enough = false;
};

BoundLeg bound_leg(const Toolpath& path, const Machine& machine, std::size_t b) {
  const std::size_t n = path.dimensions();
  const double* p = path.point(b);
  BoundLeg leg;
  for (std::size_t a = 0; a < n; ++a) leg.length = std::hypot(leg.length, p[n + a] - p[a]);
  leg.feed = leg.length / path.duration[b];
  double acceleration = unlimited, jerk = unlimited;
  for (std::size_t a = 0; a < n; ++a) {
    leg.unit.push_back((p[n + a] - p[a]) / leg.length);
    const double part = std::abs(leg.unit.back());
    if (part == 0.0) continue;
    leg.feed = std::min(leg.feed, machine.axes[a].velocity_max / part);
    acceleration = std::min(acceleration, acceleration_most(machine.axes[a]) / part);
    jerk = std::min(jerk, machine.axes[a].jerk_max / part);
  }
  leg.ramp = acceleration < unlimited ? leg.feed / acceleration : 0.0;
  if (jerk < unlimited) {
    leg.ramp = acceleration < unlimited && leg.feed >= acceleration * acceleration / jerk
                   ? leg.ramp + acceleration / jerk
                   : 2.0 * std::sqrt(leg.feed / jerk);
  }
  // From rest to the feed and back takes ramp seconds' way at the feed.
  leg.long_enough = leg.length >= leg.ramp * leg.feed * (1.0 - 1e-6);
  return leg;
}

/// Corners alike: directions, feeds and tolerance to nine digits.
std::vector<long long> class_of(const BoundLeg& in, const BoundLeg& out, double tolerance) {
  std::vector<long long> key;
  const auto add = [&](double value) { key.push_back(std::llround(value * 1e9)); };
  for (const double u : in.unit) add(u);
  for (const double u : out.unit) add(u);
  add(in.feed);
  add(out.feed);
  key.push_back(std::llround(tolerance * 1e12));
  return key;
}

}  // namespace

double corner_time_bound(const BoundCorner& corner, const Machine& machine, std::size_t dimensions,
                         double sample_period) {
  // Any period gives a bound; more than some 300 periods only take longer.
  const double period = std::max(sample_period, (corner.reach_in + corner.reach_out) / 300.0);
  return CornerLinearProgram(corner, machine, dimensions, period).lost();
}

CornerBound program_corner_bound(const Toolpath& path, const Machine& machine, double sample_period,
                                 double time_limit) {
  const auto start = std::chrono::steady_clock::now();
  CornerBound result;
  result.time = path.dwell_first;
  for (const auto& dwell : path.dwell) result.time += dwell.second;
  if (machine.axes.size() != path.dimensions()) return result;
  std::map<std::vector<long long>, double> solved;
  BoundLeg before;
  bool running = false;
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    BoundLeg leg = bound_leg(path, machine, b);
    result.time += leg.length / leg.feed;
    if (!running && leg.long_enough) result.time += 0.5 * leg.ramp;
    if (running && path.joint[b - 1] != Joint::straight) {
      ++result.corners;
      if (before.long_enough && leg.long_enough) {
        ++result.counted;
        const auto [entry, is_new] = solved.try_emplace(class_of(before, leg, path.tolerance[b - 1]), 0.0);
        const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
        if (is_new && spent.count() > time_limit) {
          result.complete = false;
        } else if (is_new) {
          BoundCorner corner{before.unit.data(), leg.unit.data(), before.feed,          leg.feed,
                             1.1 * before.ramp,  1.1 * leg.ramp,  path.tolerance[b - 1]};
          entry->second = corner_time_bound(corner, machine, path.dimensions(), sample_period);
          ++result.classes;
        }
        result.time += entry->second;
      }
    }
    running = path.joint[b] != Joint::stop;
    if (!running && leg.long_enough) result.time += 0.5 * leg.ramp;
    before = std::move(leg);
  }
  return result;
}

}  // namespace accdec
