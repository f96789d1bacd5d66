// Small random tasks, designed by the library and judged by brute force. See ../README.md.

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <accdec/design.hpp>
#include <accdec/files.hpp>
#include <accdec/formats/task_writer.hpp>
#include <accdec/result.hpp>
#include <accdec/verify.hpp>

#include "draw.hpp"
#include "judge.hpp"
#include "physics.hpp"

namespace accdec::attack {
namespace {

struct Arguments {
  std::uint64_t seed = 1, first = 0, cases = 1'000'000'000'000;
  double minutes = 1e9;
  std::string keep = "build/attack", kind;
};

std::vector<int> delays_of(const DesignResult& result) {
  std::vector<int> delays;
  for (const CornerResult& corner : result.corners) delays.push_back(corner.delay);
  return delays;
}

class Attack {
 public:
  explicit Attack(Arguments arguments) : arguments_(std::move(arguments)) {}

  int run() {
    const auto end = began_ + std::chrono::duration<double>(60.0 * arguments_.minutes);
    auto told = began_;
    for (number_ = arguments_.first; number_ < arguments_.first + arguments_.cases && Clock::now() < end; ++number_) {
      kind_ = arguments_.kind.empty() ? kinds[number_ % kinds.size()] : arguments_.kind;
      const Task task = draw(kind_, arguments_.seed, number_);
      try {
        judge(task);
      } catch (const std::exception& error) {
        wrong(task, std::string("throws ") + error.what());
      }
      if (Clock::now() - told > std::chrono::minutes(1)) told = Clock::now(), tell();
    }
    tell();
    return counts_["wrong"] > 0 ? 1 : 0;
  }

 private:
  using Clock = std::chrono::steady_clock;

  void tell() {
    std::string line = fmt::format("{{\"seed\": {}, \"first\": {}, \"next\": {}, \"seconds\": {:.0f}", arguments_.seed,
                                   arguments_.first, number_, seconds_since(began_));
    for (const auto& [what, count] : counts_) line += fmt::format(", \"{}\": {}", what, count);
    fmt::print("{}}}\n", line);
    std::fflush(stdout);
  }

  void wrong(const Task& task, const std::string& reason) {
    ++counts_["wrong"];
    std::filesystem::create_directories(arguments_.keep);
    const std::string path = fmt::format("{}/small-{}-{}.toml", arguments_.keep, arguments_.seed, number_);
    std::ofstream(path) << task_to_toml(task);
    fmt::print("WRONG {} {}: {}; {}\n", kind_, number_, reason, path);
    std::fflush(stdout);
  }

  void judge(const Task& task) {
    ++counts_["tasks"];
    DesignOptions options;
    options.time_limit = 20.0;
    const DesignResult result = design_task(task, options);
    ++counts_[fmt::format("{} {}", kind_, to_string(result.status))];
    if (result.has_design()) judge_design(task, result);
    if (result.status == Status::infeasible) judge_infeasible(task);
    if (result.status == Status::failed) return;
    // As a file and back: what the command `verify` does.
    const ResultCheck check = verify_result(parse_result(result_to_json(result), "result"));
    ++counts_["results verified"];
    if (!check.accepted) wrong(task, "verify rejects: " + check.reasons.front());
  }

  void judge_design(const Task& task, const DesignResult& result) {
    const std::vector<int> delays = delays_of(result);
    const Filter& filter = *result.filter;
    const double use = worst_use(Physics(task, filter.order(), delays), {filter.taps().begin(), filter.taps().end()});
    if (use > 1.0 + 1e-7) wrong(task, fmt::format("breaks a limit: {:.9f}", use));
    if (result.status != Status::optimal) return;
    const double found = cost(task, filter.order(), delays);
    ++counts_["optima judged"];
    const Verdict shorter = task.filter ? shorter_delay(task, filter, delays) : shorter_exists(task, found);
    if (shorter == Verdict::undecided) ++counts_["undecided"];
    if (shorter == Verdict::yes) wrong(task, fmt::format("optimal of {} samples, but there is a shorter", found));
    // The judge must also find what there is, or it would refute everything.
    if (task.filter || number_ % 5 != 0) return;
    const Verdict again = exists(task, filter.order(), delays);
    if (again == Verdict::yes) ++counts_["optima found again"];
    if (again == Verdict::no) wrong(task, "the judge refutes a design that holds");
  }

  /// For a given filter: whether a smaller delay of one corner holds as well.
  Verdict shorter_delay(const Task& task, const Filter& filter, const std::vector<int>& delays) {
    const std::vector<double> taps(filter.taps().begin(), filter.taps().end());
    for (std::size_t j = 0; j < delays.size(); ++j) {
      if (task.corners[j].delay) continue;
      std::vector<int> less = delays;
      while (--less[j] >= 0) {
        const double use = worst_use(Physics(task, filter.order(), less), taps);
        if (use < 1.0 - 1e-9) return Verdict::yes;
        if (use < 1.0 + 1e-8) return Verdict::undecided;
      }
    }
    return Verdict::no;
  }

  void judge_infeasible(const Task& task) {
    ++counts_["infeasible judged"];
    Verdict found = Verdict::no;
    if (!task.filter) {
      found = shorter_exists(task, 1e300);
    } else {
      const Filter filter = make_filter(*task.filter);
      std::vector<int> delays;
      for (const TaskCorner& corner : task.corners) delays.push_back(corner.delay.value_or(filter.order() + 3));
      const double use = worst_use(Physics(task, filter.order(), delays), {filter.taps().begin(), filter.taps().end()});
      if (use < 1.0 - 1e-9) found = Verdict::yes;
    }
    if (found == Verdict::undecided) ++counts_["undecided"];
    if (found == Verdict::yes) wrong(task, "infeasible, but there is a design");
  }

  Arguments arguments_;
  Clock::time_point began_ = Clock::now();
  std::uint64_t number_ = 0;
  std::string_view kind_;
  std::map<std::string, long> counts_;
};

Arguments parse(const std::vector<std::string>& words) {
  Arguments arguments;
  if (words.size() % 2 == 0)
    throw std::invalid_argument(
        "options, each with a value: --seed --first --cases (numbers), --minutes, --keep (a folder), --kind (a name)");
  for (std::size_t i = 1; i + 1 < words.size(); i += 2) {
    const std::string &name = words[i], &value = words[i + 1];
    if (name == "--seed")
      arguments.seed = std::stoull(value);
    else if (name == "--first")
      arguments.first = std::stoull(value);
    else if (name == "--cases")
      arguments.cases = std::stoull(value);
    else if (name == "--minutes")
      arguments.minutes = std::stod(value);
    else if (name == "--keep")
      arguments.keep = value;
    else if (name == "--kind")
      arguments.kind = value;
    else
      throw std::invalid_argument("unknown option " + name);
  }
  return arguments;
}

}  // namespace
}  // namespace accdec::attack

int main(int argc, char** argv) {
  try {
    return accdec::attack::Attack(accdec::attack::parse({argv, argv + argc})).run();
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
