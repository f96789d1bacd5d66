#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>
#include <vector>

#include <accdec/bounds/corner_bound.hpp>
#include <accdec/bounds/window_bound.hpp>
#include <accdec/simulate/command_stream.hpp>

namespace accdec {
namespace {

constexpr std::size_t chain_blocks_max = 64;  // of one way of a chain

/// Window sizes in blocks, ascending. Long programs have fewer sizes, so that the bound takes only a small part of
/// their time.
std::vector<std::size_t> window_sizes(std::size_t blocks) {
  std::vector<std::size_t> sizes;
  const bool few = blocks > 50'000;
  constexpr std::size_t longest = 4096;
  for (std::size_t size = 1; size <= std::min(blocks, longest); size *= few ? 4 : 2) {
    sizes.push_back(size);
    if (!few && size > 1 && size + size / 2 <= std::min(blocks, longest)) sizes.push_back(size + size / 2);
  }
  return sizes;
}

/// @tparam axes  of the path; 0: only known at run time
template <std::size_t axes>
class Windows {
 public:
  Windows(const Toolpath& path, const Machine& machine, double wider, std::size_t first, std::size_t last,
          const SwingTimes* chains)
      : path_(path), machine_(machine), wider_(wider), first_(first), last_(last), swing_(chains) {
    const std::size_t blocks = last - first + 1;
    // With few blocks all multipliers are tried, in one run, and a chain keeps to one.
    kinds_ = chains == nullptr ? 0 : blocks > 50'000 ? 1 : chains->kinds();
    open_.assign((blocks + 1) * dimensions() * kinds_, {-unlimited, -unlimited});
    sizes_ = window_sizes(blocks);
    for (std::size_t s = 0; s < sizes_.size(); ++s)
      fastest_.emplace_back(std::bit_ceil(s + 1 < sizes_.size() ? sizes_[s + 1] : 1));
    for (const Axis& axis : machine.axes) slowest_ = std::min(slowest_, axis.acceleration_max);
    speed_.reserve(blocks);
    for (std::size_t b = first; b <= last; ++b) {
      const double* p = path.point(b);
      double length2 = 0.0;
      for (std::size_t a = 0; a < dimensions(); ++a)
        length2 += (p[dimensions() + a] - p[a]) * (p[dimensions() + a] - p[a]);
      speed_.push_back(std::sqrt(length2) / path.duration[b]);
    }
  }

  double largest() {
    const std::size_t blocks = last_ - first_ + 1;
    std::vector<double> best(blocks + 1, 0.0);  // up to every point
    for (std::size_t k = 1; k <= blocks; ++k) {
      for (std::size_t s = 0; s < sizes_.size() && sizes_[s] <= k; ++s) {
        const std::size_t i = k - sizes_[s];
        const double known = std::max(0.0, best[k] - best[i]);
        best[k] = std::max(best[k], best[i] + time(i, k, fastest(s, k), known));
      }
      for (std::size_t i = k - 1; !open_.empty() && k - i <= chain_blocks_max; --i) {
        link(i, k, best);
        if (i == 0) break;
      }
    }
    return best.back();
  }

 private:
  /// Begins chains at point i with a way to k, goes on with those that end in i, and ends them in k.
  void link(std::size_t i, std::size_t k, std::vector<double>& best) {
    const double ends = tolerance(i) + tolerance(k);
    for (std::size_t a = 0; a < dimensions(); ++a) {
      const double way = point(k)[a] - point(i)[a], left = std::abs(way) - ends;
      if (!(left > 0.0)) continue;
      const std::size_t up = way > 0.0 ? 1 : 0;
      for (std::size_t kind = 0; kind < kinds_; ++kind) {
        const double inside = swing_->inside(a, kind, left), free = swing_->at_end(a, kind, left);
        const auto at_end = [&](std::size_t j) { return rests(j) ? inside : free; };
        // The time of a chain whose last way was the other one.
        const double before = open_[(i * dimensions() + a) * kinds_ + kind][1 - up];
        double& after = open_[(k * dimensions() + a) * kinds_ + kind][up];
        after = std::max({after, best[i] + at_end(i), before + inside});
        best[k] = std::max(best[k], before + at_end(k));
      }
    }
  }

  /// The highest feed of the window of size s that ends in point k: that of windows of the size before that cover it.
  /// It is asked for each k and s in their order.
  double fastest(std::size_t s, std::size_t k) {
    if (s == 0) return fastest_[0][k & ring_mask(0)] = speed_[k - 1];
    const std::size_t size = sizes_[s], part = sizes_[s - 1], mask = ring_mask(s - 1);
    const std::vector<double>& parts = fastest_[s - 1];
    double highest = parts[k & mask];
    for (std::size_t back = part; back < size; back += part)
      highest = std::max(highest, parts[(k - std::min(back, size - part)) & mask]);
    return fastest_[s][k & ring_mask(s)] = highest;
  }
  std::size_t ring_mask(std::size_t s) const { return fastest_[s].size() - 1; }

