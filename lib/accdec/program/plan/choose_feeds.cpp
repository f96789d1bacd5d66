#include <algorithm>
#include <cmath>

#include <accdec/program/plan/choose_feeds.hpp>
#include <accdec/program/plan/compensate_arcs.hpp>
#include <accdec/program/plan/split_blocks.hpp>

namespace accdec {
namespace {

FeedPath feed_path(const Toolpath& path) {
  FeedPath feeds;
  const std::size_t n = feeds.dimensions = path.dimensions(), blocks = path.blocks();
  feeds.direction.resize(blocks * n);
  feeds.length.resize(blocks);
  feeds.margin.assign(blocks, 1.0F);
  for (std::size_t b = 0; b < blocks; ++b) {
    const double* p = path.point(b);
    double sum = 0.0;
    for (std::size_t a = 0; a < n; ++a) sum += (p[n + a] - p[a]) * (p[n + a] - p[a]);
    const double length = feeds.length[b] = std::sqrt(sum);
    for (std::size_t a = 0; a < n; ++a) feeds.direction[b * n + a] = (p[n + a] - p[a]) / length;
  }
  return feeds;
}

/// Makes every run last whole samples by slowing its fastest pieces, which no window minds: if all of a run were
/// slowed, as the command stream does else, neighbouring runs would be by different factors, and what just held between
/// them would not.
void round_runs(const Toolpath& path, std::vector<FeedPiece>& pieces, double sample_period) {
  for (std::size_t first = 0; first < pieces.size();) {
    std::size_t last = first;
    double time = 0.0, top = 0.0;
    for (;; ++last) {
      time += pieces[last].length / pieces[last].speed;
      top = std::max(top, pieces[last].speed);
      if (last + 1 == pieces.size()) break;
      const std::uint32_t b = pieces[last].block;
      if (pieces[last].rest > 0.0 || (pieces[last + 1].block != b && ends_leg(path, b))) break;
    }
    const double missing = std::ceil(time / sample_period - 1e-9) * sample_period - time;
    double fastest = 0.0;
    for (std::size_t i = first; i <= last; ++i)
      fastest += pieces[i].speed >= 0.999 * top ? pieces[i].length / pieces[i].speed : 0.0;
    for (std::size_t i = first; i <= last && missing > 0.0 && fastest > 10.0 * missing; ++i) {
      if (pieces[i].speed >= 0.999 * top) pieces[i].speed *= fastest / (fastest + missing);
    }
    first = last + 1;
  }
}

/// Chooses, simulates, and mends what does not hold, round by round.
class Scheduler {
 public:
  Scheduler(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine)
      : path_(path),
        filter_(filter),
        filters_(filter),
        period_(sample_period),
        machine_(machine),
        window_(filter, machine, sample_period, path.dimensions()),
        feeds_(feed_path(path)),
        apart_(filter.order() + 2),
        joints_(path.blocks()),
        speed_(path.blocks(), unlimited),
        delay_(path.blocks(), 0) {
    for (std::size_t b = 0; b < path.blocks(); ++b) joints_[b].tolerance = path.tolerance[b];
    for (const auto& [block, delay] : path.given) {
      joints_[block].given = static_cast<int>(std::lround(std::min(delay / sample_period, 1e9)));
    }
  }

  ScheduledPlan run(int rounds_max) {
    for (int round = 0;; ++round) {
      choose_joints();
      ScheduledPlan plan = simulate(march());
      plan.plan.rounds = round;
      if (all_hold(plan) || round >= rounds_max) return plan;
      mend(plan);
    }
  }

 private:
  struct JointState {
    double tolerance = 0.0;               ///< asked for, m
    int given = 0;                        ///< delay that the program brings along, samples
    int extra = 0;                        ///< delay beyond what the joint alone asks for
    std::uint8_t errors = 0, limits = 0;  ///< how often it did not hold
    bool choose = true;
  };

  void choose_joints() {
    const FeedCaps caps(path_, feeds_, filter_, window_, period_);
    for (std::size_t b = 0; b + 1 < path_.blocks(); ++b) {
      JointState& joint = joints_[b];
      if (!joint.choose) continue;
      joint.choose = false;
      delay_[b] = 0;
      if (ends_leg(path_, b)) {
        const CornerFeed corner = caps.corner(b, joint.tolerance);
        speed_[b] = corner.speed;
        delay_[b] = corner.delay;
      } else {
        speed_[b] = caps.smooth(b, joint.tolerance);
      }
      delay_[b] = std::max(joint.given, std::min(std::max(apart_, delay_[b]), delay_[b] + joint.extra));
    }
  }

