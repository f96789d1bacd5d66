#include <accdec/program/plan.hpp>

#include <algorithm>

#include <accdec/design/verifier.hpp>

namespace accdec {
namespace {

/// Re-simulates the surroundings of joints whose delay has changed.
class Repair {
 public:
  Repair(const Toolpath& path, const Filter& filter, double sample_period, std::vector<int>& delays, std::vector<double>& errors)
      : path_(path),
        filter_(filter),
        timing_(path, sample_period, delays),
        delays_(delays),
        errors_(errors),
        scratch_(path.blocks(), 0.0),
        stop_delay_(std::max(0, filter.last_nonzero_tap() - filter.first_nonzero_tap())) {}

  std::vector<std::size_t> failing() const {
    std::vector<std::size_t> joints;
    for (std::size_t b = 0; b + 1 < path_.blocks(); ++b) {
      if (!holds(errors_[b], path_.tolerance[b])) joints.push_back(b);
    }
    return joints;
  }

  /// One round: raises what fails, re-simulates, and returns what fails now there. @param step  samples
  std::vector<std::size_t> round(const std::vector<std::size_t>& joints, int step);
  /// Lowers the delay of a joint as far as everything around it holds.
  void lower(std::size_t joint, int least);

 private:
  struct Range {
    std::size_t first, last;            // blocks to simulate, whole runs
    std::size_t eval_first, eval_last;  // joints that a change may touch, seen with enough motion on both sides
  };
  Range around(std::size_t joint) const;
  void simulate(const Range& range) {
    simulate_program(timing_, filter_, range.first, range.last, scratch_);
  }
  bool range_holds(const Range& range) const {
    for (std::size_t b = range.eval_first; b <= range.eval_last; ++b) {
      if (!holds(scratch_[b], path_.tolerance[b])) return false;
    }
    return true;
  }
  void accept(const Range& range) {
    std::copy(scratch_.begin() + static_cast<std::ptrdiff_t>(range.eval_first),
              scratch_.begin() + static_cast<std::ptrdiff_t>(range.eval_last) + 1,
              errors_.begin() + static_cast<std::ptrdiff_t>(range.eval_first));
  }

  const Toolpath& path_;
  const Filter& filter_;
  CommandTiming timing_;
  std::vector<int>& delays_;
  std::vector<double>& errors_;
  std::vector<double> scratch_;
  int stop_delay_;
};

Repair::Range Repair::around(std::size_t joint) const {
  // A joint's window reaches from N samples before it to rest + N + 1 after it, rest <= N + 1; blocks take at least their duration.
  const double n = filter_.order() + 2.0, period = timing_.sample_period();
  Range range{joint, joint + 1, joint, joint};
  double back = 0.0;
  while (range.first > 0 && back < 4.0 * n) {
    back += path_.duration[range.first] / period + delays_[range.first - 1];
    --range.first;
    if (back < 3.0 * n) range.eval_first = range.first;
  }
  if (range.first == 0) range.eval_first = 0;
  range.first = timing_.run_begin(range.first);
  double ahead = 0.0;
  const std::size_t end = path_.blocks() - 1;
  while (range.last < end && ahead < 5.0 * n) {
    ahead += path_.duration[range.last] / period;
    if (ahead < 2.0 * n) range.eval_last = range.last;
    ++range.last;
  }
  range.last = timing_.run_end(range.last);
  if (range.last == end) range.eval_last = std::max(range.eval_last, std::min(range.last, end) - 1);
  return range;
}

std::vector<std::size_t> Repair::round(const std::vector<std::size_t>& joints, int step) {
  for (const std::size_t b : joints) delays_[b] = std::min(stop_delay_, delays_[b] + step);
  std::vector<std::size_t> failing;
  for (std::size_t i = 0; i < joints.size();) {
    Range range = around(joints[i]);
    std::vector<std::pair<std::size_t, std::size_t>> spans{{range.eval_first, range.eval_last}};
    for (++i; i < joints.size(); ++i) {
      const Range next = around(joints[i]);
      if (next.first > range.last) break;
      range.first = std::min(range.first, next.first);
      range.last = std::max(range.last, next.last);
      if (next.eval_first <= spans.back().second + 1) {
        spans.back().second = std::max(spans.back().second, next.eval_last);
      } else {
        spans.emplace_back(next.eval_first, next.eval_last);
      }
    }
    simulate(range);
    for (const auto& [first, last] : spans) {
      accept({0, 0, first, last});
      for (std::size_t b = first; b <= last; ++b) {
        if (!holds(errors_[b], path_.tolerance[b])) failing.push_back(b);
      }
    }
  }
  // Spans of neighbouring ranges may share joints.
  std::sort(failing.begin(), failing.end());
  failing.erase(std::unique(failing.begin(), failing.end()), failing.end());
  return failing;
}

void Repair::lower(std::size_t joint, int least) {
  int good = delays_[joint], bad = least - 1;
  // Growing steps down while it holds, then bisection; raised delays are mostly right or one too long.
  for (int step = 1; good - bad > 1;) {
    const int next = std::max(bad + 1, good - step);
    delays_[joint] = next;
    const Range range = around(joint);
    simulate(range);
    if (range_holds(range)) {
      good = next;
      step *= 2;
      accept(range);
    } else {
      bad = next;
      step = std::max(1, (good - bad) / 2);
    }
  }
  delays_[joint] = good;
}

}  // namespace

bool holds(double error, double bound) { return error <= bound * (1.0 + verification_tolerance) + position_floor; }

ProgramPlan check_program(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine,
                          std::vector<int> delays) {
  ProgramPlan plan;
  plan.delays = std::move(delays);
  plan.errors.assign(path.blocks(), 0.0);
  const CommandTiming timing(path, sample_period, plan.delays);
  SimulationOptions options;
  if (!machine.axes.empty()) options.machine = &machine;
  plan.simulation = simulate_program(timing, filter, 0, path.blocks() - 1, plan.errors, options);
  plan.errors_hold = true;
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
    plan.errors_hold = plan.errors_hold && holds(plan.errors[b], path.tolerance[b]);
  }
  return plan;
}

ProgramPlan plan_program(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine) {
  const std::vector<int> pairwise = pairwise_delays(path, filter, sample_period);
  ProgramPlan plan = check_program(path, filter, sample_period, machine, pairwise);
  if (plan.errors_hold) return plan;

  Repair repair(path, filter, sample_period, plan.delays, plan.errors);
  std::vector<std::size_t> failing = repair.failing();
  int rounds = 0;
  while (!failing.empty()) {
    ++rounds;
    failing = repair.round(failing, 1 + rounds / 8);
  }
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    if (plan.delays[b] > pairwise[b]) repair.lower(b, pairwise[b]);
  }
  plan = check_program(path, filter, sample_period, machine, std::move(plan.delays));
  plan.rounds = rounds;
  for (std::size_t b = 0; b < path.blocks(); ++b) plan.raised += plan.delays[b] > pairwise[b] ? 1 : 0;
  return plan;
}

}  // namespace accdec
