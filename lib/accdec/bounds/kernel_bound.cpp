#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include <accdec/bounds/corner_bound.hpp>
#include <accdec/bounds/kernel_bound.hpp>

namespace accdec {
namespace {

constexpr std::size_t axes_max = 3, span_max = 2;  // blocks from one joint to the next one used
constexpr std::array kernel_multipliers{0.6, 0.75, 0.9};
constexpr std::array finest_values{-1.0, -0.85, -0.7, -0.55, -0.4, 0.0, 0.4, 0.55, 0.7, 0.85, 1.0};
constexpr std::array fine_values{-1.0, -0.7, -0.4, 0.0, 0.4, 0.7, 1.0};
constexpr std::array middle_values{-1.0, -0.5, 0.0, 0.5, 1.0};
constexpr std::array coarse_values{-1.0, 0.0, 1.0};
constexpr std::array<std::span<const double>, 4> grids{finest_values, fine_values, middle_values, coarse_values};

using Values = std::array<double, axes_max>;

/// K from the values of one state to those of another.
struct Step {
  std::size_t from = 0, to = 0;
  Values fall{};            // (k - k')/A, s^2/m
  double length = 0.0;      // of it
  double slope = 0.0;       // 1 - m c, > 0
  double wide = 0.0;        // s^2, by the jerk: phi has wide/h if h >= narrow
  double narrow = 0.0;      // s
  double near_slope = 0.0;  // instead of `slope` if h < narrow
};

class Kernels {
 public:
  Kernels(const Toolpath& path, const Machine& machine, double wider, std::size_t first, std::size_t last)
      : path_(path), wider_(wider), first_(first), last_(last) {
    for (std::size_t a = 0; a < path.dimensions() && a < machine.axes.size(); ++a) {
      const double most = acceleration_most(machine.axes[a]);
      bool moves = false;
      for (std::size_t b = first; b <= last && !moves; ++b)
        moves = path.point(b)[a] != path.point(b + 1)[a] && most < unlimited;
      if (!moves || axes_.size() == axes_max) continue;
      const double jerk = machine.axes[a].jerk_max;
      axes_.push_back({a, most, jerk < unlimited ? 2.0 * most / jerk : 0.0});
    }
    for (std::size_t b = first; b <= last; ++b) {
      double length2 = 0.0;
      for (std::size_t a = 0; a < path.dimensions(); ++a) {
        const double way = path.point(b + 1)[a] - path.point(b)[a];
        length2 += way * way;
      }
      speed_.push_back(std::sqrt(length2) / path.duration[b]);
    }
  }

  double largest(double& work_left, const std::function<bool()>& more) {
    const double each = static_cast<double>(kernel_multipliers.size() * span_max * speed_.size());
    double largest = 0.0;
    for (const std::span<const double> values : grids) {
      const double states = std::pow(static_cast<double>(values.size()), static_cast<double>(axes_.size()));
      const double work = each * states * states;
      if (axes_.empty() || work > work_left) continue;
      work_left -= work;
      for (const double m : kernel_multipliers) {
        if (!more()) return largest;
        make_steps(values, m);
        largest = std::max(largest, time(static_cast<std::size_t>(states + 0.5), m, more));
      }
      break;
    }
    return largest;
  }

 private:
  struct AxisOf {
    std::size_t index = 0;
    double acceleration = 0.0, r = 0.0;  // r: s, from the largest acceleration to the opposite one
  };

  void make_steps(std::span<const double> values, double m) {
    std::vector<Values> states{{}};
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      std::vector<Values> all;
      for (const Values& state : states) {
        for (const double value : values) all.push_back(state), all.back()[i] = value;
      }
      states = std::move(all);
    }
    steps_.clear();
    for (std::size_t from = 0; from < states.size(); ++from) {
      for (std::size_t to = 0; to < states.size(); ++to) {
        const Step step = step_of(states[from], states[to], m);
        if (!(step.slope > 1e-9)) continue;
        steps_.push_back(step);
        steps_.back().from = from;
        steps_.back().to = to;
      }
    }
  }

