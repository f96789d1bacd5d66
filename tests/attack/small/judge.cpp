#include "judge.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "game.hpp"
#include "physics.hpp"

namespace accdec::attack {
namespace {

constexpr double margin = 1e-6;
constexpr int nodes_max = 3000;

/// The range that a node of the search still allows: velocities now of a power limit, or directions of a speed limit.
struct Interval {
  double low, high;
};

/// Taps that are free: all, or one of each pair of a symmetric filter.
class Variables {
 public:
  Variables(std::size_t taps, bool symmetric) : taps_(taps), symmetric_(symmetric) {}
  std::size_t size() const { return symmetric_ ? (taps_ + 1) / 2 : taps_; }
  std::vector<double> fold(const std::vector<double>& row) const {
    if (!symmetric_) return row;
    std::vector<double> folded(size());
    for (std::size_t i = 0; i < size(); ++i) folded[i] = 0.5 * (row[i] + row[taps_ - 1 - i]);
    return folded;
  }
  std::vector<double> unfold(const std::vector<double>& x) const {
    if (!symmetric_) return x;
    std::vector<double> taps(taps_, 0.0);
    for (std::size_t i = 0; i < x.size(); ++i) taps[i] += 0.5 * x[i], taps[taps_ - 1 - i] += 0.5 * x[i];
    return taps;
  }

 private:
  std::size_t taps_;
  bool symmetric_;
};

class Search {
 public:
  Search(const Task& task, int order, const std::vector<int>& delays)
      : physics_(task, order, delays),
        variables_(static_cast<std::size_t>(order) + 1, task.design.symmetric),
        sampled_(std::any_of(task.machine.modes.begin(), task.machine.modes.end(),
                             [](const Mode& m) { return m.frequency_high > m.frequency_low; })) {}

  Verdict run() {
    Node node{Game(variables_.size(), 4.0 * physics_.most + 4.0), {}, whole_powers(), whole_speeds()};
    return visit(node);
  }

 private:
  struct Node {
    Game game;
    std::vector<std::size_t> nearest;  ///< sample, of the first errors
    std::vector<Interval> powers, speeds;
  };

  /// Tightens the node's game until it is refuted, a filter is found, or it must be split.
  Verdict visit(Node& node) {
    if (++nodes_ > nodes_max) return Verdict::undecided;
    for (int round = 0; round < 60; ++round) {
      if (!node.game.solve()) return Verdict::undecided;
      if (node.game.lower() > 1.0 + margin) return Verdict::no;
      const std::vector<double> taps = variables_.unfold(node.game.taps());
      if (worst_use(physics_, taps) < 1.0 - (sampled_ ? 1e-4 : margin)) return Verdict::yes;
      if (cut(node, taps)) continue;
      return split(node, taps);
    }
    return Verdict::undecided;
  }

  void add(Node& node, const std::vector<double>& row) { node.game.add(variables_.fold(row).data()); }
  /// A row of a limit that is used more than the game knows.
  bool offer(Node& node, const std::vector<double>& row, const std::vector<double>& taps) {
    if (dot(row.data(), taps) <= std::max(1.0 - margin, node.game.lower() + 1e-9)) return false;
    add(node, row);
    return true;
  }
  bool offer_tangent(Node& node, const double* x, const double* y, double bound, const std::vector<double>& taps) {
    const double a = dot(x, taps), b = dot(y, taps), length = std::hypot(a, b);
    if (length <= bound * std::max(1.0 - margin, node.game.lower() + 1e-9)) return false;
    std::vector<double> row(taps.size());
    for (std::size_t i = 0; i < taps.size(); ++i) row[i] = (a * x[i] + b * y[i]) / (length * bound);
    add(node, row);
    return true;
  }
  /// direction . velocity >= least
  bool offer_least(Node& node, const std::vector<double>& direction, double least, const std::vector<double>& taps) {
    double size = std::max(1e-6, std::abs(least));  // m/s; less is rounding
    for (const double g : direction) size = std::max(size, std::abs(g));
    std::vector<double> row(direction.size());
    for (std::size_t i = 0; i < row.size(); ++i) row[i] = 1.0 + (least - direction[i]) / size;
    return offer(node, row, taps);
  }

