#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <coin/ClpSimplex.hpp>
#include <fmt/format.h>

#include <accdec/machine.hpp>

namespace accdec::test {

/// A motion round one corner, all samples free, by a linear program over the positions. Its polygons are inscribed, so
/// that every motion it finds is valid.
class FreeCorner {
 public:
  FreeCorner(double heading, double turn, double length, double tolerance, double feed, const Axis& axis, double period)
      : length_(length), tolerance_(tolerance), feed_(feed), axis_(axis), period_(period) {
    in_ = {std::cos(heading), std::sin(heading)};
    out_ = {std::cos(heading + turn), std::sin(heading + turn)};
  }

  std::string program() const {
    const double mm = length_ * 1e3;
    return fmt::format("G64 P{} F{}\nG1 X{:.9f} Y{:.9f}\nG1 X{:.9f} Y{:.9f}\nM2\n", tolerance_ * 1e3, feed_ * 60e3,
                       mm * in_[0], mm * in_[1], mm * (in_[0] + out_[0]), mm * (in_[1] + out_[1]));
  }

  /// The fewest samples of a motion that passes the corner in its middle, s.
  double least_time(int low, int high) const {
    while (high - low > 2) {
      const int middle = low + (high - low) / 4 * 2;
      const int count = middle == low ? low + 2 : middle;
      (possible(count) ? high : low) = count;
    }
    return high * period_;
  }

 private:
  /// Positions of samples 0 .. count from the corner, in units of the feed's step.
  bool possible(int count) const {
    const double step = feed_ * period_;
    std::vector<CoinBigIndex> start{0};
    std::vector<int> index;
    std::vector<double> value, low, high;
    const auto row = [&](const std::vector<std::pair<int, double>>& entries, double from, double to) {
      for (const auto& [column, factor] : entries) index.push_back(column), value.push_back(factor);
      start.push_back(static_cast<CoinBigIndex>(index.size()));
      low.push_back(from), high.push_back(to);
    };
    const auto at = [&](int k, int a) { return 2 * std::clamp(k, 0, count) + a; };  // at rest before and after
    const auto differences = [&](const std::vector<double>& d, double most) {
      for (int k = 0; most < 1e20 && k <= count + 3; ++k) {
        for (int a = 0; a < 2; ++a) {
          std::map<int, double> sum;
          for (int j = 0; j < static_cast<int>(d.size()); ++j) sum[at(k - j, a)] += d[static_cast<std::size_t>(j)];
          row({sum.begin(), sum.end()}, -most / step, most / step);
        }
      }
    };
    differences({1.0, -2.0, 1.0}, axis_.acceleration_max * period_ * period_);
    differences({1.0, -3.0, 3.0, -1.0}, axis_.jerk_max * std::pow(period_, 3));
    constexpr int sides = 32;
    const double inside = std::cos(std::numbers::pi / sides);
    for (int m = 0; m < sides; ++m) {
      const double angle = 2.0 * std::numbers::pi * m / sides, x = std::cos(angle), y = std::sin(angle);
      for (int k = 0; k < count; ++k)
        row({{at(k + 1, 0), x}, {at(k + 1, 1), y}, {at(k, 0), -x}, {at(k, 1), -y}}, -1e30, inside);
      row({{at(count / 2, 0), x}, {at(count / 2, 1), y}}, -1e30, inside * tolerance_ / step);
      // Beside a leg and beyond its end, seen from the leg.
      for (int k = 0; k <= count && x > -1e-9; ++k) {
        const std::array<double, 2> away = k <= count / 2 ? in_ : std::array<double, 2>{-out_[0], -out_[1]};
        row({{at(k, 0), x * away[0] - y * away[1]}, {at(k, 1), x * away[1] + y * away[0]}}, -1e30,
            inside * tolerance_ / step);
      }
    }
    const auto columns = static_cast<std::size_t>(2 * count + 2);
    std::vector<double> costs(columns, 0.0), least(columns, -1e30), most(columns, 1e30);
    for (std::size_t a = 0; a < 2; ++a) {
      least[a] = most[a] = -length_ * in_[a] / step;
      least[columns - 2 + a] = most[columns - 2 + a] = length_ * out_[a] / step;
    }
    CoinPackedMatrix matrix(false, static_cast<int>(columns), static_cast<int>(low.size()),
                            static_cast<CoinBigIndex>(index.size()), value.data(), index.data(), start.data(), nullptr);
    ClpSimplex lp;
    lp.setLogLevel(0);
    lp.loadProblem(matrix, least.data(), most.data(), costs.data(), low.data(), high.data());
    lp.primal();
    return lp.status() == 0;
  }

  double length_, tolerance_, feed_;
  Axis axis_;
  double period_;
  std::array<double, 2> in_{}, out_{};
};

}  // namespace accdec::test
