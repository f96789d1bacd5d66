#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <accdec/certificate.hpp>
#include <accdec/exact/exact_run.hpp>
#include <accdec/exact/size.hpp>
#include <accdec/family.hpp>
#include <accdec/files.hpp>
#include <accdec/filter.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/task/contradictions.hpp>
#include <accdec/task/convexity.hpp>
#include <accdec/task/order_bound.hpp>

namespace accdec {
namespace {

/// Number of linear programs of a short proof; fewer where each is long.
long shortly(int order) {
  const double length = std::max(1.0, order / 50.0);
  return static_cast<long>(2000.0 / (length * length));
}

/// The next target between a bound and the smallest value known to be open or found above it.
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
      // The joint proof does not cover symmetric filters.
      jointly_(several_ && !task.design.symmetric),
      minimises_(convex_ && !several_ && !task.design.symmetric),
      fixed_(cost_.given_delays(task)),
      search_(task, [this] { return stopped(); }),
      // This bound follows from the task's bounds on the order alone.
      low_(cost_.filter * (std::max(task.design.order_min, 0) + 1) + fixed_) {
  for (const double w : cost_.delay) step_ += 1.5 * w;
}

bool ExactRun::stopped() const {
  return Clock::now() > until_ || cancelled();
}

/// Returns a result for a task that needs no search. Throws for a task that would not fit into memory.
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
    // Smaller orders are not allowed or not fast enough.
    exact::require_room(task_, std::max(task_.design.order_min, order_lower_bound(task_, task_.design.order_max)));
    return std::nullopt;
  } catch (const exact::TooLarge& reason) {
    result.status = Status::failed;
    result.message = fmt::format("{}; a longer sample period or a nonlinear solver (--solver) may do", reason.what());
  }
  return result;
}

/// Offers standard shapes, for tasks where the search itself may find no first design.
void ExactRun::offer_shapes() {
  if (const auto taps = saturating_start(task_, task_.design.order_max); !taps.empty()) search_.offer(Filter(taps));
  for (int n = std::max(least_, 2); n <= task_.design.order_max && !stopped(); ++n) {
    const double shortest = cost_(n, std::vector<int>(task_.corners.size(), 0));
    if (search_.best && shortest >= search_.best->value) break;
    // About sixteen second averages, beginning with none.
    for (const char* name : {"trapezoid", "hann"}) {
      visit_members(*find_family(name), n, std::max(1, n / 16), [&](const FilterSpec& spec, std::span<const int>) {
        search_.offer(make_filter(spec));
        return true;
      });
    }
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

/// With many corners the linear program of each order is large: this step takes at most a tenth of the time.
void ExactRun::sweep_orders() {
  const auto enough = Clock::now() + (until_ - Clock::now()) / 10;
  search_.sweep_orders(least_, [&] { return Clock::now() > enough; });
  swept_ = true;
}

DesignResult ExactRun::go_on(const ExactOptions& options) {
  const auto began = Clock::now();
  options_ = options;
  // A time limit longer than the clock's range means no limit.
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

/// One corner. First bounds by orders; then, if the proof is short, the best design at once. A long proof raises its
/// bound target by target.
void ExactRun::at_once() {
  if (tried_at_once_ || proved_) return;
  tried_at_once_ = true;
  if (trial_ > low_ && trial_ <= high_ && trial_ < unlimited) take(search_.below(trial_), trial_);
  if (!search_.best || options_.gap > 0.0) return;
  const long budget = search_.linear_programs() + shortly(least_);
  if (!minimises_) climb_ = step_ / 1.5;
  for (Answer answer = Answer::found; answer == Answer::found && !stopped() && !proved_;) {
    answer = search_.minimise(high_, budget - search_.linear_programs());
    if (!minimises_ && answer != Answer::proved) break;  // nothing is known of parts that the chords do not refute
    take(answer, answer == Answer::proved ? search_.proof.target : high_);
  }
}

/// Takes over the answer of a search below a target.
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

/// The joint proof: several corners with a known design.
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
  // The reported bound is the one the certificate proves.
  low_ = at_least;
  if (auto proof = joint_->proof()) search_.proof = std::move(*proof), low_ = std::max(low_, search_.proof.target);
  proved_ = low_ >= high_;
}

/// The next target; none if nothing is left to try.
std::optional<double> ExactRun::next_target() {
  if (open_ <= high_ && high_ < unlimited) {
    // The bound can still rise to the start of the open part.
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
    const double longest =
        cost_.filter * (task_.design.order_max + 1.0) +
        step_ / 1.5 * (task_.design.order_max + static_cast<double>(settling) + exact::ServoRamps(task_).longer()) +
        fixed_;
    trial_ = std::max(trial_ + step_, 1.3 * trial_);
    return trial_ >= longest ? unlimited : trial_;
  }
  if (high_ - low_ <= step_) return target;
  if (climb_ > 0.0 && low_ >= climbed_) {
    // Each proof continues the one before. The bound from the chords is usually close to the best one.
    climbed_ = std::min(low_ + climb_, high_);
    climb_ *= 2.0;
    return climbed_;
  }
  target = trial_ > low_ && trial_ < high_ && low_ < 0.9 * trial_ ? trial_ : 0.5 * (low_ + high_);
  // With several corners a proof grows fast with its target, and a better design ends it. So take large steps.
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
