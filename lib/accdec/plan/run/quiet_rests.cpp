#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include <accdec/machine/limits.hpp>
#include <accdec/machine/velocity_changes.hpp>
#include <accdec/plan/run/quiet_rests.hpp>
#include <accdec/simulate/command_stream.hpp>
#include <accdec/task/delay_kinds.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

constexpr double checks_blocks_max = 2e7;  // blocks simulated while a quiet plan is sought
constexpr double checks_max = 400.0;
constexpr double longest = 1.25;            // of the time of the plan at first
constexpr double ripples_max = 2e5;         // changes times ripples of a band of modes: some hundredths of a second
constexpr std::size_t candidates_max = 12;  // simulated for one change of a plan
constexpr std::size_t places_max = 256;     // of a change
constexpr double room = 0.98;               // predictions leave out that joints fall between samples
constexpr double helps = 0.9;               // of what was left before: a change that is worth its samples
constexpr double slower = 1.1;

/// When blocks begin and end, and all changes of the velocity, with those that a stop or the end follows.
class Schedule {
 public:
  Schedule(const ScheduledPlan& plan, const Filter& filter, double period)
      : path_(plan.path),
        period_(period),
        standing_(exact_stop_delay(filter)),
        begin(path_.blocks(), 0.0),
        end(path_.blocks(), 0.0),
        changes(path_.dimensions()),
        blocks(path_.dimensions()) {
    emit_commands<0>(CommandTiming(path_, period, plan.plan.delays), 0, path_.blocks() - 1, *this);
    end.back() = static_cast<double>(sample_);
    change(sample_ + 1, {});
  }
  void command(const AxisRow<0>& u0, const AxisRow<0>& u, std::int64_t count, const AxisRow<0>& /*end*/) {
    change(sample_ + 1, u0);
    if (stops_) rest();
    if (count > 1) change(sample_ + 2, u);
    sample_ += count;
  }
  void joint(std::size_t b, double time, std::int64_t rest) {
    end[b] = time, begin[b + 1] = time + static_cast<double>(rest);
    stops_ = rest >= std::max(1, standing_);
    if (!stops_) block_ = b + 1;
  }

 private:
  void change(std::int64_t sample, const AxisRow<0>& u) {
    for (std::size_t a = 0; a < changes.size(); ++a) {
      if (!(std::abs(u[a] - now_[a]) > position_floor)) continue;
      changes[a].push_back({sample, (u[a] - now_[a]) / period_, false});
      blocks[a].push_back(block_);
    }
    now_ = u;
  }
  void rest() {
    for (auto& of_axis : changes)
      if (!of_axis.empty()) of_axis.back().judged = true;
    stops_ = false, ++block_;
  }

  const Toolpath& path_;
  double period_;
  int standing_;  // samples of a delay in which the motion comes to rest
  std::int64_t sample_ = 0;
  std::size_t block_ = 0;
  bool stops_ = false;
  AxisRow<0> now_{};

 public:
  std::vector<double> begin, end;                    // samples
  std::vector<std::vector<VelocityChange>> changes;  // of every axis
  std::vector<std::vector<std::size_t>> blocks;      // of every axis: of its changes
};

/// The first rest after which a mode is left with too much.
struct Ringing {
  std::size_t block = 0;  // that the rest follows
  int axis = 0;
  double frequency = 0.0, damping = 0.0, use = 0.0;
};

/// A change of a plan: `samples` more behind a block, or for it.
struct Longer {
  std::size_t block = 0;
  int samples = 0;
  bool delay = false;
  double left = 0.0;  // of the bound, predicted
};

class Quietening {
 public:
  Quietening(ScheduledPlan& plan, const Filter& filter, double period, const Machine& machine,
             const std::function<void(ScheduledPlan&)>& check, const Deadline& deadline)
      : plan_(plan), filter_(filter), period_(period), machine_(machine), check_(check), deadline_(deadline) {}

  /// For all frequencies and damping ratios of each mode, or else for those at which its bound is used most.
  bool run() { return run(true) || run(false); }

