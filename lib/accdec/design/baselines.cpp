#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include <accdec/design/baseline_search.hpp>
#include <accdec/design/baselines.hpp>
#include <accdec/files/seconds_since.hpp>
#include <accdec/motion/smallest_delay.hpp>
#include <accdec/task/contradictions.hpp>
#include <accdec/task/verifier.hpp>

namespace accdec {
namespace {

constexpr std::array<Baseline, 17> families{{{"boxcar", "average", Shape::boxcar, 0},
                                             {"trapezoid", "two averages (trapezoid)", Shape::trapezoid, 0},
                                             {"averages", "three averages", Shape::averages, 0},
                                             {"s-curve", "S-curve", Shape::s_curve, 0},
                                             {"hann", "Hann", Shape::hann, 0},
                                             {"blackman", "Blackman", Shape::blackman, 0},
                                             {"blackman-sinc", "Blackman sinc", Shape::blackman_sinc, 0},
                                             {"gaussian", "Gaussian", Shape::gaussian, 0},
                                             {"exponential", "exponential", Shape::exponential, 0},
                                             {"boxcar-zv", "average, ZV", Shape::boxcar, 1},
                                             {"trapezoid-zv", "two averages, ZV", Shape::trapezoid, 1},
                                             {"averages-zv", "three averages, ZV", Shape::averages, 1},
                                             {"exponential-zv", "exponential, ZV", Shape::exponential, 1},
                                             {"boxcar-zvd", "average, ZVD", Shape::boxcar, 2},
                                             {"trapezoid-zvd", "two averages, ZVD", Shape::trapezoid, 2},
                                             {"averages-zvd", "three averages, ZVD", Shape::averages, 2},
                                             {"exponential-zvd", "exponential, ZVD", Shape::exponential, 2}}};

constexpr const Baseline& two_averages = families[1];

/// The cost, samples, from which on a family is hopeless.
double hopeless_cost(const Task& task, const Deadline& deadline) {
  BaselineSearch search(task, two_averages);
  search.run(deadline);
  return baseline_hopeless * search.cost();
}

constexpr const char* not_ended = "not searched to the end in the time given";

Deadline deadline_in(double seconds) {
  if (!(seconds < unlimited)) return {};
  const std::chrono::duration<double> time(seconds);
  return std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(time);
}

/// @param partly  take what was found by the deadline
BaselineResult best_below(const Task& task, const Baseline& baseline, double hopeless, const Deadline& deadline,
                          bool partly) {
  const auto began = std::chrono::steady_clock::now();
  BaselineResult answer;
  std::string message;
  long tried = 0;
  bool late = false;
  if (const auto impossible = contradictions(task); !impossible.empty()) {
    message = impossible.front();
  } else if (baseline.pairs > 0 && task.machine.modes.empty()) {
    message = "the task bounds no vibration for pairs of impulses to cancel";
  } else {
    BaselineSearch search(task, baseline, hopeless);
    search.run(deadline);
    tried = search.tried();
    late = !search.complete();
    if (!late || partly) answer.spec = search.best();
    if (answer.spec) {
      Task chosen = task;
      chosen.filter = answer.spec;
      const Filter filter = make_filter(*answer.spec);
      answer.result = assess(chosen, filter, search.delays(), false);
      if (late) answer.result.message = not_ended;
    } else if (late) {
      message = not_ended;
    } else {
      message = fmt::format("no {} of order {} to {} holds all limits", baseline.name, task.design.order_min,
                            task.design.order_max);
      if (hopeless < unlimited)
        message += fmt::format(" in less than {:g} times the time of two averages", baseline_hopeless);
    }
  }
  if (!answer.spec) {
    answer.result.task = task;
    answer.result.status = late ? Status::failed : Status::infeasible;
    answer.result.message = message;
  }
  answer.result.solver.method = "given";
  answer.result.solver.name = fmt::format("best {}", baseline.name);
  answer.result.solver.evaluations = tried;
  answer.result.solver.wall_time = seconds_since(began);
  return answer;
}

}  // namespace

bool stops_exactly(const DesignResult& result) {
  if (!result.filter || result.corners.empty()) return false;
  const int apart = DelayFinder(*result.filter).exact_stop_delay();
  return std::all_of(result.corners.begin(), result.corners.end(),
                     [=](const CornerResult& corner) { return corner.delay >= apart; });
}

std::span<const Baseline> baselines() {
  return families;
}

const Baseline* find_baseline(std::string_view name) {
  const auto found = std::find_if(families.begin(), families.end(), [=](const Baseline& b) { return b.name == name; });
  return found == families.end() ? nullptr : &*found;
}

BaselineResult best_baseline(const Task& task, const Baseline& baseline, double seconds) {
  const Deadline deadline = deadline_in(seconds);
  const bool alone = &baseline == &two_averages || !contradictions(task).empty();
  return best_below(task, baseline, alone ? unlimited : hopeless_cost(task, deadline), deadline, true);
}

std::vector<BaselineResult> best_baselines(const Task& task, double seconds) {
  const Deadline deadline = deadline_in(seconds);
  const double hopeless = contradictions(task).empty() ? hopeless_cost(task, deadline) : unlimited;
  std::vector<BaselineResult> all;
  for (const Baseline& baseline : families) all.push_back(best_below(task, baseline, hopeless, deadline, false));
  return all;
}

}  // namespace accdec
