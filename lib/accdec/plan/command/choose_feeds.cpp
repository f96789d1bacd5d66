#include <algorithm>
#include <cmath>

#include <accdec/machine/response.hpp>
#include <accdec/plan/command/choose_feeds.hpp>
#include <accdec/plan/feeds/compensate_arcs.hpp>
#include <accdec/plan/feeds/contour_feeds.hpp>
#include <accdec/plan/feeds/control_delay.hpp>
#include <accdec/plan/feeds/split_blocks.hpp>
#include <accdec/simulate/command_stream.hpp>
#include <accdec/simulate/sample_check.hpp>
#include <accdec/task/corner_feed.hpp>

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

/// The speed that pieces first .. last have to be held to so that they last `missing` s longer; 0 where it would be
/// below nine tenths of their highest. Held to one speed they change no more from piece to piece than before. By
/// Newton's method, which comes from below: of the pieces faster than the last guess.
double held_speed(const std::vector<FeedPiece>& pieces, std::size_t first, std::size_t last, double top,
                  double missing) {
  double speed = 0.9 * top;
  for (int k = 0; k < 50; ++k) {
    double length = 0.0, time = 0.0;
    for (std::size_t i = first; i <= last; ++i) {
      if (pieces[i].speed <= speed) continue;
      length += pieces[i].length;
      time += pieces[i].length / pieces[i].speed;
    }
    const double next = length / (time + missing);
    if (k == 0 && next < speed) return 0.0;
    if (next <= speed * (1.0 + 1e-15)) break;
    speed = next;
  }
  return speed;
}

/// Makes every run last whole samples by slowing its fastest pieces. This breaks no window's limits. The command stream
/// would slow whole runs, by different factors for neighbours, and could break limits between them.
/// @param keep_corners  the feeds at corners without a delay stay, and no piece becomes slower than they are
void round_runs(const Toolpath& path, std::vector<FeedPiece>& pieces, double sample_period, bool keep_corners) {
  const auto ends_at = [&](std::size_t i) {
    return i + 1 == pieces.size() || pieces[i].rest > 0.0 ||
           (pieces[i + 1].block != pieces[i].block && ends_leg(path, pieces[i].block));
  };
  const auto kept = [&](std::size_t i) { return keep_corners && i + 1 < pieces.size() && !(pieces[i].rest > 0.0); };
  for (std::size_t first = 0, last = 0; first < pieces.size(); first = ++last) {
    while (!ends_at(last)) ++last;
    double time = 0.0, top = 0.0, corner = 0.0;
    for (std::size_t i = first; i <= last; ++i) time += pieces[i].length / pieces[i].speed;
    std::size_t from = first, to = last + 1;
    if (first > 0 && kept(first - 1)) corner = pieces[from++].speed;
    if (kept(last) && to > from) corner = std::max(corner, pieces[--to].speed);
    for (std::size_t i = from; i < to; ++i) top = std::max(top, pieces[i].speed);
    const double missing = static_cast<double>(whole_samples(time / sample_period)) * sample_period - time;
    const double speed = missing > 0.0 && to > from ? held_speed(pieces, from, to - 1, top, missing) : 0.0;
    for (std::size_t i = from; i < to && speed >= corner && speed > 0.0; ++i)
      pieces[i].speed = std::min(pieces[i].speed, speed);
  }
}

/// Chooses feeds, simulates them, and repairs what does not hold, round by round.
class Scheduler {
 public:
  Scheduler(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine,
            const Deadline& deadline, double corner_feed_step)
      : path_(path),
        deadline_(deadline),
        filter_(filter),
        behind_(filter, machine, sample_period),
        period_(sample_period),
        machine_(machine),
        feed_step_(corner_feed_step),
        window_(filter, machine, sample_period, path.dimensions()),
        feeds_(feed_path(path)),
        apart_(behind_.longest_order() + 2),
        joints_(path.blocks()),
        chosen_(path.blocks()) {
    feeds_.part = parts_within_contour(path, behind_, sample_period);
    least_part_ = parts_from_rest(path, behind_, sample_period);
    for (std::size_t b = 0; b < path.blocks(); ++b)
      joints_[b].tolerance = std::min(path.tolerance[b], error_in_contour(b));
    for (const auto& [block, delay] : path.given_delays) {
      joints_[block].given = static_cast<int>(std::lround(std::min(delay / sample_period, 1e9)));
    }
  }

  ScheduledPlan run(int rounds_max) {
    for (int round = 0;; ++round) {
      choose_joints();
      ScheduledPlan plan = simulate(march());
      plan.plan.rounds = round;
      if (all_hold(plan) || round >= rounds_max || deadline_.over()) return plan;
      mend(plan);
    }
  }

