#pragma once

#include <array>
#include <random>
#include <utility>
#include <vector>

#include <accdec/design/identify.hpp>

// Logs of motions behind known filters.

namespace accdec::testing {

inline constexpr double period = 1e-3;  // s

/// A leg of a command in the plane.
struct Leg {
  double x, y;  // m
  int samples, rest;
};

/// The log of a command behind taps, by the definition: every step is spread over the next samples.
/// @param noise  of x and y
inline MotionLog simulated(const std::vector<double>& taps, const std::vector<Leg>& legs,
                           const std::array<double, 2>& noise, unsigned seed) {
  std::vector<double> x(40, 0.01), y(40, -0.02);
  for (const Leg& leg : legs) {
    for (int k = 1; k <= leg.samples; ++k) {
      x.push_back(x.back() + leg.x / leg.samples), y.push_back(y.back() + leg.y / leg.samples);
    }
    x.insert(x.end(), static_cast<std::size_t>(leg.rest), x.back());
    y.insert(y.end(), static_cast<std::size_t>(leg.rest), y.back());
  }
  x.insert(x.end(), taps.size() + 60, x.back()), y.insert(y.end(), taps.size() + 60, y.back());
  std::mt19937 engine(seed);
  std::normal_distribution<double> error(0.0, 1.0);
  MotionLog log{{"x", "y"}, {}};
  for (const std::vector<double>& at : {x, y}) {
    const double of_axis = noise[log.position.size()];
    std::vector<double> filtered;
    for (std::size_t k = 0; k < at.size(); ++k) {
      double sum = 0.0;
      for (std::size_t i = 0; i < taps.size(); ++i) sum += taps[i] * at[k >= i ? k - i : 0];
      filtered.push_back(sum + of_axis * error(engine));
    }
    log.position.push_back(std::move(filtered));
  }
  return log;
}

inline MotionLog simulated(const std::vector<double>& taps, const std::vector<Leg>& legs, double noise, unsigned seed) {
  return simulated(taps, legs, {noise, noise}, seed);
}

inline std::vector<double> taps_of(const std::vector<int>& lengths) {
  std::vector<double> taps{1.0};
  for (const int length : lengths) {
    std::vector<double> next(taps.size() + static_cast<std::size_t>(length) - 1, 0.0);
    for (std::size_t i = 0; i < taps.size(); ++i) {
      for (int j = 0; j < length; ++j) next[i + static_cast<std::size_t>(j)] += taps[i] / length;
    }
    taps = std::move(next);
  }
  return taps;
}

inline Task task_of() {
  Task task;
  task.sample_period = period;
  return task;
}

inline const std::vector<Leg> straight_legs{{0.02, 0.0, 200, 0}};                     // 100 mm/s along x
inline const std::vector<Leg> corner{{0.015, 0.0, 150, 12}, {0.006, 0.012, 160, 0}};  // a delay of 12 samples

}  // namespace accdec::testing
