#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <accdec/corner.hpp>
#include <accdec/paper/paper_case.hpp>
#include <accdec/paper/paper_tables.hpp>
#include <accdec/task/simulation.hpp>

namespace accdec::paper {
namespace {

using Printed = std::array<std::array<int, 4>, 5>;
constexpr std::array<int, 5> feeds{5, 4, 3, 2, 1};
constexpr Printed printed1{
    {{5462, 3118, 1430, 0}, {4370, 2494, 1144, 0}, {3277, 1871, 858, 0}, {2185, 1247, 572, 0}, {1092, 624, 286, 0}}};
constexpr Printed printed2{
    {{2442, 1333, 241, 0}, {1953, 1066, 193, 0}, {1465, 800, 145, 0}, {977, 533, 97, 0}, {488, 267, 48, 0}}};

long rounded(double blu_value) {
  return static_cast<long>(std::floor(blu_value + 0.5));
}

Corner corner_of(double feed_in) {
  return planar_corner(angle, 0.0, Turn::left, feed_in, feed_ratio * feed_in);
}

/// min |S| over the samples of a simulated corner; `trapezoidal` integrates with the mean of both ends of every sample.
double simulated_error(const Filter& filter, double feed_in, int delay, bool trapezoidal) {
  const SampledMotion motion = simulate_corner(filter, corner_of(feed_in), delay, sample_period);
  // Both rules agree wherever the motion rests, as it does before leg 1.
  Eigen::RowVectorXd position = motion.position.row(motion.start);
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index n = motion.start + 1; n < motion.velocity.rows(); ++n) {
    const Eigen::RowVectorXd before = trapezoidal ? motion.velocity.row(n - 1) : motion.velocity.row(n);
    position += 0.5 * sample_period * (before + motion.velocity.row(n));
    least = std::min(least, position.norm());
  }
  return least;
}

template <typename Formula>
Table make_table(std::string name, std::string title, std::vector<int> delays, const Printed& printed,
                 const Filter& filter, bool trapezoidal, Formula formula) {
  Table table{std::move(name), std::move(title), std::move(delays), {}};
  for (std::size_t row = 0; row < feeds.size(); ++row) {
    for (std::size_t column = 0; column < table.delays.size(); ++column) {
      const double feed_in = feeds[row] * 1e5 * blu;
      const int delay = table.delays[column];
      Entry entry;
      entry.feed_in = feeds[row];
      entry.feed_out = static_cast<int>(feed_ratio) * feeds[row];
      entry.delay = delay;
      entry.printed = printed[row][column];
      entry.formula = formula(feed_in, delay) / blu;
      entry.simulated = simulated_error(filter, feed_in, delay, trapezoidal) / blu;
      table.entries.push_back(entry);
    }
  }
  return table;
}

}  // namespace

bool Entry::agrees() const {
  return rounded(formula) == printed && rounded(simulated) == printed;
}

double Entry::tie_distance() const {
  return std::abs(formula - std::floor(formula) - 0.5);
}

int Table::disagreements() const {
  return static_cast<int>(std::count_if(entries.begin(), entries.end(), [](const Entry& e) { return !e.agrees(); }));
}

Table table1() {
  return make_table("table1", "Table 1: linear Acc/Dec, tau_A = 41 T", {0, 10, 20, 41}, printed1, linear(), true,
                    [](double feed_in, int delay) {
                      return LinearCorner(angle, feed_in, feed_ratio * feed_in, ramp_samples * sample_period,
                                          delay * sample_period)
                          .sampled_corner_error(sample_period);
                    });
}

Table table2() {
  const Filter filter = fir();
  return make_table("table2", "Table 2: FIR Acc/Dec, Blackman-windowed sinc, N = 40", {0, 5, 15, 41}, printed2, filter,
                    false, [&filter](double feed_in, int delay) {
                      const Corner corner = corner_of(feed_in);
                      return corner_error(Blend(filter, corner, delay, sample_period));
                    });
}

double formula_simulation_difference(const Table& table) {
  double largest = 0.0, difference = 0.0;
  for (const Entry& e : table.entries) {
    largest = std::max(largest, e.formula);
    difference = std::max(difference, std::abs(e.formula - e.simulated));
  }
  return largest > 0.0 ? difference / largest : difference;
}

}  // namespace accdec::paper