  std::optional<ScheduledPlan> run_with_stops() {
    for (JointState& joint : joints_) joint.extra = apart_;
    for (;;) {
      choose_joints();
      const std::vector<FeedPiece> pieces = march();
      if (deadline_.over()) return std::nullopt;
      ScheduledPlan plan = simulate(pieces);
      if (all_hold(plan)) return plan;
      mend(plan);
    }
  }

 private:
  static constexpr int walks_max = 100;  ///< while feeds of corners are lowered to steps
  struct JointState {
    double tolerance = 0.0;               ///< tolerance to plan for, m
    int given = 0;                        ///< delay given in the program, samples
    int extra = 0;                        ///< delay beyond what the joint alone needs
    std::uint8_t errors = 0, limits = 0;  ///< how often it did not hold
    bool choose = true;
  };

  double error_in_contour(std::size_t b) const {
    if (!(path_.contour_max < unlimited) || b + 1 == path_.blocks()) return path_.contour_max;
    const double* u = feeds_.direction.data() + b * feeds_.dimensions;
    return error_within_contour(path_.contour_max, u, u + feeds_.dimensions, feeds_.dimensions);
  }

  void choose_joints() {
    FeedCaps caps(path_, feeds_, behind_, window_, period_, feed_step_);
    for (std::size_t b = 0; b + 1 < path_.blocks(); ++b) {
      JointState& joint = joints_[b];
      if (!joint.choose) continue;
      joint.choose = false;
      if (ends_leg(path_, b)) {
        chosen_[b] = caps.corner(b, joint.tolerance);
      } else {
        const double speed = caps.smooth(b, joint.tolerance);
        chosen_[b] = {speed, speed, 0};
      }
      int& delay = chosen_[b].delay;
      delay = std::max(joint.given, std::min(std::max(apart_, delay), delay + joint.extra));
      if (delay > 0 && path_.joint[b] != Joint::stop)
        delay = delay_had(std::min(chosen_[b].speed, caps.feed(b)), delay);
    }
  }

  /// The shortest delay of the control of at least so many samples.
  int delay_had(double speed, int least) const {
    return control_delay(path_.control, filter_, speed * period_, least).value_or(least);
  }

  std::vector<FeedPiece> march() {
    const FeedCaps caps(path_, feeds_, behind_, window_, period_, feed_step_);
    std::vector<FeedPiece> pieces;
    for (int walk = 0; walk < walks_max; ++walk) {
      pieces = march_feeds(feeds_, window_, caps.pieces(chosen_), Walk::backward, deadline_);
      pieces = march_feeds(feeds_, window_, pieces, Walk::forward, deadline_);
      if (!(feed_step_ > 0.0) || deadline_.over() || !lower_corners(pieces)) break;
    }
    round_runs(path_, pieces, period_, feed_step_ > 0.0);
    return pieces;
  }

  /// Neighbours may let a corner without a delay be passed only at a feed between two steps of the control. It gets the
  /// lower one, or a delay where that is 0.
  /// @return whether any was
  bool lower_corners(const std::vector<FeedPiece>& pieces) {
    constexpr double same = 1e-9;
    bool lowered = false;
    for (std::size_t i = 0; i + 1 < pieces.size(); ++i) {
      const std::size_t b = pieces[i].block;
      CornerFeed& corner = chosen_[b];
      if (pieces[i + 1].block == b || path_.joint[b] != Joint::corner || corner.delay > 0) continue;
      const auto [first, second] = corner_feed_whole(path_, b);
      const double in = pieces[i].speed / first, out = pieces[i + 1].speed / second;
      const double least = std::min(in, out) * (1.0 + same);
      const double part = least >= 1.0 ? 1.0 : corner_feed_part(least, feed_step_);
      if (part > 0.0) {
        if (std::max(in, out) <= part * (1.0 + same)) continue;
        corner = {part * first, part * second, 0};
      } else {
        if (runs_on(path_.control)) continue;
        corner.delay = delay_had(pieces[i].speed, 1);
      }
      lowered = true;
    }
    return lowered;
  }