  bool cut(Node& node, const std::vector<double>& taps) {
    bool any = cut_linear(node, taps);
    if (physics_.cones.size() > 0) {
      std::size_t worst = 0;
      double most = 0.0;
      for (std::size_t i = 0; i < physics_.cones.size(); i += 2) {
        const double length = std::hypot(dot(physics_.cones.row(i), taps), dot(physics_.cones.row(i + 1), taps));
        if (length > most) most = length, worst = i;
      }
      any |= offer_tangent(node, physics_.cones.row(worst), physics_.cones.row(worst + 1), 1.0, taps);
    }
    for (std::size_t j = 0; j < node.nearest.size(); ++j) {
      const ErrorLimit& error = physics_.errors[j];
      const std::size_t k = 2 * node.nearest[j];
      any |= offer_tangent(node, error.positions.row(k), error.positions.row(k + 1), error.cut_bound, taps);
    }
    for (std::size_t i = 0; i < node.powers.size(); ++i) any |= cut_power(node, i, taps);
    for (std::size_t i = 0; i < node.speeds.size(); ++i) any |= cut_speed(node, i, taps);
    return any;
  }

  /// The most used rows; what they do not imply comes in the next round.
  bool cut_linear(Node& node, const std::vector<double>& taps) {
    std::vector<std::pair<double, std::size_t>> used;
    for (std::size_t i = 0; i < physics_.linear.size(); ++i) {
      const double use = std::abs(dot(physics_.linear.row(i), taps));
      if (use > std::max(1.0 - margin, node.game.lower() + 1e-9)) used.emplace_back(-use, i);
    }
    const std::size_t most = std::min<std::size_t>(used.size(), 4);
    std::partial_sort(used.begin(), used.begin() + static_cast<std::ptrdiff_t>(most), used.end());
    for (std::size_t u = 0; u < most; ++u) {
      const double* from = physics_.linear.row(used[u].second);
      std::vector<double> row(from, from + taps.size());
      if (dot(from, taps) < 0.0) {
        for (double& value : row) value = -value;
      }
      add(node, row);
    }
    return most > 0;
  }

  /// Both velocities are turned so that `now` is positive. For power, before >= (A now - P / now) / B, which is concave
  /// in now. For regeneration, before <= (A now + R / now) / B, which is convex. The cut is the chord of this curve.
  bool cut_power(Node& node, std::size_t i, const std::vector<double>& taps) {
    const PowerLimit& limit = physics_.powers[i];
    const Interval in = node.powers[i];
    const std::vector<double> now = velocity(limit.now), before = velocity(limit.before);
    bool any = offer_least(node, now, in.low, taps) | offer_least(node, scaled(now, -1.0), -in.high, taps);
    if (in.low < 0.0 && in.high > 0.0) return any;
    const double turn = in.high > 0.0 ? 1.0 : -1.0;
    const double low = std::min(std::abs(in.low), std::abs(in.high)),
                 high = std::max(std::abs(in.low), std::abs(in.high));
    if (limit.of_before == 0.0) {  // a load without mass: of_now now^2 <= P
      if (limit.sign < 0.0) return any;
      return any | offer_least(node, scaled(now, -turn), -std::sqrt(limit.bound / limit.of_now), taps);
    }
    if (low <= 0.0) return any;
    const auto f = [&](double x) { return (limit.of_now * x - limit.sign * limit.bound / x) / limit.of_before; };
    const double slope = high > low ? (f(high) - f(low)) / (high - low) : 0.0;
    // sign (before - slope now) >= sign (f(low) - slope low)
    std::vector<double> direction(now.size());
    for (std::size_t t = 0; t < now.size(); ++t) direction[t] = limit.sign * turn * (before[t] - slope * now[t]);
    return any | offer_least(node, direction, limit.sign * (f(low) - slope * low), taps);
  }

