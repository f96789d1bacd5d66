#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <accdec/files/process.hpp>
#include <accdec/result.hpp>
#include <accdec/task.hpp>
#include <accdec/verify.hpp>

#include "support/paths.hpp"
#include "support/temporary_folder.hpp"

namespace accdec {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

DesignResult two_corners() {
  return evaluate_task(
      parse_task("sample_period_ms = 1.0\n[filter]\nkind = \"boxcar\"\norder = 19\n"
                 "[[corner]]\nname = \"first one\"\nangle_deg = 90\nfeed_in_mm_min = 6000\ndelay_samples = 0\n"
                 "[[corner]]\nname = \"second\"\nangle_deg = 90\nfeed_in_mm_min = 6000\ndelay_samples = 20\n",
                 "task.toml"));
}

class PlotCommand : public testing::Test {
 protected:
  ProcessOutput plot(const std::string& out, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments{accdec::test_support::program(), "plot", folder_.path("r.json"), "--out",
                                       folder_.path(out)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_process(arguments, "", "accdec");
  }
  void SetUp() override { folder_.write("r.json", result_to_json(two_corners())); }
  TemporaryFolder folder_;
};

TEST_F(PlotCommand, WritesEveryFormat) {
  const std::pair<const char*, const char*> formats[] = {
      {"p.svg", "<?xml"}, {"p.png", "\x89PNG"}, {"p.pdf", "%PDF-"}, {"p.html", "<!DOCTYPE html>"}};
  for (const auto& [name, start] : formats) {
    const ProcessOutput done = plot(name);
    EXPECT_EQ(done.exit_code, 0) << done.errors;
    EXPECT_THAT(folder_.read(name), StartsWith(start)) << name;
  }
}

TEST_F(PlotCommand, RefusesWithNothingWritten) {
  const ProcessOutput extension = plot("p.jpg");
  EXPECT_EQ(extension.exit_code, 2);
  EXPECT_THAT(extension.errors, HasSubstr(".svg, .png, .pdf or .html"));
  const ProcessOutput corner = plot("p.svg", {"--corner", "secnod"});
  EXPECT_EQ(corner.exit_code, 2);
  EXPECT_THAT(corner.errors, HasSubstr("it has: first one, second"));
  EXPECT_EQ(plot("nowhere/p.svg").exit_code, 2);
  folder_.write("r.json", "{}");
  EXPECT_EQ(plot("p.svg").exit_code, 2);
  EXPECT_EQ(folder_.count(), 1u);
}

}  // namespace
}  // namespace accdec
