#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <accdec/filter.hpp>
#include <accdec/simulate.hpp>

namespace accdec::test {

/// A program computed from its definition, without the library's emission and recursion. Command positions at every
/// sample are points of the path at that time; then follows plain convolution of these positions with the taps.
struct Reference {
  std::size_t n = 0;
  std::vector<std::vector<double>> command, position;  // [sample][axis]; position is N + 1 samples longer
  std::vector<double> reached;                         // time of every joint, samples
  std::vector<long> rest;                              // samples at rest in every joint

  Reference(const Toolpath& path, const Filter& filter, double period, const std::vector<int>& delays)
      : n(path.dimensions()) {
    const auto point = [&](std::size_t i) { return std::vector<double>(path.point(i), path.point(i) + n); };
    const std::size_t blocks = path.blocks();
    reached.assign(blocks, 0.0);
    rest.assign(blocks, 0);
    command.push_back(point(0));
    for (long k = 0; k < std::ceil(path.dwell_first / period - 1e-9); ++k) command.push_back(point(0));
    for (std::size_t run = 0; run < blocks;) {
      std::size_t end = run;
      while (path.joint[end] != Joint::corner && path.joint[end] != Joint::stop && delays[end] == 0) ++end;
      // Times of the joints of the run in samples at the programmed feeds, then stretched to a whole number.
      std::vector<double> time{0.0};
      for (std::size_t b = run; b <= end; ++b) time.push_back(time.back() + path.duration[b] / period);
      const long samples = std::max(1L, static_cast<long>(std::ceil(time.back() - 1e-9)));
      const double stretch = static_cast<double>(samples) / time.back();
      for (double& t : time) t *= stretch;
      const double start = static_cast<double>(command.size() - 1);
      for (long k = 1; k <= samples; ++k) {
        std::size_t b = 0;
        while (b + 2 < time.size() && time[b + 1] < static_cast<double>(k)) ++b;
        const double t = k == samples ? 1.0 : (static_cast<double>(k) - time[b]) / (time[b + 1] - time[b]);
        const auto p = point(run + b), q = point(run + b + 1);
        std::vector<double> c(n);
        for (std::size_t i = 0; i < n; ++i) c[i] = p[i] + t * (q[i] - p[i]);
        command.push_back(k == samples ? point(end + 1) : c);
      }
      for (std::size_t b = run; b <= end; ++b) {
        reached[b] = start + (b == end ? static_cast<double>(samples) : time[b - run + 1]);
        if (std::abs(reached[b] - std::round(reached[b])) < 1e-9) reached[b] = std::round(reached[b]);
      }
      rest[end] = end + 1 < blocks ? delays[end] : 0;
      for (const auto& [block, dwell] : path.dwell) {
        if (block == end) rest[end] += static_cast<long>(std::ceil(dwell / period - 1e-9));
      }
      for (long k = 0; k < rest[end]; ++k) command.push_back(point(end + 1));
      run = end + 1;
    }
    for (std::size_t k = 0; k < command.size() + static_cast<std::size_t>(filter.order()) + 1; ++k) {
      std::vector<double> s(n, 0.0);
      for (int i = 0; i <= filter.order(); ++i) {
        const long j = std::clamp(static_cast<long>(k) - i, 0L, static_cast<long>(command.size()) - 1);
        for (std::size_t a = 0; a < n; ++a) s[a] += filter.tap(i) * command[static_cast<std::size_t>(j)][a];
      }
      position.push_back(s);
    }
  }

  double distance(std::size_t k, const double* corner) const {
    double sum = 0.0;
    for (std::size_t a = 0; a < n; ++a) sum += std::pow(position[k][a] - corner[a], 2);
    return std::sqrt(sum);
  }

  /// Error of joint b over its whole window.
  double error(const Toolpath& path, int order, std::size_t b) const {
    const double* corner = path.programmed_point(b + 1);
    const auto first = static_cast<std::size_t>(reached[b]);
    const std::size_t last = static_cast<std::size_t>(std::ceil(reached[b])) +
                             static_cast<std::size_t>(std::min<long>(rest[b], order + 1)) +
                             static_cast<std::size_t>(order) + 1;
    double best = 1e300;
    for (std::size_t k = first; k <= last; ++k) {
      best = std::min(best, distance(k, corner));
      if (k == last || path.joint[b] == Joint::corner || path.joint[b] == Joint::stop) continue;
      double ab2 = 0.0, dot = 0.0;
      for (std::size_t a = 0; a < n; ++a) {
        const double d = position[k + 1][a] - position[k][a];
        ab2 += d * d;
        dot += (corner[a] - position[k][a]) * d;
      }
      const double t = ab2 > 0.0 ? std::clamp(dot / ab2, 0.0, 1.0) : 0.0;
      double sum = 0.0;
      for (std::size_t a = 0; a < n; ++a) {
        sum += std::pow(position[k][a] + t * (position[k + 1][a] - position[k][a]) - corner[a], 2);
      }
      best = std::min(best, std::sqrt(sum));
    }
    return best;
  }
};

/// A program of random moves: long and short blocks, smooth turns and corners, straight joints, stops, dwells.
inline std::string random_program(unsigned seed, int blocks) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::ostringstream text;
  text << std::fixed;
  text.precision(7);
  text << "G91 G64 P0.05\nG1 F3000\n";
  double heading = 0.0;
  for (int b = 0; b < blocks; ++b) {
    const double kind = unit(random);
    if (kind < 0.5)
      heading += (unit(random) - 0.5) * 0.4;
    else if (kind < 0.9)
      heading += (unit(random) - 0.5) * 6.0;
    const double length = unit(random) < 0.7 ? 0.02 + 0.5 * unit(random) : 1.0 + 4.0 * unit(random);
    if (unit(random) < 0.05)
      text << "G61.1 ";
    else
      text << "G64 P" << 0.005 + 0.1 * unit(random) << " ";
    if (unit(random) < 0.1) text << "F" << 1000.0 + 5000.0 * unit(random) << " ";
    text << "X" << length * std::cos(heading) << " Y" << length * std::sin(heading) << " Z"
         << 0.1 * length * unit(random) << "\n";
    if (unit(random) < 0.02) text << "G4 P0.0123\n";
  }
  return text.str();
}

inline Toolpath path_of(const std::string& text, const Machine& machine = {}) {
  LineSource source("test.ngc", text);
  return read_toolpath(source, machine, {});
}

/// m, of a point of the plane from the blocks of a path.
inline double from_blocks(const Toolpath& path, double x, double y) {
  double least = unlimited;
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    const double *p = path.point(b), *q = path.point(b + 1);
    const double dx = q[0] - p[0], dy = q[1] - p[1];
    const double s = std::clamp(((x - p[0]) * dx + (y - p[1]) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
    least = std::min(least, std::hypot(x - p[0] - s * dx, y - p[1] - s * dy));
  }
  return least;
}

inline constexpr double period = 1e-3;  ///< s, of the programs in these tests

/// Axes x, y, z, or the first of them, of equal limits in m, kg, s.
inline Machine machine_of(double acceleration, double jerk = unlimited, double velocity = 0.2, int axes = 2) {
  Machine m;
  for (const char* name : {"x", "y", "z"}) {
    if (static_cast<int>(m.axes.size()) == axes) break;
    Axis axis;
    axis.name = name;
    axis.velocity_max = velocity;
    axis.acceleration_max = acceleration;
    axis.jerk_max = jerk;
    m.axes.push_back(axis);
  }
  return m;
}

}  // namespace accdec::test
