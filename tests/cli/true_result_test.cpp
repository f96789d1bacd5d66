#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/paths.hpp"
#include "support/program_result.hpp"

// Results of `accdec program` that verify has to accept: of odd programs, of plan profiles, of earlier versions.

namespace accdec {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

struct TrueResult {
  const char *name, *program, *task;
  std::vector<std::string> options;
};

// Programs whose true results were refused once. They have steps of feed less than a nanometre before the end of a
// block, or blocks of some nanometres. They have circles so long that two sums of their times differ by more than a
// billionth of a sample, or limits used so little that rounding matters.
TEST_F(ProgramResult, TrueResultsAreAccepted) {
  const std::vector<TrueResult> all{
      {"a last step next to the end",
       "G64 P0.01\nF6000\nG1 X-0 Y2\nG1 X1.03 Y1.915881\nG0 X2.395335\nG1 X1.465599 Y2.756084\nG1 X1.46553 Y2.756216\n"
       "G1 X0.216961\nG2 X0.2327 Y2.781756 I26 J-16\n",
       "sample_period_ms = 1\n[[axis]]\nvelocity_max_mm_s = 50\njerk_max_mm_s3 = 400000\n[filter]\nkind = "
       "\"trapezoid\"\norder = 2\nramp = 1\n",
       {}},
      {"one line without limit on acceleration",
       "F300\nG1 X157 Y-185 Z-102\n",
       "sample_period_ms = 2\n[[axis]]\njerk_max_mm_s3 = 20000\n",
       {"--plan", "profiles"}},
      {"slow lines",
       "F5\nG61\nG1 X-0.2 Y0.3\nG1 X-0.3 Y0.4\n",
       "sample_period_ms = 2\n[[axis]]\njerk_max_mm_s3 = 5000\n",
       {"--plan", "fixed"}},
      {"arcs of some micrometres",
       "G64 P0.005\nF600\nG91\nG1 X-0.1 Y0.4\nG3 X0.04 Y-0.044 I0.020248 J-0.022136\nG3 X-17.6 Y-3.8 I-8.8 J-1.8796\n"
       "G61\nG2 X-0 Y-0 I-0.01 J-0\n",
       "sample_period_ms = 2\n[[axis]]\nacceleration_max_mm_s2 = 1000\njerk_max_mm_s3 = 100000\n",
       {"--plan", "profiles"}},
      {"a block of two nanometres",
       "G64 P0.1\nF3000\nG1 X1.966\nG1 X1.966 Y0.001\nG61\nG1 X3.166271 Y-1\nG1 Y-6.245656\nG1 X3.166273 Y-6.245655\n",
       "sample_period_ms = 0.2\n[[axis]]\nacceleration_max_mm_s2 = 20000\n[[axis]]\nvelocity_max_mm_s = 15.0\n"
       "acceleration_max_mm_s2 = 6000.0\n",
       {"--plan", "profiles"}},
      {"a long circle",
       "G64 P0.005 F600\nG3 I200\n",
       "sample_period_ms = 1\n[filter]\nkind = \"boxcar\"\norder = 9\n[[axis]]\nacceleration_max_mm_s2 = 1000\n",
       {}},
      // The time without delays was that of stops two samples longer than the plan's.
      {"stops of legs shorter than the filter",
       "G17\nG61.1\nF2679\nG1 X7.0746 Y0 Z0\nG2 I3.9194 J4.7341\nG1 X14.2213 Y13.2835 Z0\nG1 X7.0382 Y1.4841 Z0\n",
       "sample_period_ms = 4\n[filter]\nkind = \"trapezoid\"\norder = 5\nramp = 1\n[[axis]]\nname = \"x\"\n"
       "acceleration_max_mm_s2 = 829.3\njerk_max_mm_s3 = 92683.0\n[[axis]]\nname = \"y\"\n"
       "acceleration_max_mm_s2 = 679.2\njerk_max_mm_s3 = 34370.0\n[[axis]]\nname = \"z\"\n"
       "acceleration_max_mm_s2 = 440.2\njerk_max_mm_s3 = 28785.0\n",
       {"--compensate-arcs"}}};
  for (const TrueResult& one : all) {
    SCOPED_TRACE(one.name);
    folder_.write("part.ngc", one.program);
    folder_.write("mill.toml", one.task);
    std::vector<std::string> options = one.options;
    options.insert(options.end(), {"--time-limit", "2"});
    const Outcome planned = plan(options);
    ASSERT_EQ(planned.code, 0) << planned.err;
    const Outcome checked = verify();
    EXPECT_EQ(checked.code, 0) << checked.out << checked.err;
  }
}

/// Without a jerk limit plan profiles is the faster one, so that it is the answer.
class ProfilesResult : public ProgramResult {
 protected:
  void SetUp() override {
    ProgramResult::SetUp();
    std::string task = folder_.read("mill.toml");
    for (std::size_t at; (at = task.find("jerk_max_mm_s3 = 300000\n")) != std::string::npos;) task.erase(at, 24);
    folder_.write("mill.toml", task);
    ASSERT_EQ(plan({"--plan", "profiles"}).code, 0);
    good_ = json();
    ASSERT_EQ(good_["schema"], "accdec.program/2");
    ASSERT_EQ(good_["plan"], "profiles");
  }
  Json good_;
};

TEST_F(ProfilesResult, NoValueOfTheSummaryCanBeForged) {
  const Outcome checked = verify();
  EXPECT_EQ(checked.code, 0) << checked.out << checked.err;
  EXPECT_THAT(checked.out, StartsWith("accepted: "));
  EXPECT_THAT(checked.out, HasSubstr("read again: the plan passes its points in order"));
  std::vector<Json::json_pointer> all;
  for (const auto& [name, value] : good_.items()) {
    if (name != "inputs" && name != "commands" && checked.out.find(name) == std::string::npos)
      leaves(value, Json::json_pointer("/" + name), all);
  }
  EXPECT_GT(all.size(), 30U);
  for (const Json::json_pointer& at : all) {
    Json bad = good_;
    bad[at] = forged(good_[at]);
    EXPECT_NE(changed(bad).code, 0) << at.to_string() << " as " << bad[at].dump();
  }
  Json bad = good_;
  bad["solver"]["wall_time_s"] = -1.0;
  EXPECT_EQ(changed(bad).code, 1);
}

// The motion is in the file: it is made from there, not planned again, and another motion is not the recorded one.
TEST_F(ProfilesResult, ItsMotionIsMadeFromWhatIsRecorded) {
  const auto outcome = [&](const char* list, std::size_t index, double factor) {
    Json bad = good_;
    Json& value = bad["commands"]["trajectory"][list][index];
    value = factor * value.get<double>();
    return changed(bad);
  };
  EXPECT_EQ(outcome("ramp_m_s2", 0, 0.5).code, 1) << "braking later than there is room for, or slower than recorded";
  EXPECT_EQ(outcome("speed_m_s", 1, 0.9).code, 1) << "a slower corner";
  EXPECT_EQ(outcome("speed_m_s", 1, 5.0).code, 1) << "a corner faster than the acceleration allows";
  EXPECT_EQ(outcome("speed_m_s", 1, 1e3).code, 2) << "faster than the legs beside it";
  EXPECT_EQ(outcome("stretch_s2_m", 1, 1.5).code, 1) << "a corner cut more";
  EXPECT_EQ(outcome("feed_m_s", 0, 2.0).code, 2) << "above the path's feed";
  Json bad = good_;
  bad["commands"]["duration_s"][0] = 0.5 * good_["commands"]["duration_s"][0].get<double>();
  EXPECT_EQ(changed(bad).code, 1) << "a feed above the program's";
  bad = good_;
  bad["commands"]["error_m"][0] = good_["commands"]["error_m"][0].get<double>() + 1e-6;
  EXPECT_EQ(changed(bad).code, 1);
  bad = good_;
  bad["commands"]["trajectory"]["coast_s"].erase(0);
  EXPECT_EQ(changed(bad).code, 2);
}

TEST_F(ProfilesResult, IsPlottedButHasNoFilterToExport) {
  EXPECT_EQ(run({"plot", result_, "--out", folder_.path("p.svg")}).code, 0);
  EXPECT_THAT(run({"export", result_, "--format", "csv"}).err, HasSubstr("--plan profiles has no one filter"));
  EXPECT_EQ(run({"verify", result_, "--time-limit", "1e-9"}).code, 1);
  Json bad = good_;
  bad.erase("inputs");
  EXPECT_EQ(changed(bad).code, 1);
  EXPECT_THAT(run({"plot", result_, "--out", folder_.path("p.svg")}).err, HasSubstr("holds no commands to draw"));
  folder_.write("result.json", good_.dump());
  folder_.write("part.ngc", "G21 G90 G64 P1\nF6000\nG1 X30 Y0\nM2\n");
  EXPECT_THAT(verify().out, HasSubstr("part.ngc has changed since"));
}

/// Files that version 0.2.0 wrote before the plans had one result: accdec.program/1 of plans fixed and per-leg, and
/// accdec.profiles/1.
class EarlierResult : public ::testing::TestWithParam<const char*> {
 protected:
  /// The file, with the names of its inputs where they are now.
  Json earlier() {
    const std::string from = test_support::source_folder() + "/tests/cli/earlier/";
    const auto text = [&](const std::string& name) {
      std::ifstream in(from + name);
      return std::string(std::istreambuf_iterator<char>(in), {});
    };
    std::string json = text(GetParam() + std::string(".json"));
    for (const std::string name : {"part.ngc", "line.ngc", "mill.toml"}) {
      const std::string path = folder_.write(name, text(name)), quoted_name = '"' + name + '"';
      for (std::size_t at = 0; (at = json.find(quoted_name, at)) != std::string::npos; at += path.size() + 2)
        json.replace(at, quoted_name.size(), '"' + path + '"');
    }
    return Json::parse(json);
  }
  Outcome verify(const Json& json) { return run({"verify", folder_.write("result.json", json.dump(1))}); }

  TemporaryFolder folder_;
};

TEST_P(EarlierResult, IsReadAndVerified) {
  const Json good = earlier();
  const Outcome checked = verify(good);
  EXPECT_EQ(checked.code, 0) << checked.out << checked.err;
  EXPECT_THAT(checked.out, StartsWith("accepted: "));
  for (const char* pointer : {"/cycle_time_s", "/samples", "/corners/count", "/blocks", "/limits/1/value"}) {
    Json bad = good;
    bad[Json::json_pointer(pointer)] = forged(good[Json::json_pointer(pointer)]);
    EXPECT_EQ(verify(bad).code, 1) << pointer;
  }
  folder_.write("result.json", good.dump(1));
  EXPECT_EQ(run({"plot", folder_.path("result.json"), "--out", folder_.path("p.svg")}).code, 0);
}

INSTANTIATE_TEST_SUITE_P(OfAllKinds, EarlierResult, ::testing::Values("fixed", "per-leg", "profiles"),
                         [](const auto& info) { return info.param == std::string("per-leg") ? "perLeg" : info.param; });

}  // namespace
}  // namespace accdec