  std::vector<FeedPiece> march() {
    const FeedCaps caps(path_, feeds_, filter_, window_, period_);
    std::vector<FeedPiece> pieces = march_feeds(feeds_, window_, caps.pieces(speed_, delay_), Walk::backward);
    pieces = march_feeds(feeds_, window_, pieces, Walk::forward);
    round_runs(path_, pieces, period_);
    return pieces;
  }

  ScheduledPlan simulate(const std::vector<FeedPiece>& pieces) {
    ScheduledPlan result;
    result.path = split_blocks(path_, pieces);
    ProgramPlan& plan = result.plan;
    plan.delays.assign(pieces.size(), 0);
    block_of_.resize(pieces.size());
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      const std::uint32_t b = block_of_[i] = pieces[i].block;
      if (i + 1 < pieces.size() && pieces[i + 1].block != b) plan.delays[i] = delay_[b];
    }
    if (path_.widen_arcs) compensate_arcs(result.path, filters_, plan.delays, period_);
    plan.errors.assign(pieces.size(), 0.0);
    SimulationOptions options;
    if (!machine_.axes.empty()) options.machine = &machine_;
    options.blame = true;
    const CommandTiming timing(result.path, period_, plan.delays);
    plan.simulation = simulate_program(timing, filters_, 0, pieces.size() - 1, plan.errors, options);
    plan.errors_hold = true;
    for (std::size_t i = 0; i + 1 < pieces.size() && plan.errors_hold; ++i) {
      plan.errors_hold = holds(plan.errors[i], result.path.tolerance[i]);
    }
    return result;
  }

  static bool all_hold(const ScheduledPlan& plan) {
    return plan.plan.errors_hold && plan.plan.simulation.broken.empty();
  }

  void mend(const ScheduledPlan& plan) {
    for (std::size_t i = 0; i + 1 < block_of_.size(); ++i) {
      const double error = plan.plan.errors[i], bound = plan.path.tolerance[i];
      if (!holds(error, bound)) mend_error(block_of_[i], bound / error);
    }
    std::uint32_t before = UINT32_MAX;
    for (const std::uint32_t i : plan.plan.simulation.broken) {
      if (block_of_[i] != before) mend_limit(block_of_[i]);
      before = block_of_[i];
    }
  }

  void mend_error(std::size_t b, double part) {
    JointState& joint = joints_[b];
    joint.tolerance *= std::clamp(part, 0.5, 0.97);
    joint.choose = true;
    joint.errors = static_cast<std::uint8_t>(std::min(joint.errors + 1, 100));
    // Where joints act on each other, slower alone may not do; at rest always does.
    if (joint.errors > (ends_leg(path_, b) ? 2 : 6)) joint.extra += 1 + filter_.order() / 8;
  }

  /// Everything commanded within the filter's length before may use a little less of the limits.
  void mend_limit(std::size_t b) {
    JointState& state = joints_[b];
    state.limits = static_cast<std::uint8_t>(std::min(state.limits + 1, 100));
    const float part = state.limits > 8 ? 0.8F : state.limits > 4 ? 0.92F : 0.97F;
    double back = 0.0;
    for (std::size_t i = b + 1; i-- > 0 && back < window_.reach(); back += path_.duration[i]) {
      feeds_.margin[i] = std::max(0.02F, feeds_.margin[i] * part);
      joints_[i].choose = true;
      if (i > 0) joints_[i - 1].choose = true;
    }
  }

  const Toolpath& path_;
  const Filter& filter_;
  LegFilters filters_;
  double period_;
  const Machine& machine_;
  FeedWindow window_;
  FeedPath feeds_;
  int apart_;  // samples; from this delay on a joint is passed at rest
  std::vector<JointState> joints_;
  std::vector<double> speed_;
  std::vector<int> delay_;
  std::vector<std::uint32_t> block_of_;  // of every piece
};

}  // namespace

ScheduledPlan schedule_feeds(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine,
                             int rounds_max) {
  return Scheduler(path, filter, sample_period, machine).run(rounds_max);
}

}  // namespace accdec
