#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <accdec/design.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/simulate/simulate.hpp>
#include <accdec/task.hpp>

#include "support/paths.hpp"

namespace accdec {
namespace {

/// A program that passes every corner of a task as often as its weight says, in one run from rest to rest. Each leg
/// leaves a corner at that corner's feed and reaches the next one at the next corner's feed. Headings turn on from
/// corner to corner, which changes neither times nor errors. Both halves of a leg take a whole number of samples.
struct Realised {
  Toolpath path;
  std::vector<int> delays;
  double way = 0.0;  ///< s, way over feed
};

class Realiser {
 public:
  Realiser(double period, int samples) : period_(period), samples_(samples) {
    out_.path.axes = {0, 1};
    out_.path.points = {0.0, 0.0};
  }
  void leg(double feed, Joint joint, int delay) {
    const double length = feed * period_ * samples_;
    x_ += length * std::cos(heading_), y_ += length * std::sin(heading_);
    Toolpath& p = out_.path;
    p.points.insert(p.points.end(), {x_, y_});
    p.duration.push_back(period_ * samples_);
    p.tolerance.push_back(unlimited);
    p.joint.push_back(joint);
    p.line.push_back(static_cast<std::uint32_t>(p.line.size() + 1));
    p.rapid.push_back(0);
    p.inside_arc.push_back(0);
    out_.delays.push_back(delay);
    out_.way += p.duration.back();
  }
  void turn(double cos_interior) { heading_ += std::numbers::pi - std::acos(cos_interior); }
  Realised done() {
    out_.path.joint.back() = Joint::stop;
    return std::move(out_);
  }

 private:
  double period_;
  int samples_;
  double x_ = 0.0, y_ = 0.0, heading_ = 0.0;
  Realised out_;
};

Realised realise(const Task& task, const DesignResult& design) {
  // Longer than filter and delay: every corner is alone.
  Realiser program(task.sample_period, 3 * (design.filter->order() + 10));
  for (std::size_t j = 0; j < task.corners.size(); ++j) {
    const Corner& corner = task.corners[j].geometry();
    for (int i = 0; i < std::lround(task.corners[j].weight); ++i) {
      program.leg(corner.feed_in, Joint::corner, design.corners[j].delay);
      program.turn(corner.cos_interior());
      program.leg(corner.feed_out, Joint::straight, 0);
    }
  }
  return program.done();
}

/// Paths of every shipped task with several corners.
std::vector<std::string> tasks_of_several_corners() {
  std::vector<std::string> paths;
  for (const auto& file : std::filesystem::recursive_directory_iterator(test_support::source_folder() + "/problems")) {
    if (file.path().extension() != ".toml") continue;
    std::ifstream text(file.path());
    int corners = 0;
    for (std::string line; std::getline(text, line);) corners += line.starts_with("[[corner]]") ? 1 : 0;
    if (corners > 1) paths.push_back(file.path().string());
  }
  return paths;
}

TEST(CycleTime, IsThatOfAProgramThatPassesTheCorners) {
  const std::vector<std::string> paths = tasks_of_several_corners();
  EXPECT_GE(paths.size(), 9u);
  for (const std::string& path : paths) {
    SCOPED_TRACE(path);
    const Task task = read_task(path, {.response = Considered::all});
    if (!Response(task.machine, task.sample_period).ideal()) continue;  // programs know no servo
    DesignOptions options;
    options.time_limit = 10.0;  // what is proved by then does not matter here
    options.exact.certificate = false;
    const DesignResult design = design_task(task, options);
    ASSERT_TRUE(design.filter.has_value()) << design.message;
    const Realised program = realise(task, design);
    const CommandTiming timing(program.path, task.sample_period, program.delays);
    std::vector<double> errors(program.path.blocks(), 0.0);
    SimulationOptions whole;
    whole.whole_windows = true;
    const Simulation simulated = simulate_program(timing, *design.filter, 0, program.path.blocks() - 1, errors, whole);
    const double time = static_cast<double>(simulated.samples) * task.sample_period;
    EXPECT_NEAR(time - program.way, design.cycle_time, task.sample_period * (1.0 + 1e-9));
    // It is the motion of the design: each corner's error is that of the result.
    std::size_t block = 0;
    for (std::size_t j = 0; j < task.corners.size(); ++j) {
      for (int i = 0; i < std::lround(task.corners[j].weight); ++i, block += 2) {
        EXPECT_NEAR(errors[block], design.corners[j].corner_error, 1e-9) << "corner " << j;
      }
    }
  }
}

}  // namespace
}  // namespace accdec
