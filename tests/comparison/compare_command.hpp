#pragma once

#include <string>

#include <fmt/format.h>

#include "support/command_fixture.hpp"

namespace accdec::testing {

/// `accdec compare` in a folder with a small suite.
class CompareCommand : public CommandInFolder {
 protected:
  void SetUp() override {
    CommandInFolder::SetUp();
    write(home_ / "task.toml", R"(sample_period_ms = 1.0
[[axis]]
acceleration_max_mm_s2 = 6000
jerk_max_mm_s3 = 500000
[[corner]]
name = "A"
angle_deg = 95
feed_in_mm_min = 6000
error_max_um = 50
)");
    suite();
  }
  void suite(const std::string& solvers = R"(["ipopt", "nlopt-slsqp", "nlopt-cobyla", "clp"])",
             const std::string& more = "", int repeats = 5) {
    write(home_ / "suite.toml", fmt::format(R"(title = "Mini"
solvers = {}
starts = 2
repeats = {}
time_limit_s = 60
evaluation_limit = 200
{}
[[problem]]
name = "small"
task = "task.toml"
formulation = ["margin", "delay"]
order = 30
delay_samples = 12
[[problem]]
name = "short"
task = "task.toml"
formulation = ["margin", "design"]
order = 10
expected = "infeasible"
)",
                                            solvers, repeats, more));
  }
};

}  // namespace accdec::testing
