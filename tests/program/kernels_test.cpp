#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <accdec/filter.hpp>
#include <accdec/simulate/convolve.hpp>
#include <accdec/simulate/joint_distance.hpp>
#include <accdec/simulate/motion_extremes.hpp>
#include <accdec/simulate/sample_check.hpp>
#include <accdec/simulate/sample_smoother.hpp>

namespace accdec {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

std::vector<double> random_values(std::size_t n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  std::vector<double> values(n);
  for (double& v : values) v = value(random);
  return values;
}

TEST(Kernels, ConvolutionIsTheSumOfItsProducts) {
  constexpr std::size_t margin = convolve_margin;
  for (const std::size_t taps : {1U, 2U, 7U, 41U, 130U}) {
    for (const std::size_t n : {1U, 8U, 63U, 64U, 65U, 300U}) {
      const std::vector<double> b = random_values(taps, 1), start = random_values(n + margin, 2);
      std::vector<double> x = random_values(taps + n + 2 * margin, 3), y = start;
      const double* at = x.data() + margin + taps - 1;
      add_convolved(y.data(), at, static_cast<std::int64_t>(n), b.data(), static_cast<std::int64_t>(taps));
      for (std::size_t j = 0; j < n; ++j) {
        double sum = start[j], size = std::abs(start[j]);
        for (std::size_t i = 0; i < taps; ++i) {
          const double product = b[i] * *(at + j - i);
          sum += product;
          size += std::abs(product);
        }
        // The classical bound of a sum of taps + 1 terms in any order, for both sums.
        EXPECT_NEAR(y[j], sum, 2.0 * static_cast<double>(taps + 1) * epsilon * size);
      }
    }
  }
}

TEST(Kernels, ChangesAreDifferencesAndCounted) {
  constexpr std::size_t window = change_window;
  for (const std::size_t n : {1U, 31U, 32U, 33U, 200U}) {
    std::vector<double> u = random_values(n + 1 + window, 4);
    for (std::size_t k = 1; k < u.size(); ++k) u[k] = k % 3 == 0 ? u[k] : u[k - 1];
    std::vector<double> change(n + window, 7.0);
    std::vector<std::uint8_t> count(n / window + 1, 99);
    find_changes(u.data() + 1, static_cast<std::int64_t>(n), change.data(), count.data());
    for (std::size_t w = 0; w * window < n; ++w) {
      int expected = 0;
      for (std::size_t k = w * window; k < (w + 1) * window; ++k) {
        EXPECT_EQ(change[k], k < n ? u[k + 1] - u[k] : 0.0);
        expected += change[k] != 0.0 ? 1 : 0;
      }
      EXPECT_EQ(count[w], expected);
    }
  }
}

/// Least squared distance of p from samples first .. last or the segments between them, place by place.
double least_distance2(const std::vector<std::vector<double>>& s, const double* p, std::size_t first, std::size_t last,
                       bool path) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = first; k <= last; ++k) {
    // A fine walk along the segment and its ends would only bound it from above; its minimum in closed form does not.
    double ab2 = 0.0, dot = 0.0;
    const std::size_t to = path && k < last ? k + 1 : k;
    for (std::size_t a = 0; a < s.size(); ++a) {
      ab2 += (s[a][to] - s[a][k]) * (s[a][to] - s[a][k]);
      dot += (p[a] - s[a][k]) * (s[a][to] - s[a][k]);
    }
    const double t = ab2 > 0.0 ? std::clamp(dot / ab2, 0.0, 1.0) : 0.0;
    double sum = 0.0;
    for (std::size_t a = 0; a < s.size(); ++a) sum += std::pow(s[a][k] + t * (s[a][to] - s[a][k]) - p[a], 2);
    least = std::min(least, sum);
  }
  return least;
}

TEST(Kernels, LeastDistanceIsThatOfTheWholeWindow) {
  for (const std::size_t axes : {1U, 2U, 3U, 5U}) {
    for (const std::size_t samples : {1U, 2U, 5U, 8U, 9U, 40U}) {
      for (const bool path : {false, true}) {
        std::vector<std::vector<double>> s;
        std::array<const double*, 9> position{};
        for (std::size_t a = 0; a < axes; ++a)
          s.push_back(random_values(samples + nearest_margin, static_cast<unsigned>(7 + a)));
        for (std::size_t a = 0; a < axes; ++a) position[a] = s[a].data();
        const std::vector<double> points = random_values(40 * axes, 11);
        std::vector<JointWindow> joints;
        for (std::size_t b = 0; b < 39; ++b) {
          joints.push_back({b, static_cast<std::int64_t>(b % samples), static_cast<std::int64_t>(samples) - 1, path});
        }
        std::vector<double> squared(joints.size(), -2.0);
        least_squared(position.data(), axes, points.data(), joints.data(), joints.size(), squared.data());
        for (std::size_t j = 0; j < joints.size(); ++j) {
          const double near =
              least_distance2(s, points.data() + (j + 1) * axes, static_cast<std::size_t>(joints[j].first),
                              static_cast<std::size_t>(joints[j].last), path);
          EXPECT_NEAR(squared[j], near, 64.0 * epsilon * (1.0 + near)) << axes << " " << samples << " " << path;
        }
      }
    }
  }
}

