#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <accdec/plan/along/path_speed.hpp>

namespace accdec {
namespace {

constexpr double unbounded = std::numeric_limits<double>::infinity();

/// From rest at a constant jerk, u grows as t^3 and x as t^4. With nodes at even times, the differences of cells then
/// give these parts of that jerk at the first nodes.
constexpr std::array<double, 4> part_near_rest{0.642857, 0.885205, 0.946188, 0.969};

/// A use of a bound, |value| < 1, with its derivatives by up to three neighbouring unknowns.
struct Use {
  double value = 0.0;
  std::size_t from = 0;  // node of the first
  std::array<double, 3> gradient{};
};

class Barrier {
 public:
  Barrier(const PathSpeed& problem) : p_(problem), n_(problem.node.size()) {}

  /// time + mu (sum of barriers); infinite outside.
  double merit(const std::vector<double>& x, double mu) const {
    double sum = 0.0;
    for (std::size_t i = 1; i + 1 < n_; ++i) {
      if (!(x[i] > 0.0 && x[i] < p_.cap[i])) return unbounded;
      sum -= std::log1p(-x[i] / p_.cap[i]);
    }
    bool inside = true;
    each_use(x, [&](const Use& use) {
      const double room = 1.0 - use.value * use.value;
      if (!(room > 0.0))
        inside = false;
      else
        sum -= std::log(room);
      return inside;
    });
    return inside ? p_.time(x) + mu * sum : unbounded;
  }

  /// One Newton step with backtracking. Returns the decrease that it promised; 0 where it does not get on.
  double step(std::vector<double>& x, double mu) {
    assemble(x, mu);
    direction_ = gradient_;
    for (double& d : direction_) d = -d;
    if (!solve()) return 0.0;
    double slope = 0.0;
    for (std::size_t i = 1; i + 1 < n_; ++i) slope += gradient_[i] * direction_[i];
    const double before = merit(x, mu);
    std::vector<double> trial = x;
    for (double length = 1.0; length > 1e-6; length *= 0.5) {
      for (std::size_t i = 1; i + 1 < n_; ++i) trial[i] = x[i] + length * direction_[i];
      if (!(merit(trial, mu) <= before + 0.05 * length * slope)) continue;
      x = trial;
      return -slope;
    }
    return 0.0;
  }

  template <class Take>
  void each_use(const std::vector<double>& x, const Take& take) const {
    for (std::size_t a = 0; a < p_.axes; ++a) {
      if (p_.acceleration_max[a] < unbounded && !accelerations(x, a, take)) return;
      if (p_.jerk_max[a] < unbounded && !jerks(x, a, take)) return;
    }
  }

 private:
  /// Acceleration of an axis in the middle of cell c, and its derivatives by the squared speeds at both ends.
  double acceleration(const std::vector<double>& x, std::size_t c, std::size_t a, double& low, double& high) const {
    const double along = p_.first[c * p_.axes + a] / (2.0 * (p_.node[c + 1] - p_.node[c]));
    const double across = 0.5 * p_.second[c * p_.axes + a];
    low = across - along;
    high = across + along;
    return low * x[c] + high * x[c + 1];
  }
  template <class Take>
  bool accelerations(const std::vector<double>& x, std::size_t a, const Take& take) const {
    const double rate = 1.0 / p_.acceleration_max[a];
    for (std::size_t c = 0; c + 1 < n_; ++c) {
      Use use;
      double low = 0.0, high = 0.0;
      use.value = rate * acceleration(x, c, a, low, high);
      use.from = c;
      use.gradient = {rate * low, rate * high, 0.0};
      if (!take(use)) return false;
    }
    return true;
  }
  template <class Take>
  bool jerks(const std::vector<double>& x, std::size_t a, const Take& take) const {
    double low = 0.0, high = 0.0, before_low = 0.0, before_high = 0.0;
    double before = acceleration(x, 0, a, before_low, before_high);
    for (std::size_t i = 1; i + 1 < n_; ++i) {
      const double now = acceleration(x, i, a, low, high);
      const double rate = 2.0 / ((p_.node[i + 1] - p_.node[i - 1]) * p_.jerk_max[a] * near_rest(i));
      const double speed = std::sqrt(x[i]), change = rate * (now - before);
      Use use;
      use.value = speed * change;
      use.from = i - 1;
      use.gradient = {-speed * rate * before_low, speed * rate * (low - before_high) + 0.5 * change / speed,
                      speed * rate * high};
      if (!take(use)) return false;
      before = now;
      before_low = low;
      before_high = high;
    }
    return true;
  }
  double near_rest(std::size_t i) const {
    const std::size_t end = std::min(i, n_ - 1 - i);
    return end <= part_near_rest.size() ? part_near_rest[end - 1] : 1.0;
  }