 private:
  bool run(bool bands) {
    bands_ = bands, checks_ = 0.0, lengthened_ = 0;
    std::optional<Ringing> ringing = first_ringing(plan_);
    if (!ringing) return true;
    const ScheduledPlan first = plan_;
    const double most = std::min(checks_max, checks_blocks_max / static_cast<double>(plan_.path.blocks()));
    while (ringing && checks_ < most && !deadline_.over() && !too_long(plan_, first)) {
      if (!turn(*ringing) && !slow(*ringing)) break;
      ringing = first_ringing(plan_);
    }
    if (ringing || too_long(plan_, first)) {
      plan_ = first;
      return false;
    }
    plan_.plan.slowed = first.plan.slowed + lengthened_;
    plan_.plan.too_fast = first.plan.too_fast;
    plan_.plan.rounds = first.plan.rounds;
    if (lengthened_ == 0) plan_.plan.alone = first.plan.alone;
    return true;
  }
  static bool too_long(const ScheduledPlan& plan, const ScheduledPlan& first) {
    return static_cast<double>(plan.plan.simulation.samples) >
           longest * static_cast<double>(first.plan.simulation.samples);
  }

  std::optional<Ringing> first_ringing(const ScheduledPlan& plan) const {
    std::optional<Ringing> first;
    const Schedule schedule(plan, filter_, period_);
    auto most_used = plan.plan.simulation.limits.begin();
    for (Mode mode : machine_.modes) {
      if (!mode.of_axis()) continue;
      while (most_used->kind != LimitKind::residual) ++most_used;  // one for each mode of an axis, in their order
      const auto axis = static_cast<std::size_t>(mode.axis);
      const std::vector<VelocityChange>& changes = schedule.changes[axis];
      if (!changes.empty() && !(bands_ && in_time(mode, changes))) {
        mode.frequency_low = mode.frequency_high = most_used->frequency;
        mode.damping_low = mode.damping_high = most_used->damping;
      }
      ++most_used;
      if (changes.empty()) continue;
      const LimitUse use = residual_utilisation(filter_, changes, period_, mode);
      if (use.utilisation <= 1.0 + verification_tolerance) continue;
      const auto left = residuals_behind(filter_, changes, use.frequency, period_, use.damping);
      for (std::size_t i = 0; i < left.size(); ++i) {
        if ((!changes[i].judged && i + 1 < left.size()) || left[i] <= use.bound * (1.0 + verification_tolerance))
          continue;
        const std::size_t block = i + 1 < left.size() ? schedule.blocks[axis][i] : plan.path.blocks() - 1;
        if (!first || block < first->block) first = {block, mode.axis, use.frequency, use.damping, left[i] / use.bound};
        break;
      }
    }
    return first;
  }
  /// Else a band of modes without damping would take minutes behind a long program.
  bool in_time(const Mode& mode, const std::vector<VelocityChange>& changes) const {
    const double duration = static_cast<double>(changes.back().sample - changes.front().sample) * period_;
    const double ripples = memory_of(mode, mode.damping_low, duration) * (mode.frequency_high - mode.frequency_low);
    return ripples * static_cast<double>(changes.size()) <= ripples_max;
  }

  ScheduledPlan copy() const {
    ScheduledPlan candidate{plan_.path, {}};
    candidate.plan.delays = plan_.plan.delays;
    return candidate;
  }
  /// Takes a change if the plan still holds and earlier rests stay quiet.
  /// @param most  that may be left at the rest behind the block, of the bound
  bool take(const Longer& longer, std::size_t block, double most) {
    ScheduledPlan candidate = copy();
    if (longer.delay)
      candidate.plan.delays[longer.block] += longer.samples;
    else
      candidate.path.duration[longer.block] += longer.samples * period_;
    ++checks_;
    check_(candidate);
    if (!all_holds(candidate.plan)) return false;
    const std::optional<Ringing> left = first_ringing(candidate);
    if (left && (left->block < block || (left->block == block && left->use > most))) return false;
    plan_ = std::move(candidate);
    lengthened_ += longer.delay ? 0 : 1;
    return true;
  }

  /// In the order of the time that they take, the best of each kind.
  std::vector<Longer> predicted(const Ringing& ringing) const;

  bool turn(const Ringing& ringing) {
    std::vector<Longer> all = predicted(ringing);
    std::size_t tried = 0;
    for (const Longer& longer : all) {
      if (longer.left > room || tried == candidates_max || deadline_.over()) continue;
      ++tried;
      if (take(longer, ringing.block, 1.0)) return true;
    }
    // No single change is enough: the one that helps most, and then another.
    std::ranges::sort(all, {}, &Longer::left);
    for (std::size_t i = 0; i < std::min(all.size(), candidates_max) && !deadline_.over(); ++i) {
      if (all[i].left > helps * ringing.use) break;
      if (take(all[i], ringing.block, helps * ringing.use)) return true;
    }
    return false;
  }