  /// The velocity lies between two directions, and there beyond the chord of the circle of the smallest speed.
  bool cut_speed(Node& node, std::size_t i, const std::vector<double>& taps) {
    const SpeedLimit& limit = physics_.speeds[i];
    const Interval in = node.speeds[i];
    const auto along = [&](double angle) {
      std::vector<double> v = scaled(velocity(limit.x), std::cos(angle));
      const std::vector<double> y = velocity(limit.y);
      for (std::size_t t = 0; t < v.size(); ++t) v[t] += std::sin(angle) * y[t];
      return v;
    };
    const double middle = 0.5 * (in.low + in.high), half = 0.5 * (in.high - in.low);
    bool any = offer_least(node, along(middle), limit.bound * std::cos(half), taps);
    any |= offer_least(node, along(in.low + 0.5 * std::numbers::pi), 0.0, taps);
    return any | offer_least(node, along(in.high - 0.5 * std::numbers::pi), 0.0, taps);
  }

  Verdict split(Node& node, const std::vector<double>& taps) {
    if (node.nearest.size() < physics_.errors.size()) return over_samples(node, taps);
    double worst = 1.0 - margin;
    std::optional<std::pair<bool, std::size_t>> where;
    for (std::size_t i = 0; i < node.powers.size(); ++i) {
      if (const double use = power_use(physics_, physics_.powers[i], taps); use > worst) worst = use, where = {true, i};
    }
    for (std::size_t i = 0; i < node.speeds.size(); ++i) {
      if (const double use = speed_use(physics_, physics_.speeds[i], taps); use > worst)
        worst = use, where = {false, i};
    }
    if (!where) return Verdict::undecided;
    return halves(node, where->first ? &Node::powers : &Node::speeds, where->second, split_point(node, *where, taps));
  }

  /// One branch for each sample at which the next corner may be nearest.
  Verdict over_samples(const Node& node, const std::vector<double>& taps) {
    const ErrorLimit& error = physics_.errors[node.nearest.size()];
    std::vector<std::pair<double, std::size_t>> samples;
    for (std::size_t k = error.first; k <= error.last; ++k) samples.emplace_back(error_at(error, k, taps), k);
    std::sort(samples.begin(), samples.end());
    Verdict verdict = Verdict::no;
    for (const auto& [distance, k] : samples) {
      Node branch = node;
      branch.nearest.push_back(k);
      const Verdict found = visit(branch);
      if (found == Verdict::yes) return found;
      if (found == Verdict::undecided) verdict = found;
    }
    return verdict;
  }

  double split_point(const Node& node, std::pair<bool, std::size_t> where, const std::vector<double>& taps) const {
    const auto [power, i] = where;
    const Interval in = power ? node.powers[i] : node.speeds[i];
    if (power && in.low < 0.0 && in.high > 0.0) return 0.0;
    const SpeedLimit* s = power ? nullptr : &physics_.speeds[i];
    const double at =
        power ? dot(physics_.velocities.row(physics_.powers[i].now), taps)
              : std::atan2(dot(physics_.velocities.row(s->y), taps), dot(physics_.velocities.row(s->x), taps));
    const double width = in.high - in.low;
    return std::clamp(at, in.low + 0.2 * width, in.high - 0.2 * width);
  }

  Verdict halves(const Node& node, std::vector<Interval> Node::*intervals, std::size_t i, double at) {
    Verdict verdict = Verdict::no;
    for (const bool upper : {false, true}) {
      Node branch = node;
      Interval& in = (branch.*intervals)[i];
      (upper ? in.low : in.high) = at;
      const Verdict found = visit(branch);
      if (found == Verdict::yes) return found;
      if (found == Verdict::undecided) verdict = found;
    }
    return verdict;
  }

