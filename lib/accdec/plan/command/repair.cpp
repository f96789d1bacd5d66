#include <algorithm>
#include <cmath>

#include <accdec/plan/command/program_plan.hpp>
#include <accdec/plan/command/repair.hpp>
#include <accdec/plan/feeds/control_delay.hpp>
#include <accdec/simulate/sample_check.hpp>

namespace accdec {
namespace {

constexpr double slower = 1.15;         // factor on the duration of a block that breaks a limit by itself
constexpr double slower_curve = 1.02;   // for blocks on a curve where a limit is broken
constexpr double slowed_most = 1000.0;  // times as long as at first; a bound that is still broken cannot be met
constexpr int slow_rounds = 20;         // number of rounds that repair smooth joints by their feeds

void unique_ascending(std::vector<std::size_t>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}
void unique_ascending(RepairWork& work) {
  unique_ascending(work.raise);
  // Keep the largest factor of every block.
  std::sort(work.slow.begin(), work.slow.end(), [](const RepairWork::Slow& a, const RepairWork::Slow& b) {
    return a.block != b.block ? a.block < b.block : a.factor > b.factor;
  });
  const auto same = [](const RepairWork::Slow& a, const RepairWork::Slow& b) { return a.block == b.block; };
  work.slow.erase(std::unique(work.slow.begin(), work.slow.end(), same), work.slow.end());
}

}  // namespace

Repair::Repair(Toolpath& path, const Filter& filter, double sample_period, const Machine* machine,
               std::vector<int>& delays, std::vector<double>& errors)
    : path_(path),
      first_duration_(path.duration),
      filter_(filter),
      behind_(filter, machine != nullptr ? *machine : Machine{}, sample_period),
      machine_(machine),
      timing_(path, sample_period, delays),
      delays_(delays),
      errors_(errors),
      scratch_(path.blocks(), 0.0),
      apart_(filter.order() + 2),
      settled_(behind_.longest_order() + 2) {
  if (machine != nullptr) limits_.emplace(filter, *machine, sample_period);
}

double Repair::start_factor(std::size_t block) const {
  const std::size_t n = path_.dimensions();
  const double* p = path_.point(block);
  std::vector<double> velocity(n);
  for (std::size_t a = 0; a < n; ++a) velocity[a] = (p[n + a] - p[a]) / path_.duration[block];
  return limits_->start_factor(velocity.data());
}

bool Repair::slow_around(std::size_t joint, double factor, RepairWork& work) const {
  const std::size_t before = work.slow.size();
  // A block longer than the filter would lose more time by a lower feed than by a delay in the joint.
  const auto slow = [&](std::size_t b) {
    if (path_.duration[b] < apart_ * timing_.sample_period()) work.slow.push_back({b, factor});
  };
  // Commands up to half a filter away act there. But slowing all of them helps one joint and costs its neighbours
  // more than they need. Neighbours that need it are slowed for their own reasons.
  const double reach = 0.06 * apart_ * timing_.sample_period();
  double time = 0.0;
  for (std::size_t b = joint + 1; b-- > 0 && time < reach;) {
    if (b < joint && ends_leg(path_, b)) break;
    slow(b);
    time += path_.duration[b];
  }
  time = 0.0;
  for (std::size_t b = joint + 1; b < path_.blocks() && time < reach; ++b) {
    slow(b);
    time += path_.duration[b];
    if (ends_leg(path_, b)) break;
  }
  return work.slow.size() > before;
}

void Repair::mend(std::size_t joint, double use, RepairWork& work) const {
  if (ends_leg(path_, joint) || rounds_ > slow_rounds || !(use < unlimited)) {
    work.raise.push_back(joint);
    return;
  }
  const double factor = std::clamp(std::pow(use, 0.25), 1.002, 1.5);
  if (!slow_around(joint, factor, work)) work.raise.push_back(joint);
}

void Repair::mend(const Simulation::OffPath& off, RepairWork& work) const {
  const std::size_t after = std::min<std::size_t>(off.point, path_.blocks() - 1);
  if (off.point > 0 && off.point < path_.blocks() && delays_[off.point - 1] < settled_)
    return mend(off.point - 1, off.use, work);
  const double factor = std::clamp(std::sqrt(off.use), 1.002, 1.5);
  for (std::size_t b = off.point > 0 ? off.point - 1 : 0; b <= after; ++b) {
    if (path_.duration[b] < slowed_most * first_duration_[b]) work.slow.push_back({b, factor});
  }
}

void Repair::blame(std::uint32_t block, RepairWork& work) const {
  // Looks back only as far as changes of the command still act.
  const bool on_curve =
      rounds_ <= slow_rounds && block > 0 && !ends_leg(path_, block - 1) && slow_around(block - 1, slower_curve, work);
  double back = 0.0;
  std::size_t b = block;
  for (; b > 0 && back <= apart_; --b) {
    if (delays_[b - 1] < apart_ && !(on_curve && !ends_leg(path_, b - 1))) {
      work.raise.push_back(b - 1);
      return;
    }
    back += delays_[b - 1] + path_.duration[b - 1] / timing_.sample_period();
  }
  if (on_curve) return;
  for (std::size_t slow = b; slow <= block; ++slow) {
    if (path_.duration[slow] < apart_ * timing_.sample_period())
      work.slow.push_back({slow, slower});
    else if (const double factor = start_factor(slow); factor < 1.0)
      work.slow.push_back({slow, 1.0 / factor});
  }
}

RepairWork Repair::failing(const Simulation& simulation) const {
  RepairWork work;
  for (std::size_t b = 0; b + 1 < path_.blocks(); ++b) {
    if (!holds(errors_[b], path_.tolerance[b])) mend(b, errors_[b] / path_.tolerance[b], work);
  }
  for (const Simulation::OffPath& off : simulation.off) mend(off, work);
  for (const std::uint32_t block : simulation.broken) blame(block, work);
  unique_ascending(work);
  return work;
}

Repair::Range Repair::around(std::size_t joint) const {
  // A new or removed delay, or a slowed block, moves the samples of the whole run on either side of the joint. Beyond
  // these, a joint's window reaches from N samples before it to rest + N + 1 after it, rest <= N + 2; blocks take at
  // least their duration.
  if (path_.blocks() == 1) return {0, 0, 0, 0};
  const double n = settled_, period = timing_.sample_period();
  Range range{timing_.run_begin(joint), timing_.run_end(joint + 1), 0, 0};
  range.eval_first = range.first;
  range.eval_last = std::min(range.last, path_.blocks() - 2);
  double back = 0.0;  // from the end of the rest in a joint to the first run
  while (range.first > 0 && back < 5.0 * n) {
    --range.first;
    if (back < 2.0 * n) range.eval_first = range.first;
    back += delays_[range.first] + path_.duration[range.first] / period;
  }
  range.first = timing_.run_begin(range.first);
  double ahead = 0.0;
  const std::size_t end = path_.blocks() - 1;
  while (range.last < end && ahead < 5.0 * n) {
    ++range.last;
    ahead += path_.duration[range.last] / period;
    if (ahead < 2.0 * n) range.eval_last = std::min(range.last, end - 1);
  }
  range.last = timing_.run_end(range.last);
  return range;
}

void Repair::simulate(const Range& range) {
  SimulationOptions options;
  options.machine = machine_;
  options.blame = machine_ != nullptr;
  options.motion = behind_.servo();
  found_ = simulate_program(timing_, filter_, range.first, range.last, scratch_, options);
}

void Repair::judge(std::size_t first, std::size_t last, RepairWork& failing) const {
  for (std::size_t b = first; b <= last; ++b) {
    if (!holds(scratch_[b], path_.tolerance[b])) mend(b, scratch_[b] / path_.tolerance[b], failing);
  }
  for (const Simulation::OffPath& off : found_.off) {
    if (off.point >= first && off.point <= last + 1) mend(off, failing);
  }
  // Blocks whose motion the ends of the range cannot affect.
  for (const std::uint32_t block : found_.broken) {
    if (block >= first && block <= last + 1) blame(block, failing);
  }
}

void Repair::accept(std::size_t first, std::size_t last) {
  std::copy(scratch_.begin() + static_cast<std::ptrdiff_t>(first),
            scratch_.begin() + static_cast<std::ptrdiff_t>(last) + 1,
            errors_.begin() + static_cast<std::ptrdiff_t>(first));
}

int Repair::raised(std::size_t joint, int step) const {
  const int least = std::min(settled_, delays_[joint] + step);
  if (path_.control.any()) return least;
  const double way = path_.length(joint) / path_.duration[joint] * timing_.sample_period();
  return std::max(delays_[joint], control_delay(path_.control, filter_, way, least).value_or(least));
}

RepairWork Repair::round(const RepairWork& work, int step) {
  ++rounds_;
  std::vector<std::size_t> joints = work.raise;
  for (const std::size_t b : work.raise) delays_[b] = raised(b, step);
  for (const auto& [block, factor] : work.slow) {
    path_.duration[block] *= factor;
    joints.push_back(std::min(block, std::max<std::size_t>(path_.blocks(), 2) - 2));
  }
  unique_ascending(joints);
  RepairWork failing;
  for (std::size_t i = 0; i < joints.size();) {
    Range range = around(joints[i]);
    // A single block may need a lower feed: there is no joint after it.
    const auto end_of_runs = [&](std::size_t joint) {
      return joint + 1 < path_.blocks() ? timing_.run_end(joint + 1) : joint;
    };
    std::size_t seen = end_of_runs(joints[i]);  // joints before this have both runs inside the range
    std::vector<std::pair<std::size_t, std::size_t>> spans{{range.eval_first, range.eval_last}};
    for (++i; i < joints.size(); ++i) {
      if (joints[i] < seen) continue;
      const Range next = around(joints[i]);
      if (next.first > range.last) break;
      seen = end_of_runs(joints[i]);
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
      accept(first, last);
      judge(first, last, failing);
    }
  }
  unique_ascending(failing);
  return failing;
}

void Repair::lower(std::size_t joint, int least) {
  int good = delays_[joint], bad = least - 1;
  // Growing steps down while it holds, then bisection, because raised delays are usually right or slightly too long.
  RepairWork failing;
  const bool all = path_.control.any();  // else none between those that the control has
  for (int step = 1; good - bad > 1;) {
    const int next = all ? std::max(bad + 1, good - step) : least;
    delays_[joint] = next;
    const Range range = around(joint);
    simulate(range);
    failing = {};
    judge(range.eval_first, range.eval_last, failing);
    if (failing.empty()) {
      good = next;
      step *= 2;
      accept(range.eval_first, range.eval_last);
    } else {
      bad = all ? next : good;
      step = std::max(1, (good - bad) / 2);
    }
  }
  delays_[joint] = good;
}

}  // namespace accdec
