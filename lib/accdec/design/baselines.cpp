#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <string>
#include <utility>

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

using Stop = std::function<bool()>;

/// The cost, samples, from which on a family is hopeless.
double hopeless_cost(const Task& task, const Stop& stop) {
  BaselineSearch search(task, two_averages);
  search.run(stop);
  return baseline_hopeless * search.cost();
}

constexpr const char* not_ended = "not searched to the end in the time given";

Stop stop_in(double seconds, const std::atomic<bool>* cancel) {
  const auto began = std::chrono::steady_clock::now();
  return [=] { return seconds_since(began) >= seconds || (cancel != nullptr && cancel->load()); };
}

BaselineResult no_filter(const Task& task, Status status, std::string message) {
  BaselineResult answer;
  answer.result.task = task;
  answer.result.status = status;
  answer.result.message = std::move(message);
  return answer;
}

/// @param partly  take what was found where the search was stopped
BaselineResult best_below(const Task& task, const Baseline& baseline, double hopeless, const Stop& stop, bool partly) {
  if (baseline.pairs > 0 && task.machine.modes.empty())
    return no_filter(task, Status::infeasible, "the task bounds no vibration for pairs of impulses to cancel");
  const auto began = std::chrono::steady_clock::now();
  BaselineSearch search(task, baseline, hopeless);
  search.run(stop);
  BaselineResult answer;
  if (search.best() && (search.complete() || partly)) {
    answer.spec = search.best();
    Task chosen = task;
    chosen.filter = answer.spec;
    answer.result = assess(chosen, make_filter(*answer.spec), search.delays(), false);
    if (!search.complete()) answer.result.message = not_ended;
  } else if (!search.complete()) {
    answer = no_filter(task, Status::failed, not_ended);
  } else {
    std::string message = fmt::format("no {} of order {} to {} holds all limits", baseline.name, task.design.order_min,
                                      task.design.order_max);
    if (hopeless < unlimited)
      message += fmt::format(" in less than {:g} times the time of two averages", baseline_hopeless);
    answer = no_filter(task, Status::infeasible, std::move(message));
  }
  answer.result.solver.evaluations = search.tried();
  answer.result.solver.wall_time = seconds_since(began);
  return answer;
}

/// Those families, one after another.
std::vector<BaselineResult> best_of(const Task& task, std::span<const Baseline> wanted, const Stop& stop, bool partly) {
  const std::vector<std::string> conflicts = contradictions(task);
  const bool alone = wanted.data() == &two_averages && wanted.size() == 1;
  const double hopeless = conflicts.empty() && !alone ? hopeless_cost(task, stop) : unlimited;
  std::vector<BaselineResult> all;
  for (const Baseline& baseline : wanted) {
    all.push_back(conflicts.empty() ? best_below(task, baseline, hopeless, stop, partly)
                                    : no_filter(task, Status::infeasible, conflicts.front()));
    all.back().result.solver.method = "given";
    all.back().result.solver.name = fmt::format("best {}", baseline.name);
  }
  return all;
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
  return best_of(task, {&baseline, 1}, stop_in(seconds, nullptr), true).front();
}

std::vector<BaselineResult> best_baselines(const Task& task, double seconds, const std::atomic<bool>* cancel) {
  return best_of(task, families, stop_in(seconds, cancel), false);
}

}  // namespace accdec
