#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/certificate.hpp>
#include <accdec/design.hpp>
#include <accdec/formats/task_writer.hpp>
#include <accdec/result.hpp>
#include <accdec/task.hpp>
#include <accdec/task/settings_text.hpp>
#include <accdec/verify.hpp>

#include "support/paths.hpp"
#include "support/tasks.hpp"

// Settings of controllers against brute force: every member, every delay and every width, by the formulas of the model
// written once more.

namespace accdec {
namespace {

using accdec::testing::random_task;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double none = std::numeric_limits<double>::infinity();

std::vector<double> convolve(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> c(a.size() + b.size() - 1, 0.0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) c[i + j] += a[i] * b[j];
  }
  return c;
}

double response(const std::vector<double>& taps, int k) {
  double sum = 0.0;
  for (int i = 0; i < k && i < static_cast<int>(taps.size()); ++i) sum += taps[static_cast<std::size_t>(i)];
  return sum;
}

/// sum b_i max(i - k, 0), or with sign -1 sum b_i max(k - i, 0).
double way(const std::vector<double>& taps, int k, int sign) {
  double sum = 0.0;
  for (std::size_t i = 0; i < taps.size(); ++i) sum += taps[i] * std::max(0, sign * (static_cast<int>(i) - k));
  return sum;
}

bool sample_holds(const Axis& axis, double v, double a, double jerk) {
  const double force = axis.mass * a + axis.damping * v, slack = 1.0 + 1e-9;
  return std::abs(v) <= axis.velocity_max * slack && std::abs(a) <= axis.acceleration_max * slack &&
         std::abs(jerk) <= axis.jerk_max * slack && std::abs(force) <= axis.force_max * slack &&
         force * v <= axis.power_max * slack && -force * v <= axis.regeneration_max * slack;
}

/// Rest, leg 1, the corner with this delay, leg 2, rest: all limits of a corner.
bool holds(const Task& task, const TaskCorner& corner, const std::vector<double>& taps, int delay) {
  const Corner& g = corner.geometry();
  const double period = task.sample_period;
  const int n = static_cast<int>(taps.size()) - 1;
  const auto events = [&](int axis, int event, int k) {
    const double in = g.feed_in * g.direction_in[axis], out = g.feed_out * g.direction_out[axis];
    if (event == 0) return in * response(taps, k);
    if (event == 1) return in * (1.0 - response(taps, k)) + out * response(taps, k - delay);
    return out * (1.0 - response(taps, k));
  };
  double nearest = none, slowest = none;
  for (int event = 0; event < 3; ++event) {
    for (int k = 0; k <= n + delay + 3; ++k) {
      double speed = 0.0;
      for (int axis = 0; axis < 2; ++axis) {
        const double v = events(axis, event, k), a = (v - events(axis, event, k - 1)) / period;
        const double before = (events(axis, event, k - 1) - events(axis, event, k - 2)) / period;
        if (!sample_holds(task.machine.axes[static_cast<std::size_t>(axis)], v, a, (a - before) / period)) return false;
        speed += v * v;
      }
      if (event != 1) continue;
      slowest = std::min(slowest, std::sqrt(speed));
      const Eigen::VectorXd s = period * (g.feed_out * way(taps, k - delay, -1) * g.direction_out -
                                          g.feed_in * way(taps, k, 1) * g.direction_in);
      nearest = std::min(nearest, s.norm());
    }
  }
  return nearest <= *corner.error_max * (1.0 + 1e-9) && slowest * (1.0 + 1e-9) >= corner.speed_min;
}

/// The cheapest delays of a filter, samples of the objective.
double cheapest(const Task& task, const std::vector<double>& taps) {
  const int n = static_cast<int>(taps.size()) - 1;
  const auto& kinds = task.settings->delays;
  const auto has = [&](DelayKind kind) { return std::find(kinds.begin(), kinds.end(), kind) != kinds.end(); };
  const bool any = kinds.empty() || has(DelayKind::dwell);
  std::vector<std::vector<bool>> good;
  for (const TaskCorner& corner : task.corners) {
    good.emplace_back();
    for (int d = 0; d <= n + 2; ++d) good.back().push_back(holds(task, corner, taps, d));
  }
  std::vector<double> widths{none};
  if (has(DelayKind::in_position)) {
    for (const TaskCorner& corner : task.corners) {
      for (int d = 0; d <= n; ++d) widths.push_back(corner.geometry().feed_in * way(taps, d, 1));
    }
    std::sort(widths.begin(), widths.end());
    const std::vector<double> ends = widths;
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
      if (std::isfinite(ends[i + 1])) widths.push_back(0.5 * (ends[i] + ends[i + 1]));
    }
  }
  double best = none;
  for (const double width : widths) {
    double cost = task.design.runs * (n + 1);
    for (std::size_t j = 0; j < task.corners.size(); ++j) {
      double least = none;
      for (int d = 0; d <= n + 2; ++d) {
        const double feed = task.corners[j].geometry().feed_in;
        const bool by_width = has(DelayKind::in_position) && feed * way(taps, d, 1) <= width &&
                              (d == 0 || feed * way(taps, d - 1, 1) > width);
        const bool kind = any || (d == 0 && has(DelayKind::continuous)) || (d >= n && has(DelayKind::exact_stop));
        if ((kind || by_width) && good[j][static_cast<std::size_t>(d)]) least = std::min<double>(least, d);
      }
      cost += task.corners[j].weight * least;
    }
    best = std::min(best, cost);
  }
  return best;
}

