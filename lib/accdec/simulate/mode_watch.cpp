#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include <accdec/machine/velocity_changes.hpp>
#include <accdec/simulate/mode_watch.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

constexpr double work_max = 3e8;  // changes times ripples of an event: seconds

/// Gathers the changes of all axes, and judges those that belong together.
class ModeWatch {
 public:
  ModeWatch(const CommandTiming& timing, const Filter& filter, std::size_t first, const Machine& machine)
      : timing_(timing),
        filter_(filter),
        span_(filter.order() - filter.first_nonzero_tap()),
        sample_(first == 0 ? timing.dwell_samples(timing.path().dwell_first) : 0),
        block_(first),
        changes_(timing.path().dimensions()),
        blocks_(timing.path().dimensions()) {
    for (const Mode& mode : machine.modes) {
      if (!mode.of_axis()) continue;
      LimitUse use;
      use.kind = LimitKind::residual;
      use.axis = timing.path().axis_name(static_cast<std::size_t>(mode.axis));
      use.bound = mode.displacement_max;
      use.line = timing.path().line[first];
      worst_.push_back({&mode, residual_utilisation(filter_, 0.0, 1.0, 0, timing.sample_period(), mode).value, use});
    }
  }

  void command(const AxisRow<0>& u0, const AxisRow<0>& u, std::int64_t count, const AxisRow<0>& /*end*/) {
    change(sample_ + 1, u0);
    if (count > 1) change(sample_ + 2, u);
    sample_ += count;
  }
  void joint(std::size_t b, double /*time*/, std::int64_t rest) {
    stops_ = rest > 0 && timing_.path().joint[b] == Joint::stop;
    if (timing_.path().joint[b] == Joint::corner) corner_ = sample_ + 1;
    block_ = b + 1;
  }
  void finish(Simulation& result) {
    change(sample_ + 1, {});
    judge();
    for (const Worst& worst : worst_) {
      result.limits.push_back(worst.use);
      result.limits.back().utilisation = utilisation_of(LimitKind::residual, worst.use.value, worst.use.bound);
    }
    std::ranges::sort(broken_);
    std::vector<std::uint32_t> all;
    std::ranges::set_union(result.broken, broken_, std::back_inserter(all));
    all.erase(std::unique(all.begin(), all.end()), all.end());
    result.broken = std::move(all);
  }

 private:
  struct Worst {
    const Mode* mode;
    double of_one;  // m, what a start to 1 m/s leaves: no change leaves more
    LimitUse use;
  };

  /// From this sample on, the command moves by u.
  void change(std::int64_t sample, const AxisRow<0>& u) {
    const double period = timing_.sample_period();
    bool moved = false, changed = false;
    for (std::size_t a = 0; a < changes_.size(); ++a) {
      moved = moved || std::abs(now_[a]) > position_floor;
      changed = changed || std::abs(u[a] - now_[a]) > position_floor;
    }
    if (!changed) return;
    if (moved && sample - last_ > span_) judge();
    for (std::size_t a = 0; a < changes_.size(); ++a) {
      std::vector<VelocityChange>& changes = changes_[a];
      if (sample == corner_ && !changes.empty() && !changes.back().judged)
        changes.back().judged = true, blocks_[a].push_back(last_block_);
      if (std::abs(u[a] - now_[a]) > position_floor) changes.push_back({sample, (u[a] - now_[a]) / period, false});
    }
    now_ = u;
    last_ = sample;
    last_block_ = block_;
    if (stops_) judge();
    stops_ = false;
  }

  void judge() {
    for (Worst& worst : worst_) {
      const std::vector<VelocityChange>& changes = changes_[static_cast<std::size_t>(worst.mode->axis)];
      double sum = 0.0;
      for (const VelocityChange& change : changes) sum += std::abs(change.by);
      const double most = sum * worst.of_one, allowed = worst.use.bound * (1.0 + verification_tolerance);
      if (changes.empty() || (most <= worst.use.value && most <= allowed)) continue;
      require_little_work(*worst.mode, changes);
      const LimitUse use = residual_utilisation(filter_, changes, timing_.sample_period(), *worst.mode);
      const bool most_so_far = use.value > worst.use.value;
      if (use.value <= allowed && !most_so_far) continue;
      if (most_so_far)
        worst.use.value = use.value, worst.use.frequency = use.frequency, worst.use.damping = use.damping;
      name_places(worst, use, most_so_far);
    }
    for (auto& changes : changes_) changes.clear();
    for (auto& blocks : blocks_) blocks.clear();
  }

  /// The blocks behind which more is left than allowed. @param most  also where most is left
  void name_places(Worst& worst, const LimitUse& use, bool most) {
    const auto axis = static_cast<std::size_t>(worst.mode->axis);
    const std::vector<double> left =
        residuals_behind(filter_, changes_[axis], use.frequency, timing_.sample_period(), use.damping);
    const std::size_t where = static_cast<std::size_t>(std::ranges::max_element(left) - left.begin());
    std::size_t judged = 0;
    for (std::size_t i = 0; i < left.size(); ++i) {
      const bool last = i + 1 == left.size();
      if (!last && !changes_[axis][i].judged) continue;
      const std::size_t block = last ? last_block_ : blocks_[axis][judged++];
      if (left[i] > worst.use.bound * (1.0 + verification_tolerance))
        broken_.push_back(static_cast<std::uint32_t>(block));
      if (!most || i != where) continue;
      worst.use.line = timing_.path().line[std::min(block, timing_.path().blocks() - 1)];
      worst.use.sample = changes_[axis][i].sample + filter_.order();
    }
  }

  void require_little_work(const Mode& mode, const std::vector<VelocityChange>& changes) const {
    const double duration =
        static_cast<double>(changes.back().sample - changes.front().sample) * timing_.sample_period();
    const double ripples = memory_of(mode, mode.damping_low, duration) * (mode.frequency_high - mode.frequency_low);
    if (ripples * static_cast<double>(changes.size()) <= work_max) return;
    throw std::invalid_argument(
        fmt::format("`residual_max_um`: up to line {} the motion does not go on evenly for {:.4g} s, too long to judge "
                    "{} changes of the velocity together; give a `residual_max`",
                    timing_.path().line[std::min(last_block_, timing_.path().blocks() - 1)], duration, changes.size()));
  }

  const CommandTiming& timing_;
  const Filter& filter_;
  std::int64_t span_, sample_;  // samples of the filter, less one; commanded so far
  std::size_t block_, last_block_ = 0;
  bool stops_ = false;
  AxisRow<0> now_{};                                  // by which the command moves
  std::int64_t last_ = 0, corner_ = 0;                // last change; the first change of a corner
  std::vector<std::vector<VelocityChange>> changes_;  // of every axis
  std::vector<std::vector<std::size_t>> blocks_;      // of every axis: those of its judged changes
  std::vector<Worst> worst_;
  std::vector<std::uint32_t> broken_;
};

}  // namespace

void watch_modes(const CommandTiming& timing, const Filter& filter, std::size_t first, std::size_t last,
                 const Machine& machine, Simulation& result) {
  ModeWatch watch(timing, filter, first, machine);
  emit_commands<0>(timing, first, last, watch);
  watch.finish(result);
}

}  // namespace accdec