  ScheduledPlan simulate(const std::vector<FeedPiece>& pieces) {
    ScheduledPlan result;
    result.path = split_blocks(path_, pieces);
    ProgramPlan& plan = result.plan;
    plan.delays.assign(pieces.size(), 0);
    block_of_.resize(pieces.size());
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      const std::uint32_t b = block_of_[i] = pieces[i].block;
      if (i + 1 < pieces.size() && pieces[i + 1].block != b) plan.delays[i] = chosen_[b].delay;
    }
    if (path_.widen_arcs) compensate_arcs(result.path, behind_, plan.delays, period_);
    plan.errors.assign(pieces.size(), 0.0);
    SimulationOptions options;
    if (!machine_.axes.empty()) options.machine = &machine_;
    options.blame = true;
    options.whole_windows = true;
    options.motion = behind_.servo();
    const CommandTiming timing(result.path, period_, plan.delays);
    plan.simulation = simulate_program(timing, filter_, 0, pieces.size() - 1, plan.errors, options);
    plan.errors_hold = true;
    for (std::size_t i = 0; i + 1 < pieces.size() && plan.errors_hold; ++i) {
      plan.errors_hold = holds(plan.errors[i], result.path.tolerance[i]);
    }
    return result;
  }

  static bool all_hold(const ScheduledPlan& plan) {
    return plan.plan.errors_hold && plan.plan.simulation.broken.empty() && plan.plan.simulation.off.empty();
  }

  void mend(const ScheduledPlan& plan) {
    for (std::size_t i = 0; i + 1 < block_of_.size(); ++i) {
      const double error = plan.plan.errors[i], bound = plan.path.tolerance[i];
      if (!holds(error, bound)) mend_error(block_of_[i], bound / error);
    }
    const std::vector<double> had = feeds_.part;
    for (const Simulation::OffPath& off : plan.plan.simulation.off) {
      if (slow_legs(off, had)) continue;
      const bool joint =
          off.point > 0 && off.point < block_of_.size() && joints_[block_of_[off.point - 1]].extra < apart_;
      if (joint)
        mend_error(block_of_[off.point - 1], 1.0 / off.use);
      else
        mend_limit(block_of_[std::min<std::size_t>(off.point, block_of_.size() - 1)]);
    }
    std::uint32_t before = UINT32_MAX;
    for (const std::uint32_t i : plan.plan.simulation.broken) {
      if (block_of_[i] != before) mend_limit(block_of_[i]);
      before = block_of_[i];
    }
  }

  /// Slows the legs at a point to feeds that servos which differ reach from rest within the contour.
  /// @return whether any was faster
  /// @param had  parts of the feeds before this round
  bool slow_legs(const Simulation::OffPath& off, const std::vector<double>& had) {
    bool slowed = false;
    for (std::size_t i = std::max<std::size_t>(off.point, 1) - 1; i <= off.point && i < block_of_.size(); ++i) {
      const std::size_t b = block_of_[i];
      if (!(had[b] > least_part_[b])) continue;
      const double slower = had[b] * std::min(1.0 / off.use, 0.97);
      feeds_.part[b] = std::min(feeds_.part[b], std::max(least_part_[b], slower));
      joints_[b].choose = slowed = true;
      if (b > 0) joints_[b - 1].choose = true;
    }
    return slowed;
  }

  void mend_error(std::size_t b, double part) {
    JointState& joint = joints_[b];
    joint.tolerance *= std::clamp(part, 0.5, 0.97);
    joint.choose = true;
    joint.errors = static_cast<std::uint8_t>(std::min(joint.errors + 1, 100));
    // If joints affect each other, lower speeds may not be enough; a stop always is.
    if (joint.errors > (ends_leg(path_, b) ? 2 : 6) && !runs_on(path_.control)) joint.extra += 1 + filter_.order() / 8;
  }

  /// Lowers the limits that commands within the filter's length before may use.
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
  const Deadline& deadline_;
  const Filter& filter_;  // of the command
  const FilterBehind behind_;
  double period_;
  const Machine& machine_;
  double feed_step_;  // part of the feeds; 0: any
  FeedWindow window_;
  FeedPath feeds_;
  std::vector<double> least_part_;  // of the programmed feeds, that the contour asks for on straight legs
  int apart_;                       // samples; with this delay or more a joint is passed at rest
  std::vector<JointState> joints_;
  std::vector<CornerFeed> chosen_;       // of every joint
  std::vector<std::uint32_t> block_of_;  // of every piece
};

}  // namespace

ScheduledPlan schedule_feeds(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine,
                             int rounds_max, const Deadline& deadline, double corner_feed_step) {
  return Scheduler(path, filter, sample_period, machine, deadline, corner_feed_step).run(rounds_max);
}

double seconds_for_one_plan(const Toolpath& path) {
  // Three rounds of chords of arcs under a jerk limit need 4e-5 s a block; cores may be busy.
  constexpr double least = 2.0, a_block = 2e-4, most = 30.0;
  return std::min(most, least + a_block * static_cast<double>(path.blocks()));
}

std::optional<ScheduledPlan> schedule_stops(const Toolpath& path, const Filter& filter, double sample_period,
                                            const Machine& machine, const Deadline& deadline) {
  // Every joint is a stop, so no corner has a feed of its own.
  return Scheduler(path, filter, sample_period, machine, deadline, 0.0).run_with_stops();
}

}  // namespace accdec