std::vector<double> average(int length) {
  return std::vector<double>(static_cast<std::size_t>(length), 1.0 / length);
}

/// The least cost of all members of the task's one family.
double brute_force(const Task& task) {
  const ControllerSettings& settings = *task.settings;
  const SettableStage& stage = settings.stages.front();
  std::vector<int> lengths;
  for (int length = 1; length <= task.design.order_max + 1; ++length) {
    const double time = length * task.sample_period;
    const int step = std::max(1, static_cast<int>(std::lround(stage.length_step / task.sample_period)));
    const bool capped = stage.length_max > 0.0 && time > stage.length_max * (1.0 + 1e-9);
    if (length % step == 0 && !capped) lengths.push_back(length);
  }
  double best = none;
  const auto offer = [&](const std::vector<double>& taps) {
    const int order = static_cast<int>(taps.size()) - 1;
    if (order >= task.design.order_min && order <= task.design.order_max) best = std::min(best, cheapest(task, taps));
  };
  if (settings.families.front() == SettingFamily::one_pole) {
    for (const int tau : lengths) {
      const int taps = static_cast<int>(std::ceil(std::log(1e4) * tau));
      std::vector<double> pole;
      double sum = 0.0;
      for (int i = 0; i < taps; ++i) pole.push_back(std::exp(-static_cast<double>(i) / tau)), sum += pole.back();
      for (double& tap : pole) tap /= sum;
      if (taps - 1 <= task.design.order_max) offer(pole);
    }
    return best;
  }
  if (lengths.empty() || lengths.front() != 1) lengths.insert(lengths.begin(), 1);
  for (const int a : lengths) {
    for (const int b : lengths) {
      if (b > a) break;
      if (settings.families.front() == SettingFamily::averages) {
        offer(convolve(average(a), average(b)));
        continue;
      }
      for (int delay = 1; delay <= task.design.order_max; ++delay) {
        std::vector<double> pair(static_cast<std::size_t>(delay) + 1, 0.0);
        pair.front() = pair.back() = 0.5;
        if (a + b - 2 + delay <= task.design.order_max) offer(convolve(convolve(average(a), average(b)), pair));
      }
    }
  }
  return best;
}

void expect_as_brute_force(const Task& task, const std::string& what) {
  const double expected = brute_force(task);
  const DesignResult result = design_task(task);
  if (std::isinf(expected)) {
    EXPECT_EQ(result.status, Status::infeasible) << what << ": " << result.message;
  } else {
    ASSERT_EQ(result.status, Status::optimal) << what << ": " << result.message;
    EXPECT_NEAR(result.objective() / task.sample_period, expected, 1e-6) << what;
    EXPECT_EQ(result.family_bound, result.objective()) << what;
    EXPECT_LE(result.lower_bound.value_or(0.0), result.objective()) << what;
  }
  EXPECT_THAT(verify_result(result).reasons, IsEmpty()) << what;
}