  std::size_t dimensions() const { return axes > 0 ? axes : path_.dimensions(); }
  /// Calls a function with every axis, unrolled if their number is known.
  template <class Function>
  void for_axes(const Function& function) const {
    if constexpr (axes > 0) [&]<std::size_t... a>(std::index_sequence<a...>) {
        (function(a), ...);
      }
    (std::make_index_sequence<axes>{});
    else for (std::size_t a = 0; a < dimensions(); ++a) function(a);
  }
  const double* point(std::size_t i) const { return path_.point(first_ + i); }
  bool rests(std::size_t i) const { return i == 0 || first_ + i == last_ + 1; }
  double tolerance(std::size_t i) const { return rests(i) ? 0.0 : path_.tolerance[first_ + i - 1] + wider_; }

  /// m/s^2 along a vector of this length.
  double acceleration(const double* vector, double length) const {
    double sum = 0.0;
    for (std::size_t a = 0; a < dimensions(); ++a) {
      if (vector[a] == 0.0) continue;
      if (machine_.axes.empty()) return unlimited;
      sum += std::abs(vector[a]) / length * machine_.axes[a].acceleration_max;
    }
    return sum;
  }

  /// Least time of the window from point i to k. If it is not above `known`, it may be less, or 0: most
  /// windows are passed over by squares, without roots.
  double time(std::size_t i, std::size_t k, double speed, double known) const {
    const double ends = tolerance(i) + tolerance(k);
    if (!(ends < unlimited)) return 0.0;
    AxisRow<axes> chord, aside;
    double chord2 = 0.0, along = 0.0;
    const std::size_t j = i + (k - i) / 2;
    for_axes([&](std::size_t a) {
      chord[a] = point(k)[a] - point(i)[a];
      aside[a] = point(j)[a] - point(i)[a];
      chord2 += chord[a] * chord[a];
      along += chord[a] * aside[a];
    });
    double time = 0.0;
    const int at_rest = (rests(i) ? 1 : 0) + (rests(k) ? 1 : 0);
    const double reached = ends + (at_rest > 0 ? 0.0 : known * speed);  // in the time known, from end to end
    if (chord2 > reached * reached) {
      const double length = std::sqrt(chord2);
      time =
          time_from_rest(length - ends, speed, at_rest > 0 ? acceleration(chord.data(), length) : unlimited, at_rest);
    }
    if (j == i || !(tolerance(j) < unlimited)) return time;
    const double longest = std::max(time, known), wide = tolerance(j) + std::max(tolerance(i), tolerance(k));
    double height2 = 0.0;
    const double part = chord2 > 0.0 ? along / chord2 : 0.0;
    for_axes([&](std::size_t a) {
      aside[a] -= chord[a] * part;
      height2 += aside[a] * aside[a];
    });
    const double aside_in_that = wide + 0.125 * longest * longest * slowest_;
    if (!(height2 > aside_in_that * aside_in_that)) return time;
    const double height = std::sqrt(height2);
    return std::max(time, std::sqrt(8.0 * (height - wide) / acceleration(aside.data(), height)));
  }

  const Toolpath& path_;
  const Machine& machine_;
  const double wider_;
  const std::size_t first_, last_;
  const SwingTimes* const swing_;
  std::size_t kinds_ = 0;       // of chains
  double slowest_ = unlimited;  // m/s^2: no direction has a lower bound of acceleration
  std::vector<std::size_t> sizes_;
  std::vector<double> speed_;                 // of every block
  std::vector<std::vector<double>> fastest_;  // of every size, of the windows that end last: rings of powers of two
  /// s, of every point, axis and kind: chains that end there, down and up
  std::vector<std::array<double, 2>> open_;
};

}  // namespace

double time_from_rest(double distance, double speed, double acceleration, int rests) {
  if (distance <= 0.0) return 0.0;
  if (!(acceleration < unlimited) || rests == 0) return distance / speed;
  const double ramps = rests * 0.5 * speed * speed / acceleration;  // their way
  return distance >= ramps ? distance / speed + rests * 0.5 * speed / acceleration
                           : std::sqrt(2.0 * rests * distance / acceleration);
}

double window_bound(const Toolpath& path, const Machine& machine, double wider, std::size_t first, std::size_t last,
                    const SwingTimes* chains) {
  const SwingTimes* const used = machine.axes.empty() ? nullptr : chains;
  switch (path.dimensions()) {
    case 2: return Windows<2>(path, machine, wider, first, last, used).largest();
    case 3: return Windows<3>(path, machine, wider, first, last, used).largest();
    default: return Windows<0>(path, machine, wider, first, last, used).largest();
  }
}

}  // namespace accdec