TEST(Kernels, PathIsTheNearestOfItsSegments) {
  for (const std::size_t n : {1U, 2U, 3U, 5U}) {
    constexpr std::size_t samples = 40;
    std::vector<double> rows[5];
    const double* position[5];
    for (std::size_t a = 0; a < n; ++a) {
      rows[a] = random_values(samples + nearest_margin, 20 + static_cast<unsigned>(a));
      rows[a][9] = rows[a][8];
      position[a] = rows[a].data();
    }
    const auto at = [&](std::size_t k) {
      std::vector<double> point;
      for (std::size_t a = 0; a < n; ++a) point.push_back(rows[a][k]);
      return point;
    };
    const std::vector<double> point = random_values(n, 30);
    for (const auto& [first, last] : {std::pair{0U, 1U}, {3U, 11U}, {8U, 9U}, {0U, 39U}, {5U, 14U}}) {
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t k = first; k < last; ++k)
        least = std::min(least, segment_distance2(at(k).data(), at(k + 1).data(), point.data(), n));
      EXPECT_NEAR(path_squared(position, n, point.data(), first, last), least, 100.0 * epsilon);
    }
  }
}

TEST(Kernels, SmootherIsTheMeanOfItsTaps) {
  for (const int taps : {1, 2, 7, 200}) {
    for (const bool equal : {true, false}) {
      std::vector<double> weights(static_cast<std::size_t>(taps), 1.0);
      if (!equal) weights.back() = 0.5;
      const Filter filter(weights);
      const std::vector<double> x = random_values(1000, 40);
      // Roundings of distances up to 2; the unit, by which small positions differ.
      const double rounding = (equal ? 5.0 : 5.0 + 2.0 * taps) * epsilon, unit = taps * std::ldexp(1.0, -60);
      SampleSmoother smoother(filter, 2, {x[0], 1e-3 * x[0]}, 0, 1.0);
      for (std::size_t k = 1; k < x.size(); ++k) {
        SampleSmoother::Point out{};
        smoother.next({x[k], 1e-3 * x[k]}, static_cast<std::int64_t>(k), out);
        long double mean = 0.0L;
        for (int i = 0; i < taps; ++i)
          mean += static_cast<long double>(filter.tap(i)) * x[k - std::min(k, static_cast<std::size_t>(i))];
        EXPECT_NEAR(out[0], static_cast<double>(mean), rounding + unit);
        EXPECT_NEAR(out[1], 1e-3 * static_cast<double>(mean), 1e-3 * rounding + unit);
        EXPECT_EQ(smoother.oldest_place(static_cast<std::int64_t>(k)),
                  std::max<std::int64_t>(0, static_cast<std::int64_t>(k) - taps + 1));
      }
    }
  }
}

TEST(Kernels, ExtremesAreTheLargestOfAllSamples) {
  for (const std::size_t n : {1U, 7U, 8U, 9U, 100U}) {
    const std::vector<double> v = random_values(n, 21), a = random_values(n + 1, 22);
    const double m = 3.0, c = 0.7;
    const MotionExtremes e = motion_extremes(v.data(), a.data() + 1, static_cast<std::int64_t>(n), m, c, true);
    MotionExtremes expected;
    for (std::size_t k = 0; k < n; ++k) {
      const double by = a[k + 1], force = m * by + c * v[k];
      expected.velocity = std::max(expected.velocity, std::abs(v[k]));
      expected.acceleration = std::max(expected.acceleration, std::abs(by));
      expected.jerk = std::max(expected.jerk, std::abs(by - a[k]));
      expected.force = std::max(expected.force, std::abs(force));
      expected.power = std::max(expected.power, force * v[k]);
      expected.regeneration = std::max(expected.regeneration, -force * v[k]);
    }
    EXPECT_EQ(e.velocity, expected.velocity);
    EXPECT_EQ(e.acceleration, expected.acceleration);
    EXPECT_EQ(e.jerk, expected.jerk);
    EXPECT_NEAR(e.force, expected.force, 4.0 * epsilon * (m + c));
    EXPECT_NEAR(e.power, expected.power, 4.0 * epsilon * (m + c));
    EXPECT_NEAR(e.regeneration, expected.regeneration, 4.0 * epsilon * (m + c));
  }
}

}  // namespace
}  // namespace accdec
