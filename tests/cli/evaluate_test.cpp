#include <algorithm>
#include <cmath>
#include <complex>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/paths.hpp"
#include "support/run.hpp"

// The answers of `accdec evaluate`, against the paper and closed forms.

namespace accdec {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::ordered_json;

const std::string problems_of_evaluate = accdec::test_support::source_folder() + "/problems/";

TEST(CliEvaluate, GivesThePapersTable2) {
  const Outcome outcome = run({"evaluate", problems_of_evaluate + "paper/table2.toml", "--json", "-"});
  EXPECT_EQ(outcome.code, 0);
  const Json json = Json::parse(outcome.out);  // nothing but JSON on standard output
  const double printed[] = {2442, 1333, 241, 0};
  for (std::size_t j = 0; j < 4; ++j)
    EXPECT_EQ(std::round(1e6 * json["corners"][j]["corner_error_m"].get<double>()), printed[j]);
}

// 41 equal taps at 1 ms: sigma^2 = (41^2 - 1)/12 ms^2, and |H| is the Dirichlet kernel of 41 samples.
TEST(CliEvaluate, RecordsTheErrorOfACircle) {
  const std::vector<std::string> command{"evaluate",
                                         problems_of_evaluate + "paper/table1.toml",
                                         "--circle-radius-mm",
                                         "20",
                                         "--circle-feed-mm-min",
                                         "6000",
                                         "--json",
                                         "-"};
  const Outcome outcome = run(command);
  EXPECT_EQ(outcome.code, 0);
  const Json circle = Json::parse(outcome.out)["circle"];
  EXPECT_DOUBLE_EQ(circle["radius_m"], 0.02);
  EXPECT_DOUBLE_EQ(circle["feed_m_s"], 0.1);
  const double sigma = std::sqrt((41.0 * 41.0 - 1.0) / 12.0) * 1e-3, half = 0.5 * 0.1 * 1e-3 / 0.02;
  EXPECT_NEAR(circle["deviation_s"], sigma, 1e-12);
  EXPECT_NEAR(circle["small_angle_m"], 0.1 * 0.1 * sigma * sigma / (2.0 * 0.02), 1e-15);
  EXPECT_NEAR(circle["radius_error_m"], 0.02 * (1.0 - std::sin(41.0 * half) / (41.0 * std::sin(half))), 1e-14);
  // The mean of 41 points of the circle, as far from it as any once the filter is full.
  double x = 0.0, y = 0.0;
  for (int i = 0; i < 41; ++i) x += 0.02 * std::cos(2.0 * half * i) / 41.0, y += 0.02 * std::sin(2.0 * half * i) / 41.0;
  EXPECT_NEAR(circle["simulated_m"], 0.02 - std::hypot(x, y), 1e-12);
  const TemporaryFolder folder;
  EXPECT_EQ(run({"verify", folder.write("true.json", outcome.out)}).code, 0);
  for (const char* name : {"feed_m_s", "radius_error_m", "simulated_m"}) {
    Json lie = Json::parse(outcome.out);
    lie["circle"][name] = 1.001 * lie["circle"][name].get<double>();
    const Outcome check = run({"verify", folder.write("lie.json", lie.dump())});
    EXPECT_EQ(check.code, 1) << name;
    EXPECT_THAT(check.out, HasSubstr("circle."));
  }
}

// A servo of taps r_0 = 1 - c, c (1 - a) a^(k - 1) has H = 1 - c + c (1 - a) z/(1 - a z), z = exp(-j w T).
TEST(CliEvaluate, CirclesAreThoseOfTheServos) {
  const TemporaryFolder folder;
  const double period = 1e-3, radius = 0.02, angle = 0.1 * period / radius;
  const auto response = [&](double gain) {
    const double a = std::exp(-gain * period), c = (1.0 - a) / (gain * period);
    const std::complex<double> z = std::polar(1.0, -angle);
    return 1.0 - c + c * (1.0 - a) * z / (1.0 - a * z);
  };
  const auto measured = [&](double x, double y) {
    const std::string axes =
        fmt::format("[[axis]]\nname = \"x\"\nservo_gain_1_s = {}\n[[axis]]\nname = \"y\"\nservo_gain_1_s = {}\n", x, y);
    const std::string task =
        folder.write("t.toml", "sample_period_ms = 1\n" + axes +
                                   "[[corner]]\nangle_deg = 90\nfeed_in_mm_min = 6000\ndelay_samples = 0\n[filter]\n"
                                   "kind = \"boxcar\"\norder = 0\n");
    const Outcome outcome =
        run({"evaluate", task, "--circle-radius-mm", "20", "--circle-feed-mm-min", "6000", "--json", "-"});
    EXPECT_EQ(run({"verify", folder.write("r.json", outcome.out)}).code, 0);
    return Json::parse(outcome.out)["circle"]["radius_error_m"].get<double>();
  };
  EXPECT_NEAR(measured(200, 200), radius * (1.0 - std::abs(response(200))), 1e-9);
  const auto x = response(200), y = response(140);
  const double mean = 0.5 * (std::norm(x) + std::norm(y)), half = 0.5 * std::abs(x * x - y * y);
  EXPECT_NEAR(measured(200, 140), radius * std::max(1.0 - std::sqrt(mean - half), std::sqrt(mean + half) - 1.0), 1e-9);
}

TEST(CliEvaluate, GivesFigure12) {
  const auto errors = [](const char* name) {
    std::vector<double> values;
    const Json json = Json::parse(run({"evaluate", problems_of_evaluate + "paper/" + name, "--json", "-"}).out);
    for (const Json& corner : json["corners"]) values.push_back(1e6 * corner["corner_error_m"].get<double>());
    return values;
  };
  // The linear case needs 14 T, not the 12 T the paper prints, to come down to the error of the FIR filter.
  const double fir = errors("fig12-fir.toml")[0];
  EXPECT_NEAR(fir, 415.6, 0.05);
  EXPECT_NEAR(errors("fig12-s-curve.toml")[1], 412.5, 0.05);
  const auto linear = errors("fig12-linear.toml");
  EXPECT_GT(linear[1], 1.1 * fir);
  EXPECT_LT(linear[2], fir);
}

TEST(CliEvaluate, NamesTheCornerWithoutDelay) {
  const Outcome outcome = run({"evaluate", problems_of_evaluate + "machine/given-filter.toml"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("corner A has no `delay_samples`"));
  EXPECT_THAT(outcome.err, Not(HasSubstr(":1:1:")));
}

/// Axes a, b and c are in degrees and have torques, as the task wrote them.
TEST(CliEvaluate, GivesRotaryAxesInDegrees) {
  const TemporaryFolder folder;
  const std::string task =
      "sample_period_ms = 1\n[filter]\nkind = \"averages\"\nlengths = [40, 20]\n[[axis]]\nname = \"x\"\n"
      "acceleration_max_mm_s2 = 6000\n[[axis]]\nname = \"a\"\nvelocity_max_deg_s = 180\ninertia_kg_m2 = 0.8\n"
      "torque_max_N_m = 60\n[[corner]]\ndirection_in = [1, 0]\ndirection_out = [0, 1]\nfeed_in_mm_min = 6000\n"
      "delay_samples = 20\n";
  const Outcome outcome = run({"evaluate", folder.write("a.toml", task)});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  // 100 deg/s within 40 ms: 2500 deg/s^2 of 0.8 kg m^2
  EXPECT_THAT(outcome.out, ContainsRegex("velocity +a .* 100 +180 +deg/s"));
  EXPECT_THAT(outcome.out, ContainsRegex("torque +a .* 34.9066 +60 +N m"));
  const Outcome fast = run({"evaluate", folder.write("a.toml", std::string(task).replace(task.find("180"), 3, "50"))});
  EXPECT_THAT(fast.err, HasSubstr("asks axis a for 100 deg/s; allowed is velocity_max_deg_s = 50"));
}

}  // namespace
}  // namespace accdec
