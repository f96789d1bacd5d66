#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include <accdec/certificate/checked_rows.hpp>
#include <accdec/exact/rows.hpp>
#include <accdec/filter.hpp>
#include <accdec/machine.hpp>

#include "support/tasks.hpp"

// Rows of forces behind a servo, of the checker and of the search, against simulated loops.

namespace accdec {
namespace {

constexpr int window_order = 14;

/// Velocities 0 .. last of an axis behind its servo, which has followed the speed `in` for long. The command goes to
/// `out` after the delay. A loop changes its following error e by e' = (1 - g) v - Kv e.
std::vector<double> moved(const Filter& filter, double in, double out, int delay, const Axis& axis, double period,
                          int last) {
  const auto command = [&](int k) { return in * filter.remaining(k) + out * filter.cumulative(k - delay); };
  std::vector<double> velocities;
  const double left = std::exp(-axis.servo_gain * period), fed = 1.0 - axis.velocity_feedforward;
  double error = in * fed / axis.servo_gain;
  for (int k = 0; k <= last; ++k) {
    if (!axis.response_taps.empty()) {
      double sum = 0.0;
      for (std::size_t j = 0; j < axis.response_taps.size(); ++j)
        sum += axis.response_taps[j] * command(k - static_cast<int>(j));
      velocities.push_back(sum);
      continue;
    }
    const double next = left * error + (1.0 - left) * fed * command(k) / axis.servo_gain;
    velocities.push_back(command(k) - (next - error) / period);
    error = next;
  }
  return velocities;
}

/// A random filter, servo and limit of a force that some sample uses as a whole.
struct Trial {
  Task task;
  Filter filter = Filter({1.0});
  proof::Row row;
  int delay = 0, sample = 1;

  explicit Trial(std::mt19937& random) {
    const auto whole = [&](int low, int high) { return std::uniform_int_distribution<int>(low, high)(random); };
    const auto real = [&](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(random);
    };
    std::vector<double> taps{0.1};
    for (int i = whole(0, 25); i > 0; --i) taps.push_back(real(0.0, 1.0));
    filter = Filter(taps);
    Axis axis;
    axis.mass = real(1.0, 50.0), axis.damping = whole(0, 1) * real(0.0, 300.0), axis.coulomb = whole(0, 1) * 5.0;
    if (whole(0, 1) == 1)
      axis.response_taps = {0.1, 0.3, 0.4, 0.2};
    else
      axis.servo_gain = real(200.0, 2000.0), axis.velocity_feedforward = whole(0, 1) * 0.7;
    task = testing::plane_task(axis, testing::plane_corner("A", 140.0, 15.0, 0.1, real(0.05, 0.1)), 50e-6);
    const exact::Legs v = exact::legs(task.corners[0], 0);
    const int kind = whole(0, 2), sign = whole(0, 1) == 1 ? 1 : -1;
    delay = kind == 2 ? whole(0, 12) : 0, sample = whole(1, filter.order() + 20 + delay);
    // A start pushes forwards, a stop backwards.
    const double in = kind == 0 ? 0.0 : kind == 1 ? v.out : v.in, out = kind == 0 ? v.in : kind == 1 ? 0.0 : v.out;
    const double side = kind == 2 ? sign : kind == 1 ? -1.0 : 1.0;
    const std::vector<double> velocity = moved(filter, in, out, delay, axis, task.sample_period, sample);
    const double now = velocity.back(), before = velocity[velocity.size() - 2];
    const double force = axis.mass * (now - before) / task.sample_period + axis.damping * now + axis.coulomb;
    for (Axis& x : task.machine.axes) x.force_max = side * force;
    if (kind == 2)
      row = proof::Blend{LimitKind::force, 0, 0, sample, sign};
    else
      row = proof::EventForce{kind == 1, 0, sample};
  }
  bool binds() const { return task.machine.axes[0].force_max > 1.0; }
};

proof::Row shifted(proof::Row row, int by) {
  if (auto* blend = std::get_if<proof::Blend>(&row)) blend->sample += by;
  if (auto* force = std::get_if<proof::EventForce>(&row)) force->sample += by;
  return row;
}

CheckedBox checked_box(const Trial& trial, std::optional<int> window) {
  CheckedBox box;
  box.window = window.has_value();
  box.order = window.value_or(trial.filter.order());
  box.corners = {{trial.delay, trial.delay, 0, 1000}};
  return box;
}

/// How far the checker's row is above its bound, for the filter moved by some samples and into a window.
double excess_of_checker(const Trial& trial, int shift, std::optional<int> window) {
  CheckedBox box = checked_box(trial, window);
  CheckedSum sum(box.order, box.window);
  CheckedRows(trial.task).add({shifted(trial.row, shift), 1.0}, box, sum);
  double value = -sum.rhs.hi;
  for (int i = 0; i <= trial.filter.order(); ++i) {
    const int column = std::clamp(i + shift, 0, box.order);
    double weight = sum.taps[static_cast<std::size_t>(column)].lo;
    for (int k = column + 1; k <= box.order + 1; ++k) weight += sum.cumulative[static_cast<std::size_t>(k)].lo;
    value += weight * trial.filter.tap(i);
  }
  return value;
}

double excess_of_search(const Trial& trial, int shift, std::optional<int> window) {
  const exact::ConvexRows rows(trial.task);
  exact::Box box;
  box.window = window.has_value();
  box.order = window.value_or(trial.filter.order());
  box.corners = {{trial.delay, trial.delay, 0, 1000}};
  const proof::Row id = shifted(trial.row, shift);
  const auto* blend = std::get_if<proof::Blend>(&id);
  const exact::SparseRow row =
      blend != nullptr ? rows.row(*blend, box) : rows.row(std::get<proof::EventForce>(id), box);
  EXPECT_TRUE(row.of_motion);
  std::vector<double> weights(static_cast<std::size_t>(box.order) + 1, 0.0);
  rows.add_motion(row, 1.0, box.window, weights);
  double value = row.constant - 1.0;
  for (int i = 0; i <= trial.filter.order(); ++i)
    value += weights[static_cast<std::size_t>(std::clamp(i + shift, 0, box.order))] * trial.filter.tap(i);
  return value;
}

TEST(RowsBehindAServo, AreTheForcesOfALoop) {
  std::mt19937 random(3);
  int count = 0;
  for (int i = 0; i < 2000; ++i) {
    const Trial trial(random);
    if (!trial.binds()) continue;
    ++count;
    EXPECT_NEAR(excess_of_checker(trial, 0, std::nullopt), 0.0, 1e-9) << i;
    EXPECT_NEAR(excess_of_search(trial, 0, std::nullopt), 0.0, 1e-9) << i;
  }
  EXPECT_GT(count, 500);
}

/// A filter is moved into a window; what lies beyond is added to its ends. Every force that holds keeps the row.
TEST(RowsBehindAServo, HoldInWindowsForFiltersOfAnyOrder) {
  std::mt19937 random(4);
  int count = 0;
  double most = -1.0;
  for (int i = 0; i < 4000; ++i) {
    const Trial trial(random);
    const int shift = std::uniform_int_distribution<int>(-20, 10)(random);
    if (!trial.binds() || trial.sample + shift < 1) continue;
    ++count;
    const double checker = excess_of_checker(trial, shift, window_order);
    EXPECT_LE(checker, 1e-9) << i;
    EXPECT_LE(excess_of_search(trial, shift, window_order), 1e-9) << i;
    most = std::max(most, checker);
  }
  EXPECT_GT(count, 500);
  EXPECT_GT(most, -1e-9);  // some filters are inside as a whole
}

}  // namespace
}  // namespace accdec