  std::vector<double> velocity(std::size_t i) const {
    const double* from = physics_.velocities.row(i);
    return {from, from + physics_.velocities.taps};
  }
  static std::vector<double> scaled(std::vector<double> v, double by) {
    for (double& x : v) x *= by;
    return v;
  }
  /// Every velocity is a mean of the commands that its taps see.
  std::vector<Interval> whole_powers() const {
    std::vector<Interval> whole;
    for (const PowerLimit& limit : physics_.powers) {
      const std::vector<double> now = velocity(limit.now);
      const auto [low, high] = std::minmax_element(now.begin(), now.end());
      whole.push_back({*low, *high});
    }
    return whole;
  }
  std::vector<Interval> whole_speeds() const {
    std::vector<Interval> whole;
    for (const SpeedLimit& limit : physics_.speeds) whole.push_back({0.0, limit.turn});
    return whole;
  }

  Physics physics_;
  Variables variables_;
  bool sampled_;
  int nodes_ = 0;
};

/// Delays from the first on, every corner's from 0 to two more than the order and the response: more change nothing.
class Enumeration {
 public:
  Enumeration(const Task& task, double samples) : task_(task), samples_(samples) {}

  Verdict run() {
    delays_.assign(task_.corners.size(), 0);
    return corner(0);
  }

 private:
  double cost_of(int order) const { return cost(task_, order, delays_); }
  bool shorter(int order) const { return cost_of(order) < samples_ - 1e-9; }

  Verdict corner(std::size_t j) {
    if (j == delays_.size()) return orders();
    Verdict verdict = Verdict::no;
    const int given = task_.corners[j].delay.value_or(-1);
    for (int d = std::max(0, given);
         d <= (given >= 0 ? given : task_.design.order_max + 2 + response_order(task_) + latency_of(task_)); ++d) {
      delays_[j] = d;
      std::fill(delays_.begin() + static_cast<std::ptrdiff_t>(j) + 1, delays_.end(), 0);
      if (!shorter(task_.design.order_min)) break;
      const Verdict found = corner(j + 1);
      if (found == Verdict::yes) return found;
      if (found == Verdict::undecided) verdict = found;
    }
    return verdict;
  }

  /// A filter of a smaller order is one of a larger with taps of zero, unless it has to be symmetric.
  Verdict orders() {
    int most = task_.design.order_min - 1;
    while (most < task_.design.order_max && shorter(most + 1)) ++most;
    const int least = task_.design.symmetric ? task_.design.order_min : most;
    Verdict verdict = Verdict::no;
    for (int order = most; order >= std::max(least, task_.design.order_min); --order) {
      const int useful = order + 2 + response_order(task_) + latency_of(task_);
      const bool longer_than_useful = std::any_of(delays_.begin(), delays_.end(), [&](int d) { return d > useful; });
      const bool given = std::any_of(task_.corners.begin(), task_.corners.end(),
                                     [](const TaskCorner& c) { return c.delay.has_value(); });
      if ((longer_than_useful && !given) || !may_have_width(task_, order, delays_)) continue;
      const Verdict found = exists(task_, order, delays_);
      if (found == Verdict::yes) return found;
      if (found == Verdict::undecided) verdict = found;
    }
    return verdict;
  }

  const Task& task_;
  double samples_;
  std::vector<int> delays_;
};

}  // namespace

double cost(const Task& task, int order, const std::vector<int>& delays) {
  double weights = 0.0, waits = 0.0;
  for (std::size_t j = 0; j < delays.size(); ++j) {
    weights += task.corners[j].weight;
    waits += task.corners[j].weight * delays[j];
  }
  return waits + (task.design.objective == Objective::cycle ? task.design.runs : weights) * (order + 1.0);
}

Verdict exists(const Task& task, int order, const std::vector<int>& delays) {
  return may_have_width(task, order, delays) ? Search(task, order, delays).run() : Verdict::no;
}

Verdict shorter_exists(const Task& task, double samples) {
  return Enumeration(task, samples).run();
}

}  // namespace accdec::attack
