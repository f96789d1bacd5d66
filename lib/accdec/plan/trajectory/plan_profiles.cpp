#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <accdec/plan/feeds/stretches.hpp>
#include <accdec/plan/trajectory/plan_profiles.hpp>
#include <accdec/plan/trajectory/profile_repair.hpp>
#include <accdec/simulate/profile_motion.hpp>

namespace accdec {
namespace {

/// Whether the whole of a long program is made again. That takes less time than its parts if they are many, and no part
/// has to end at a whole sample.
bool made_whole(std::size_t blocks, const std::vector<LegRange>& touched, int round) {
  constexpr std::size_t long_program = 50'000, beside = 20;  // legs that are made and sampled with a part
  constexpr int rounds_max = 10;
  if (blocks <= long_program || round >= rounds_max) return false;
  std::size_t work = 0;
  for (const LegRange& part : touched) work += part.last - part.first + 1 + beside;
  return work > blocks;
}

/// Not checked if the deadline came before its last sample.
ProfilePlan plan_with(const Toolpath& path, const Machine& machine, double sample_period, const Filter& last,
                      const Deadline& deadline) {
  const AvailableAcceleration available(machine, sample_period, LastFilter(last, sample_period));
  ProfileShares shares(path.blocks());
  ProfilePlan plan;
  plan.last = last;
  plan.errors.resize(path.blocks());
  ChainMaker maker(path, available);
  maker.make(shares);
  const LegRange all{0, path.blocks() - 1};
  std::vector<double> phases(path.blocks());
  constexpr int rounds_max = 60;
  constexpr std::int64_t samples_between_looks = 100'000;  // at the clock, 0.1 s
  int strictness = 0;                                      // see ProfileRepair
  for (plan.rounds = 0;; ++plan.rounds) {
    // Parts that hold alone but not in the whole are slowed more in every round.
    ProfileRepair repair(path, available, shares, all, strictness);
    SampleChecker checker(path, machine, sample_period, plan.errors,
                          [&](std::int64_t first, std::int64_t last_place, LimitKind kind, double ratio) {
                            repair.limit(first, last_place, kind, ratio);
                          });
    ProfileMotion motion(path, maker.chain(), sample_period, last);
    motion.note_phases(phases);
    std::int64_t looked = 0;
    while (const std::int64_t count = checker.look_on(motion)) {
      looked += count;
      if (looked < samples_between_looks) continue;
      looked = 0;
      if (deadline.over()) return {};
    }
    plan.check = checker.finish();
    plan.checked = true;
    if (plan.holds() || plan.rounds == rounds_max || deadline.over()) break;
    if (!plan.check.errors_hold) repair.errors(maker.chain(), plan.errors, all);
    std::vector<LegRange> touched = repair.touched();
    if (made_whole(path.blocks(), touched, plan.rounds)) {
      maker.make(shares);
    } else {
      repair_parts(path, machine, available, shares, maker, plan.errors, phases, std::move(touched), strictness,
                   deadline);
      strictness += 2;
    }
  }
  plan.chain = maker.take();
  return plan;
}

/// m/s, of the blocks at their feeds.
double fastest(const Toolpath& path) {
  double speed = 0.0;
  for (std::size_t b = 0; b < path.blocks(); ++b) speed = std::max(speed, path.length(b) / path.duration[b]);
  return speed;
}

/// Up to this number of blocks, last filters are compared by the whole program.
constexpr std::size_t predicted_whole_max = 40'000;

/// Continuous time of a first chain and the waits for the last filter at its stops, s.
double predicted_time(const Toolpath& path, const Machine& machine, double sample_period, const Filter& last) {
  const AvailableAcceleration available(machine, sample_period, LastFilter(last, sample_period));
  ChainMaker maker(path, available);
  const ProfileChain& chain = maker.make(ProfileShares(path.blocks()));
  double time = chain_time(chain);
  for (std::size_t c = 1; c <= path.blocks(); ++c) {
    time += chain.stops(c) ? (last.order() + 1) * sample_period : 0.0;
  }
  return time;
}

}  // namespace

ProfilePlan plan_profiles(const Toolpath& path, const Machine& machine, double sample_period,
                          const Deadline& deadline) {
  constexpr std::size_t most = 24;
  const std::vector<Filter> filters = last_filters(machine, sample_period, fastest(path), most, deadline);
  if (filters.empty() && deadline.over()) {
    throw std::invalid_argument(
        "the time limit ended the search of plan profiles for a filter that holds the vibration bounds ([[mode]]); "
        "give it longer, or use --plan fixed");
  }
  if (filters.empty()) {
    throw std::invalid_argument(
        "plan profiles finds no filter for the vibration bounds ([[mode]]) among averages and pairs of impulses up to "
        "two and a half periods of the slowest mode; use --plan fixed");
  }
  const std::vector<Toolpath> parts =
      filters.size() > 1 ? stretches(path, predicted_whole_max) : std::vector<Toolpath>{};
  std::vector<std::pair<double, std::size_t>> candidates;
  for (std::size_t i = 0; i < filters.size(); ++i) {
    double time = 0.0;
    for (const Toolpath& part : parts) time += predicted_time(part, machine, sample_period, filters[i]);
    candidates.emplace_back(time, i);
  }
  std::sort(candidates.begin(), candidates.end());
  ProfilePlan best;
  const std::size_t tried = path.blocks() > 100'000 ? 1 : 3;
  for (std::size_t i = 0; i < std::min(tried, candidates.size()); ++i) {
    ProfilePlan plan = plan_with(path, machine, sample_period, filters[candidates[i].second], deadline);
    const bool better = plan.holds() && (!best.holds() || plan.check.samples < best.check.samples);
    if (i == 0 || better || !best.checked) best = std::move(plan);
    if (deadline.over()) break;
  }
  return best;
}

}  // namespace accdec