Task settable(std::mt19937& rng, SettingFamily family, std::vector<DelayKind> delays, int corners, int order_max) {
  std::uniform_real_distribution<double> u(0.0, 1.0);
  Task task = random_task(rng, corners);
  task.design.order_max = order_max;
  task.design.runs = 0.5 + u(rng);
  ControllerSettings settings;
  settings.families = {family};
  settings.stages.resize(family == SettingFamily::one_pole ? 1 : 2);
  for (SettableStage& stage : settings.stages) {
    stage.length_step = u(rng) < 0.5 ? 0.0 : 3e-3;
    stage.length_max = u(rng) < 0.7 ? 0.0 : 12e-3;
  }
  settings.stages.back() = settings.stages.front();
  settings.shaper_pairs = family == SettingFamily::shaper ? 1 : 0;
  settings.delays = std::move(delays);
  task.settings = settings;
  return task;
}

TEST(Settings, AreTheBestOfAllByBruteForce) {
  const std::vector<std::vector<DelayKind>> kinds{{},
                                                  {DelayKind::continuous},
                                                  {DelayKind::exact_stop},
                                                  {DelayKind::in_position},
                                                  {DelayKind::continuous, DelayKind::exact_stop},
                                                  {DelayKind::in_position, DelayKind::exact_stop},
                                                  {DelayKind::dwell, DelayKind::in_position}};
  std::mt19937 rng(26);
  for (int i = 0; i < 28; ++i) {
    const auto& delays = kinds[static_cast<std::size_t>(i) % kinds.size()];
    const std::string what = "averages, task " + std::to_string(i);
    expect_as_brute_force(settable(rng, SettingFamily::averages, delays, 1 + i % 3, 30), what);
  }
}

TEST(Settings, OfPolesAndShapersAreTheBestOfAllByBruteForce) {
  std::mt19937 rng(27);
  for (int i = 0; i < 6; ++i) {
    const std::vector<DelayKind> delays = i % 2 == 0 ? std::vector<DelayKind>{} : std::vector{DelayKind::in_position};
    expect_as_brute_force(settable(rng, SettingFamily::one_pole, delays, 2, 120), "pole " + std::to_string(i));
    expect_as_brute_force(settable(rng, SettingFamily::shaper, delays, 1, 18), "shaper " + std::to_string(i));
  }
}

Task corner_task(const std::string& more) {
  return parse_task(
      "sample_period_ms = 1\n[[axis]]\nacceleration_max_mm_s2 = 6000\njerk_max_mm_s3 = 500000\n"
      "[[corner]]\nangle_deg = 95\nfeed_in_mm_min = 6000\nerror_max_um = 50\n" +
          more,
      "task");
}

// At 0.1 m/s, 6 m/s^2 and 500 m/s^3, 17 and 12 ms hold the limits of a start. Legs that do not overlap need no more.
TEST(Settings, OfExactStopsAreTheClosedForm) {
  const DesignResult result =
      design_task(corner_task("[design]\nfamily = \"averages\"\n[controller]\ndelays = [\"exact-stop\"]\n"));
  ASSERT_EQ(result.status, Status::optimal);
  EXPECT_EQ(settings_in_words(*result.settings), "averages of 17 ms and 12 ms");
  EXPECT_NEAR(result.cycle_time, 57e-3, 1e-12);  // N = 27, d = 28: the jerk of the last and the first step add up
}