  Step step_of(const Values& from, const Values& to, double m) const {
    Step step;
    double mean = 0.0, length2 = 0.0;
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      const double p = from[i], q = to[i], both = std::abs(p) + std::abs(q), r = axes_[i].r;
      step.fall[i] = (p - q) / axes_[i].acceleration;
      length2 += step.fall[i] * step.fall[i];
      const bool crosses = p * q < 0.0;
      mean += crosses ? 0.5 * (p * p + q * q) / both : 0.5 * both;
      if (!crosses) continue;
      step.wide += both * r * r / 12.0;
      step.narrow = std::max(step.narrow, 0.5 * r * both / std::min(std::abs(p), std::abs(q)));
    }
    step.length = std::sqrt(length2);
    step.slope = 1.0 - m * mean;
    step.near_slope = step.slope + (step.narrow > 0.0 ? m * step.wide / (step.narrow * step.narrow) : 0.0);
    return step;
  }

  /// The least of h slope + part/h for h in [low, high].
  static double least(double slope, double part, double low, double high) {
    if (part <= 0.0) return low > 0.0 ? low * slope + part / low : part < 0.0 ? -unlimited : 0.0;
    const double h = std::clamp(std::sqrt(part / slope), low, high);
    return h * slope + part / h;
  }

  double time(std::size_t states, double m, const std::function<bool()>& more) const {
    const std::size_t blocks = speed_.size();
    std::vector<double> best((blocks + 1) * states, -unlimited);
    std::fill_n(best.begin(), states, 0.0);
    for (std::size_t k = 1; k <= blocks; ++k) {
      if (!more()) return 0.0;
      for (std::size_t s = 1; s <= std::min(span_max, k); ++s)
        span(k - s, k, m, &best[(k - s) * states], &best[k * states]);
    }
    return *std::max_element(best.end() - static_cast<std::ptrdiff_t>(states), best.end());
  }

  /// From the values at joint i to those at joint k.
  void span(std::size_t i, std::size_t k, double m, const double* before, double* after) const {
    Values way{};
    double length2 = 0.0;
    for (std::size_t a = 0; a < axes_.size(); ++a) {
      way[a] = path_.point(first_ + k)[axes_[a].index] - path_.point(first_ + i)[axes_[a].index];
      length2 += way[a] * way[a];
    }
    const double off = tolerance(i) + tolerance(k);
    if (!(off < unlimited)) return;
    // Beside the joints the motion may be as fast as on the next blocks.
    const std::size_t low = i > 0 ? i - 1 : 0, high = std::min(k + 1, speed_.size());
    const double feed = *std::max_element(speed_.begin() + static_cast<std::ptrdiff_t>(low),
                                          speed_.begin() + static_cast<std::ptrdiff_t>(high));
    const double shortest = std::max(0.0, std::sqrt(length2) - off) / feed;
    for (const Step& step : steps_) {
      const double gained =
          m * (step.fall[0] * way[0] + step.fall[1] * way[1] + step.fall[2] * way[2] - off * step.length);
      double time = least(step.slope, gained + m * step.wide, std::max(shortest, step.narrow), unlimited);
      if (shortest < step.narrow) time = std::min(time, least(step.near_slope, gained, shortest, step.narrow));
      after[step.to] = std::max(after[step.to], before[step.from] + time);
    }
  }

  double tolerance(std::size_t i) const {
    return i == 0 || first_ + i == last_ + 1 ? 0.0 : path_.tolerance[first_ + i - 1] + wider_;
  }

  const Toolpath& path_;
  const double wider_;
  const std::size_t first_, last_;
  std::vector<AxisOf> axes_;
  std::vector<double> speed_;  // m/s, of every block
  std::vector<Step> steps_;
};

}  // namespace

double kernel_bound(const Toolpath& path, const Machine& machine, double wider, std::size_t first, std::size_t last,
                    double& work_left, const std::function<bool()>& more) {
  return last > first ? Kernels(path, machine, wider, first, last).largest(work_left, more) : 0.0;
}

}  // namespace accdec