  /// Slows all blocks between the rest and the one before it.
  bool slow(const Ringing& ringing) {
    ScheduledPlan candidate = copy();
    for (std::size_t b = first_block(ringing.block); b <= ringing.block; ++b) candidate.path.duration[b] *= slower;
    ++checks_;
    check_(candidate);
    if (!all_holds(candidate.plan)) return false;
    lengthened_ += ringing.block + 1 - first_block(ringing.block);
    plan_ = std::move(candidate);
    return true;
  }

  std::size_t first_block(std::size_t block) const {
    while (block > 0 && plan_.plan.delays[block - 1] < std::max(1, exact_stop_delay(filter_))) --block;
    return block;
  }

  ScheduledPlan& plan_;
  const Filter& filter_;
  double period_;
  const Machine& machine_;
  const std::function<void(ScheduledPlan&)>& check_;
  const Deadline& deadline_;
  bool bands_ = true;
  double checks_ = 0.0;
  std::size_t lengthened_ = 0;  // blocks
};

/// Every block adds v (w(begin) - w(end)) to what is left, w(t) = exp(lambda (K - t)) at the rest's time K.
std::vector<Longer> Quietening::predicted(const Ringing& ringing) const {
  using Phasor = std::complex<double>;
  const Schedule schedule(plan_, filter_, period_);
  const Toolpath& path = plan_.path;
  const double natural = 2.0 * std::numbers::pi * ringing.frequency, z = ringing.damping;
  const Phasor lambda = period_ * Phasor(-z * natural, natural * std::sqrt((1.0 - z) * (1.0 + z)));
  const std::size_t n = path.dimensions(), axis = static_cast<std::size_t>(ringing.axis), count = ringing.block + 1;
  const auto w = [&](double t) { return std::exp(lambda * (schedule.end[ringing.block] - t)); };
  std::vector<Phasor> before(count + 1, 0.0);  // left by the blocks before each
  std::vector<double> way(count), length(count);
  for (std::size_t b = 0; b < count; ++b) {
    way[b] = path.point(b)[n + axis] - path.point(b)[axis];
    length[b] = schedule.end[b] - schedule.begin[b];
    before[b + 1] = before[b] + way[b] / length[b] * (w(schedule.begin[b]) - w(schedule.end[b]));
  }
  const std::size_t from = first_block(ringing.block), stride = (count - from) / places_max + 1;
  const int most = static_cast<int>(std::ceil(1.0 / (ringing.frequency * period_)));
  const double scale = ringing.use / std::abs(before.back());
  const auto smooth = [&](std::size_t b) { return b + 1 < path.blocks() && path.joint[b] == Joint::smooth; };
  std::vector<Longer> all;
  for (int s = 1; s <= most; ++s) {
    const Phasor turned = std::exp(lambda * static_cast<double>(s));
    Longer delay{0, s, true, unlimited}, block{0, s, false, unlimited};
    for (std::size_t b = from; b < count; b += stride) {
      const Phasor after = before.back() - before[b + 1];
      const double as_delay = scale * std::abs(before[b + 1] * turned + after);
      const bool delays = b + 1 < count && ends_leg(path, b) && path.control.any();
      if (delays && as_delay < delay.left) delay.block = b, delay.left = as_delay;
      if (smooth(b) || (b > 0 && smooth(b - 1))) continue;
      const Phasor own = way[b] / (length[b] + s) * (w(schedule.begin[b]) * turned - w(schedule.end[b]));
      const double as_block = scale * std::abs(before[b] * turned + own + after);
      if (as_block < block.left) block.block = b, block.left = as_block;
    }
    for (const Longer& best : {delay, block})
      if (best.left < unlimited) all.push_back(best);
  }
  return all;
}

}  // namespace

bool quieten(ScheduledPlan& plan, const Filter& filter, double sample_period, const Machine& machine,
             const std::function<void(ScheduledPlan&)>& check, const Deadline& deadline) {
  if (!has_mode_of_axis(machine) || !all_holds(plan.plan)) return true;
  return Quietening(plan, filter, sample_period, machine, check, deadline).run();
}

}  // namespace accdec