TEST(Settings, AnswerFirst) {
  const DesignResult result = design_task(corner_task(
      "[design]\nfamily = \"averages\"\n[controller]\ndelays = \"in-position\"\n[filter]\nkind = \"averages\"\n"
      "lengths = [20, 20]\n"));
  const std::string answer = settings_answer(result);
  EXPECT_THAT(answer, ::testing::StartsWith("Set these: averages of "));
  EXPECT_THAT(answer, HasSubstr("in-position width "));
  EXPECT_THAT(answer, HasSubstr("proved best for this family. Free taps would take 42 ms"));
  EXPECT_THAT(answer, HasSubstr("retuning saves "));
  ASSERT_TRUE(result.savings);
  EXPECT_GT(result.savings->total, 0.0);
  ASSERT_TRUE(result.settings->width);
  EXPECT_LT(result.settings->width->low, result.settings->width->high);
}

TEST(Settings, SurviveFiles) {
  const Task task = corner_task(
      "[design]\nfamily = [\"averages\", \"shaper\"]\nstages = 2\nshaper = \"zvd\"\nlength_step_ms = [1, 2]\n"
      "length_max_ms = 30\n[controller]\ndelays = [\"in-position\", \"exact-stop\"]\n");
  EXPECT_EQ(task_to_toml(parse_task(task_to_toml(task), "again")), task_to_toml(task));
  const DesignResult result = design_task(task);
  ASSERT_EQ(result.status, Status::optimal) << result.message;
  const std::string text = result_to_json(result);
  const DesignResult again = parse_result(text, "result");
  EXPECT_EQ(result_to_json(again), text);
  EXPECT_THAT(verify_result(again).reasons, IsEmpty());
}

TEST(Settings, ThatDoNotExistSayWhichLimitAndTheNearest) {
  const DesignResult result = design_task(corner_task("[design]\nfamily = \"averages\"\nlength_max_ms = 10\n"));
  EXPECT_EQ(result.status, Status::infeasible);
  EXPECT_THAT(result.message, HasSubstr("the longest averages break jerk"));
  EXPECT_THAT(result.message, HasSubstr("averages of 17 ms and 13 ms"));
  EXPECT_THAT(verify_result(result).reasons, IsEmpty());
  // The same certificate is no proof for a control that may set more.
  DesignResult forged = result;
  for (SettableStage& stage : forged.task.settings->stages) stage.length_max = 0.0;
  EXPECT_FALSE(verify_result(forged).accepted);
}

TEST(Settings, AreNotForged) {
  const DesignResult result =
      design_task(corner_task("[design]\nfamily = \"averages\"\n[controller]\ndelays = \"in-position\"\n"));
  ASSERT_EQ(result.status, Status::optimal);
  const auto refused = [&](const auto& forge) {
    DesignResult forged = result;
    forge(forged);
    return !verify_result(forged).accepted;
  };
  EXPECT_FALSE(refused([](DesignResult&) {}));
  EXPECT_TRUE(refused([](DesignResult& r) { r.settings.reset(); }));
  EXPECT_TRUE(refused([](DesignResult& r) { r.settings->values[0].value += 1.0; }));
  EXPECT_TRUE(refused([](DesignResult& r) { r.settings->width->high *= 2.0; }));
  EXPECT_TRUE(refused([](DesignResult& r) { r.settings->width.reset(); }));
  EXPECT_TRUE(refused([](DesignResult& r) { r.settings->delays[0] = DelayKind::continuous; }));
  EXPECT_TRUE(refused([](DesignResult& r) { r.family_bound.reset(); }));
  EXPECT_TRUE(refused([](DesignResult& r) { *r.free_taps *= 0.5; }));
  EXPECT_TRUE(refused([](DesignResult& r) { *r.lower_bound *= 1.02, r.gap = 1.0 - *r.lower_bound / r.objective(); }));
  // A controller of longer steps does not have this filter.
  EXPECT_TRUE(refused([](DesignResult& r) { r.task.settings->stages[0].length_step = 5e-3; }));
  // A slower member, honestly recorded, is not the best.
  EXPECT_TRUE(refused([](DesignResult& r) {
    Task slower = r.task;
    slower.settings->stages[0].length_step = slower.settings->stages[1].length_step = 8e-3;
    const Task asked = r.task;
    r = design_task(slower);
    r.task = asked;
  }));
}

}  // namespace
}  // namespace accdec