  void assemble(const std::vector<double>& x, double mu) {
    gradient_.assign(n_, 0.0);
    matrix_.assign(n_, {});
    for (std::size_t c = 0; c + 1 < n_; ++c) {
      const double va = std::sqrt(x[c]), vb = std::sqrt(x[c + 1]), sum = va + vb;
      const double way = 2.0 * (p_.node[c + 1] - p_.node[c]);
      add(x, c, way / (sum * sum), {va > 0.0 ? -0.5 / va : 0.0, vb > 0.0 ? -0.5 / vb : 0.0, 0.0},
          4.0 * way / (sum * sum * sum) * 0.5);
      for (const auto& [i, v] : {std::pair{c, va}, std::pair{c + 1, vb}})
        if (v > 0.0) matrix_[i][0] += way / (sum * sum) * 0.25 / (v * v * v);
    }
    for (std::size_t i = 1; i + 1 < n_; ++i) {
      const double room = p_.cap[i] - x[i];
      gradient_[i] += mu / room;
      matrix_[i][0] += mu / (room * room);
    }
    each_use(x, [&](const Use& use) {
      const double room = 1.0 - use.value * use.value;
      add(x, use.from, mu * 2.0 * use.value / room, use.gradient,
          mu * 2.0 * (1.0 + use.value * use.value) / (room * room));
      return true;
    });
  }
  /// Adds a function of a use: its first derivative by the use and its curvature.
  void add(const std::vector<double>& x, std::size_t from, double derivative, const std::array<double, 3>& g,
           double curvature) {
    for (std::size_t i = 0; i < 3 && from + i < x.size(); ++i) {
      gradient_[from + i] += derivative * g[i];
      for (std::size_t j = 0; j <= i; ++j) matrix_[from + i][i - j] += curvature * g[i] * g[j];
    }
  }
  /// Solves for the direction in place; both ends rest.
  bool solve() {
    for (const std::size_t end : {std::size_t{0}, n_ - 1}) {
      matrix_[end] = {1.0, 0.0, 0.0};
      direction_[end] = 0.0;
      for (std::size_t i = end + 1; i < std::min(n_, end + 3); ++i) matrix_[i][i - end] = 0.0;
    }
    for (std::size_t i = 0; i < n_; ++i) {
      auto& row = matrix_[i];
      if (i >= 2) row[2] /= matrix_[i - 2][0];
      if (i >= 1) row[1] = (row[1] - (i >= 2 ? row[2] * matrix_[i - 1][1] : 0.0)) / matrix_[i - 1][0];
      const double pivot = row[0] - row[1] * row[1] - row[2] * row[2];
      if (!(pivot > 0.0)) return false;
      row[0] = std::sqrt(pivot);
      if (i >= 1) direction_[i] -= row[1] * direction_[i - 1];
      if (i >= 2) direction_[i] -= row[2] * direction_[i - 2];
      direction_[i] /= row[0];
    }
    for (std::size_t i = n_; i-- > 0;) {
      direction_[i] /= matrix_[i][0];
      if (i >= 1) direction_[i - 1] -= matrix_[i][1] * direction_[i];
      if (i >= 2) direction_[i - 2] -= matrix_[i][2] * direction_[i];
    }
    return true;
  }

  const PathSpeed& p_;
  const std::size_t n_;
  std::vector<double> gradient_, direction_;
  std::vector<std::array<double, 3>> matrix_;  // of every node: with itself, the one before, the one before that
};

}  // namespace

bool PathSpeed::holds(const std::vector<double>& x) const {
  constexpr double most = 0.98;
  for (std::size_t i = 1; i + 1 < node.size(); ++i) {
    if (!(x[i] > 0.0 && x[i] < most * cap[i])) return false;
  }
  bool inside = true;
  Barrier(*this).each_use(x, [&](const Use& use) { return inside = inside && std::abs(use.value) < most; });
  return inside;
}

bool PathSpeed::solve(std::vector<double>& x, double most, const std::function<bool()>& stop) const {
  Barrier barrier(*this);
  const double bounds = static_cast<double>(node.size() * (1 + 4 * axes)), total = time(x);
  constexpr double exact = 2e-4;  // of the time
  for (double mu = 0.1 * total / bounds; mu > exact * total / bounds; mu *= 0.3) {
    const double enough = 0.3 * mu * bounds * exact;
    double promised = unbounded;
    for (int i = 0; i < 40 && promised >= enough && !stop(); ++i) promised = barrier.step(x, mu);
    // In the middle of its bounds, a convex problem's optimum is at most mu for each bound away.
    const bool central = promised > 0.0 && promised < enough;
    if (central && time(x) - mu * bounds > most) return false;
  }
  return true;
}

double PathSpeed::time(const std::vector<double>& x) const {
  double sum = 0.0;
  for (std::size_t c = 0; c + 1 < node.size(); ++c)
    sum += 2.0 * (node[c + 1] - node[c]) / (std::sqrt(x[c]) + std::sqrt(x[c + 1]));
  return sum;
}

}  // namespace accdec
