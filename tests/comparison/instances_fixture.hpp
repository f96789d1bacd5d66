#pragma once

#include <array>
#include <cstdio>
#include <optional>
#include <string>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "support/command_fixture.hpp"

namespace accdec::testing {

inline std::string output_of(const std::string& command) {
  std::string text;
  FILE* pipe = ::popen(command.c_str(), "r");
  std::array<char, 4096> buffer{};
  while (std::fgets(buffer.data(), buffer.size(), pipe)) text += buffer.data();
  ::pclose(pipe);
  return text;
}

/// Limits for which the shortest corner is 17 samples at order 14.
constexpr const char* task_text = R"(sample_period_ms = 1.0
[[axis]]
acceleration_max_mm_s2 = 6000
jerk_max_mm_s3 = 1500000
[[corner]]
name = "A"
angle_deg = 95
heading_deg = 30
feed_in_mm_min = 2500
error_max_um = 40
)";

/// `accdec instances` in a folder with a small suite.
class Instances : public CommandInFolder {
 protected:
  void SetUp() override {
    CommandInFolder::SetUp();
    write(home_ / "task.toml", task_text);
    write(home_ / "ringing.toml", std::string(task_text) + "[[mode]]\nfrequency_Hz = [60, 70]\nresidual_max = 0.2\n");
    write(home_ / "suite.toml", R"(title = "Mini"
solvers = ["ipopt"]
[[problem]]
name = "small corner"
task = "task.toml"
formulation = ["design", "margin", "delay"]
order = 14
[[problem]]
name = "vibration"
task = "ringing.toml"
formulation = "margin"
order = 14
[[problem]]
name = "power"
task = "task.toml"
set = { "axis.*.mass_kg" = 30, "axis.*.power_max_W" = 5, "corner.A.feed_out_mm_min" = 2000 }
formulation = ["margin", "delay", "design"]
order = 14
[[problem]]
name = "given"
task = "task.toml"
set = { "corner.A.delay_samples" = 14 }
formulation = "delay"
order = 14
[[problem]]
name = "short"
task = "task.toml"
formulation = "margin"
order = 4
expected = "infeasible"
)");
  }

  nlohmann::json write_all(const std::string& format) {
    const Outcome outcome = run("instances suite.toml --out " + format + " --format " + format);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    return nlohmann::json::parse(content(home_ / format / "manifest.json"));
  }
  /// The answer of another program; none if it is not installed.
  std::optional<std::string> read_back(const std::string& tool, const std::string& file) {
    const std::string answer =
        output_of("/usr/bin/python3 '" + test_support::source_folder() + "/tests/comparison/read_back.py' " + tool +
                  " '" + (home_ / file).string() + "' 2>&1");
    if (answer == "missing\n") return std::nullopt;
    return answer.substr(0, answer.size() - 1);
  }
  static nlohmann::json find(const nlohmann::json& manifest, const std::string& problem,
                             const std::string& formulation) {
    for (const nlohmann::json& entry : manifest["instances"]) {
      if (entry["problem"] == problem && entry["formulation"] == formulation) return entry;
    }
    ADD_FAILURE() << problem;
    return {};
  }
};

}  // namespace accdec::testing
