#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <accdec/certificate/checker.hpp>
#include <accdec/exact/exact_run.hpp>
#include <accdec/exact/size.hpp>
#include <accdec/files/seconds_since.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/motion/shapes.hpp>
#include <accdec/task/contradictions.hpp>
#include <accdec/task/convexity.hpp>
#include <accdec/task/order_bound.hpp>

namespace accdec {
namespace {

/// As many linear programs make a short proof; fewer where they are long.
long shortly(int order) {
  const double length = std::max(1.0, order / 50.0);
  return static_cast<long>(2000.0 / (length * length));
}

/// The next target between a bound and what is known to be open or found above it.
double large_step(double low, double high) {
  for (const double part : {0.8, 0.9, 0.95, 0.97, 0.985}) {
    if (part * high > low * (1.0 + 1e-3)) return part * high;
  }
  return high;
}

}  // namespace

ExactRun::ExactRun(const Task& task)
    : task_(task),
      cost_(cost_of(task)),
      convex_(is_convex(task)),
      several_(task.corners.size() > 1),
      // Symmetric filters are no part of the joint proof.
      jointly_(several_ && !task.design.symmetric),
      minimises_(convex_ && !several_ && !task.design.symmetric),
      fixed_(cost_.given_delays(task)),
      search_(task, [this] { return stopped(); }),
      // Proved by nothing but the task's bounds.
      low_(cost_.filter * (std::max(task.design.order_min, 0) + 1) + fixed_) {
  for (const double w : cost_.delay) step_ += 1.5 * w;
}

bool ExactRun::stopped() const {
  return Clock::now() > until_ || cancelled();
}

/// A task that no search is needed for, or that would not fit into memory.
std::optional<DesignResult> ExactRun::refusal() const {
  DesignResult result;
  result.task = task_;
  result.solver.method = "exact";
  result.solver.name = "dual simplex", result.solver.version = "accdec";
  if (const auto impossible = contradictions(task_); !impossible.empty()) {
    result.status = Status::infeasible;
    result.message = impossible.front();
    if (options_.certificate) result.certificate = certify_contradiction(task_);
    return result;
  }
  try {
    // No order below is allowed or fast enough.
    exact::require_room(task_, std::max(task_.design.order_min, order_lower_bound(task_, task_.design.order_max)));
    return std::nullopt;
  } catch (const exact::TooLarge& reason) {
    result.status = Status::failed;
    result.message = fmt::format("{}; a longer sample period or a nonlinear solver (--solver) may do", reason.what());
  }
  return result;
}

/// Designs that hold limits outside the convex class, where the search itself has none to offer.
void ExactRun::offer_shapes() {
  if (const auto taps = saturating_start(task_, task_.design.order_max); !taps.empty()) search_.offer(Filter(taps));
  for (int n = std::max(least_, 2); n <= task_.design.order_max && !stopped(); ++n) {
    const double shortest = cost_(n, std::vector<int>(task_.corners.size(), 0));
    if (search_.best && shortest >= search_.best->value) break;
    search_.offer(boxcar(n));
    for (int ramp = 1; ramp <= n / 2; ramp += std::max(1, n / 16)) search_.offer(trapezoid(n, ramp));
    search_.offer(hann(n));
  }
}

void ExactRun::first_designs() {
  least_ = search_.smallest_order();
  if (!convex_ || several_) offer_shapes();
  if (minimises_) search_.dive();
  if (several_ && !jointly_) {
    sweep_orders();
    search_.improve();
  }
  trial_ = std::max(low_, cost_.filter * (least_ + 1) + fixed_);
  if (stopped()) least_ = -1;  // once more when there is time
}

/// Each order's linear program is a large one where corners are many: no more than a tenth of the time is spent on
/// them.
void ExactRun::sweep_orders() {
  const auto enough = Clock::now() + (until_ - Clock::now()) / 10;
  search_.sweep_orders(least_, [&] { return Clock::now() > enough; });
  swept_ = true;
}

DesignResult ExactRun::go_on(const ExactOptions& options) {
  const auto began = Clock::now();
  options_ = options;
  // As long as no clock lasts counts as for ever.
  until_ = began + std::chrono::duration_cast<Clock::duration>(
                       std::chrono::duration<double>(std::clamp(options.time_limit, 0.0, 1e8)));
  auto result = refusal();
  if (!result) {
    if (options_.start) search_.offer(*options_.start);
    if (least_ < 0) first_designs();
    if (search_.best) high_ = std::min(high_, search_.best->value);
    if (jointly_ && search_.best) {
      together();
    } else {
      if (!several_) at_once();
      by_targets();
    }
    if (!infeasible_ && convex_ && !search_.best) offer_shapes();
    result = conclude();
    result->solver.evaluations = search_.linear_programs() + (joint_ ? joint_->linear_programs() : 0);
  }
  wall_time_ += seconds_since(began);
  result->solver.wall_time = wall_time_;
  return std::move(*result);
}

/// One corner: what its orders say, and then, for a proof that is short, the best design at once; a long proof moves
/// its bound target by target.
void ExactRun::at_once() {
  if (tried_at_once_ || proved_) return;
  tried_at_once_ = true;
  if (trial_ > low_ && trial_ <= high_ && trial_ < unlimited) take(search_.below(trial_), trial_);
  if (!search_.best || options_.gap > 0.0) return;
  const long budget = search_.linear_programs() + shortly(least_);
  if (!minimises_) climb_ = step_ / 1.5;
  for (Answer answer = Answer::found; answer == Answer::found && !stopped() && !proved_;) {
    answer = search_.minimise(high_, budget - search_.linear_programs());
    if (!minimises_ && answer != Answer::proved) break;  // of what the chords do not refute nothing is known
    take(answer, answer == Answer::proved ? search_.proof.target : high_);
  }
}

/// What a search below a target came to.
void ExactRun::take(Answer answer, double target) {
  if (answer == Answer::open) open_ = std::min(open_, target);
  if (search_.best) high_ = std::min(high_, search_.best->value);
  if (answer == Answer::proved) {
    low_ = std::max(low_, target);
    infeasible_ = target == unlimited;
  }
  proved_ = infeasible_ || (low_ >= high_ && search_.proof.target >= high_);
  tell();
}

/// Several corners of which a design is known: the joint proof.
void ExactRun::together() {
  if (!joint_) joint_ = std::make_unique<exact::Joint>(task_, search_, least_, [this] { return stopped(); });
  joint_->use_threads(options_.threads);
  using State = exact::Joint::State;
  const double at_least = low_;
  for (State state = State::going_on; state == State::going_on;) {
    if (!swept_ && joint_->has_first_bound()) sweep_orders();
    state = joint_->step();
    const double before = low_, found = high_;
    low_ = std::max(low_, joint_->bound());
    high_ = search_.best->value;
    if (low_ > before || high_ < found) tell();
    if (options_.gap > 0.0 && high_ - low_ <= options_.gap * high_) break;
  }
  // What is said in the end is what the certificate shows.
  low_ = at_least;
  if (auto proof = joint_->proof()) search_.proof = std::move(*proof), low_ = std::max(low_, search_.proof.target);
  proved_ = low_ >= high_;
}

/// None: nothing is left to try.
std::optional<double> ExactRun::next_target() {
  if (open_ <= high_ && high_ < unlimited) {
    // The bound can still rise to where the open part begins.
    double target = 0.5 * (low_ + open_);
    if (cost_.whole()) target = std::floor(target);
    if (target <= low_ || open_ - low_ <= 1e-3 * open_) return std::nullopt;
    return target;
  }
  double target = std::min(high_, open_);
  if (options_.gap > 0.0 && high_ < unlimited) {
    target = std::max(0.5 * (low_ + high_), (1.0 - options_.gap) * high_);
    return cost_.whole() ? std::ceil(target) : target;
  }
  if (high_ == unlimited) {
    const double longest = cost_.filter * (task_.design.order_max + 1.0) +
                           step_ / 1.5 * (task_.design.order_max + static_cast<double>(settling)) + fixed_;
    trial_ = std::max(trial_ + step_, 1.3 * trial_);
    return trial_ >= longest ? unlimited : trial_;
  }
  if (high_ - low_ <= step_) return target;
  if (climb_ > 0.0 && low_ >= climbed_) {
    // Each proof goes on from the one before. What the chords say is mostly nearly all.
    climbed_ = std::min(low_ + climb_, high_);
    climb_ *= 2.0;
    return climbed_;
  }
  target = trial_ > low_ && trial_ < high_ && low_ < 0.9 * trial_ ? trial_ : 0.5 * (low_ + high_);
  // With several corners a proof grows fast with its target, and a better design ends it: in large steps.
  if (several_) target = large_step(low_, high_);
  if (cost_.whole()) target = std::floor(target) + 0.0;
  return target <= low_ || target >= high_ ? high_ : target;
}

void ExactRun::by_targets() {
  while (!stopped() && !proved_ && !close_enough()) {
    const std::optional<double> target = next_target();
    if (!target) return;
    const Answer answer = search_.below(*target);
    if (answer == Answer::unknown) return;
    if (several_ && answer == Answer::found) search_.improve();
    take(answer, *target);
    if (open_ == unlimited && answer == Answer::open) return;
  }
}

bool ExactRun::close_enough() const {
  return options_.gap > 0.0 && search_.proof.target > 0.0 && search_.best && high_ - low_ <= options_.gap * high_;
}

void ExactRun::tell() const {
  if (!options_.progress) return;
  const double period = task_.sample_period, incumbent = search_.best ? search_.best->value * period : unlimited;
  options_.progress({low_ * period, incumbent, search_.best ? (incumbent - low_ * period) / incumbent : 1.0});
}

}  // namespace accdec
