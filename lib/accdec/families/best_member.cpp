#include <algorithm>
#include <chrono>
#include <functional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include <accdec/corner.hpp>
#include <accdec/families/family_search.hpp>
#include <accdec/family.hpp>
#include <accdec/files.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/task/contradictions.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

const Family& two_averages() {
  static const Family& family = *find_family("trapezoid");
  return family;
}

using Stop = std::function<bool()>;

/// The cost, samples, from which on a family is hopeless.
double hopeless_cost(const Task& task, const Stop& stop) {
  FamilySearch search(task, two_averages());
  search.run(stop);
  return hopeless_factor * search.cost();
}

constexpr const char* not_ended = "not searched to the end in the time given";

Stop stop_in(double seconds, const std::atomic<bool>* cancel) {
  const auto began = std::chrono::steady_clock::now();
  return [=] { return seconds_since(began) >= seconds || (cancel != nullptr && cancel->load()); };
}

FamilyResult no_filter(const Task& task, Status status, std::string message) {
  FamilyResult answer;
  answer.result.task = task;
  answer.result.status = status;
  answer.result.message = std::move(message);
  return answer;
}

/// @param partly  take what was found where the search was stopped
FamilyResult best_below(const Task& task, const Family& baseline, double hopeless, const Stop& stop, bool partly) {
  if (baseline.pairs > 0 && task.machine.modes.empty())
    return no_filter(task, Status::infeasible, "the task bounds no vibration for pairs of impulses to cancel");
  const auto began = std::chrono::steady_clock::now();
  FamilySearch search(task, baseline, hopeless);
  search.run(stop);
  FamilyResult answer;
  if (search.best() && (search.complete() || partly)) {
    answer.spec = search.best();
    Task chosen = task;
    chosen.filter = answer.spec;
    answer.result = assess(chosen, make_filter(*answer.spec), search.delays().delays, false);
    if (!search.complete()) answer.result.message = not_ended;
  } else if (!search.complete()) {
    answer = no_filter(task, Status::failed, not_ended);
  } else {
    std::string message = fmt::format("no {} of order {} to {} holds all limits", baseline.name, task.design.order_min,
                                      task.design.order_max);
    if (hopeless < unlimited)
      message += fmt::format(" in less than {:g} times the time of two averages", hopeless_factor);
    answer = no_filter(task, Status::infeasible, std::move(message));
  }
  answer.result.solver.evaluations = search.tried();
  answer.result.solver.wall_time = seconds_since(began);
  return answer;
}

/// How much work a family is: those of few members are searched first, for the time may end.
int work_of(const Family& family) {
  if (family.averages == 3) return 3;
  return (family.parameter ? 2 : 0) + (family.pairs > 0 ? 1 : 0);
}

/// Those families, each in its place, one after another.
std::vector<FamilyResult> best_of(const Task& task, std::span<const Family> wanted, const Stop& stop, bool partly) {
  const std::vector<std::string> conflicts = contradictions(task);
  const bool alone = wanted.data() == &two_averages() && wanted.size() == 1;
  const double hopeless = conflicts.empty() && !alone ? hopeless_cost(task, stop) : unlimited;
  std::vector<const Family*> order;
  for (const Family& family : wanted) order.push_back(&family);
  std::stable_sort(order.begin(), order.end(), [](const auto* a, const auto* b) { return work_of(*a) < work_of(*b); });
  std::vector<FamilyResult> all(wanted.size());
  for (const Family* family : order) {
    FamilyResult& result = all[static_cast<std::size_t>(family - wanted.data())];
    result = conflicts.empty() ? best_below(task, *family, hopeless, stop, partly)
                               : no_filter(task, Status::infeasible, conflicts.front());
    result.result.solver.method = "given";
    result.result.solver.name = fmt::format("best {}", family->name);
  }
  return all;
}

}  // namespace

bool stops_exactly(const DesignResult& result) {
  if (!result.filter || result.corners.empty()) return false;
  const FilterBehind behind(*result.filter, result.task.machine, result.task.sample_period);
  const int apart = DelayFinder(behind.motion()).exact_stop_delay();
  return std::all_of(result.corners.begin(), result.corners.end(),
                     [=](const CornerResult& corner) { return corner.delay >= apart; });
}

FamilyResult best_member(const Task& task, const Family& baseline, double seconds) {
  return best_of(task, {&baseline, 1}, stop_in(seconds, nullptr), true).front();
}

std::vector<FamilyResult> best_members(const Task& task, double seconds, const std::atomic<bool>* cancel) {
  return best_of(task, families(), stop_in(seconds, cancel), false);
}

}  // namespace accdec
