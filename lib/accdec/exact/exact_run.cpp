#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <accdec/certificate.hpp>
#include <accdec/exact/exact_run.hpp>
#include <accdec/exact/one_tolerance.hpp>
#include <accdec/exact/quick_bound.hpp>
#include <accdec/exact/size.hpp>
#include <accdec/files.hpp>
#include <accdec/filter.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/task/contradictions.hpp>
#include <accdec/task/convexity.hpp>
#include <accdec/task/objective.hpp>
#include <accdec/task/order_bound.hpp>

namespace accdec {
namespace {

using Answer = exact::Search::Answer;

/// Number of linear programs of a short proof; fewer where each is long.
long shortly(int order) {
  const double length = std::max(1.0, order / 50.0);
  return static_cast<long>(2000.0 / (length * length));
}

/// Returns a result for a task that needs no search. Throws for a task that would not fit into memory.
std::optional<DesignResult> refusal(const Task& task, bool certificate) {
  DesignResult result;
  result.task = task;
  result.solver.method = "exact";
  result.solver.name = "dual simplex", result.solver.version = "accdec";
  if (const auto impossible = contradictions(task); !impossible.empty()) {
    result.status = Status::infeasible;
    result.message = impossible.front();
    if (certificate) result.certificate = certify_contradiction(task);
    return result;
  }
  try {
    // Smaller orders are not allowed or not fast enough.
    exact::require_room(task, std::max(task.design.order_min, order_lower_bound(task, task.design.order_max)));
    return std::nullopt;
  } catch (const exact::TooLarge& reason) {
    result.status = Status::failed;
    result.message = fmt::format("{}; a longer sample period or a nonlinear solver (--solver) may do", reason.what());
  }
  return result;
}

}  // namespace

ExactRun::ExactRun(const Task& task)
    : task_(task),
      // The joint proof does not cover symmetric filters.
      kind_{.convex = is_convex(task),
            .several = task.corners.size() > 1,
            .jointly = task.corners.size() > 1 && !task.design.symmetric,
            .minimises = is_convex(task) && task.corners.size() <= 1 && !task.design.symmetric},
      targets_(task),
      bench_(task, [this] { return stopped(); }) {}

bool ExactRun::stopped() const {
  return until_.over() || cancelled();
}

/// A bound without linear programs comes first if these are long.
void ExactRun::quick_bound() {
  constexpr int many_taps = 300;
  if (std::exchange(done_.quick, true)) return;
  if (1.0 / bench_.model().rows.tap_max() < many_taps) return;
  const std::vector<int> delays(task_.corners.size(), task_.design.order_max);
  const double longest = cost_of(task_)(task_.design.order_max, delays);
  auto proof = exact::QuickBound(bench_).prove(bench_.designs.best ? bench_.designs.best->value : longest);
  if (!proof) return;
  targets_.proved(proof->target);
  search_.proof = std::move(*proof);
  tell();
}

void ExactRun::first_designs() {
  quick_bound();
  least_ = first_.smallest_order();
  if (!kind_.convex || kind_.several) first_.offer_shapes(std::max(least_, 2));
  if (kind_.minimises) first_.dive();
  if (kind_.several && !kind_.jointly) {
    sweep_orders();
    search_.improve();
  }
  targets_.begin(least_);
  if (stopped()) least_ = -1;  // once more when there is time
  if (stopped() || bench_.designs.best) return;
  // With many corners or long filters, a tolerance that can be held takes long.
  const Deadline enough(until_.left() / 2.0);
  const auto stop = [this] { return stopped(); };
  const auto late = [&] { return stop() || enough.over(); };
  if (auto proof = exact::refute_one_tolerance(task_, late, stop)) {
    search_.proof = std::move(*proof);
    take(Answer::proved, unlimited);
  }
}

/// With many corners the linear program of each order is large: this step takes at most a tenth of the time.
void ExactRun::sweep_orders() {
  const Deadline enough(until_.left() / 10.0);
  first_.sweep_orders(least_, [&] { return enough.over(); });
  done_.swept = true;
}

DesignResult ExactRun::go_on(const ExactOptions& options) {
  const auto began = std::chrono::steady_clock::now();
  options_ = options;
  until_ = Deadline(std::max(options.time_limit, 0.0));
  auto result = refusal(task_, options.certificate);
  if (!result) {
    if (options_.start) bench_.designs.offer(*options_.start);
    if (least_ < 0) first_designs();
    if (bench_.designs.best) targets_.found(bench_.designs.best->value);
    if (kind_.jointly && bench_.designs.best) {
      together();
    } else if (!done_.infeasible) {
      if (!kind_.several) at_once();
      by_targets();
    }
    if (!done_.infeasible && kind_.convex && !bench_.designs.best) first_.offer_shapes(std::max(least_, 2));
    result = conclude();
    result->solver.evaluations = bench_.linear_programs() + (joint_ ? joint_->linear_programs() : 0);
  }
  wall_time_ += seconds_since(began);
  result->solver.wall_time = wall_time_;
  return std::move(*result);
}

/// One corner. First bounds by orders; then, if the proof is short, the best design at once. A long proof raises its
/// bound target by target.
void ExactRun::at_once() {
  if (done_.tried_at_once || done_.proved) return;
  done_.tried_at_once = true;
  const double first = targets_.first();
  if (first > targets_.low() && first <= targets_.high() && first < unlimited) take(search_.below(first), first);
  if (!bench_.designs.best || options_.gap > 0.0) return;
  const long budget = bench_.linear_programs() + shortly(least_);
  if (!kind_.minimises) targets_.climb();
  for (Answer answer = Answer::found; answer == Answer::found && !stopped() && !done_.proved;) {
    answer = search_.minimise(targets_.high(), budget - bench_.linear_programs());
    if (!kind_.minimises && answer != Answer::proved) break;  // nothing is known of parts that the chords do not refute
    take(answer, answer == Answer::proved ? search_.proof.target : targets_.high());
  }
}

/// Takes over the answer of a search below a target.
void ExactRun::take(Answer answer, double target) {
  if (answer == Answer::open) targets_.leave_open(target);
  if (bench_.designs.best) targets_.found(bench_.designs.best->value);
  if (answer == Answer::proved) {
    targets_.proved(target);
    done_.infeasible = target == unlimited;
  }
  done_.proved = done_.infeasible || (targets_.low() >= targets_.high() && search_.proof.target >= targets_.high());
  tell();
}

/// The joint proof: several corners with a known design.
void ExactRun::together() {
  if (!joint_) joint_ = std::make_unique<exact::Joint>(task_, bench_.designs, least_, [this] { return stopped(); });
  joint_->use_threads(options_.threads);
  using State = exact::Joint::State;
  const double at_least = targets_.low();
  for (State state = State::going_on; state == State::going_on;) {
    if (!done_.swept && joint_->has_first_bound()) sweep_orders();
    state = joint_->step();
    const double before = targets_.low(), found = targets_.high();
    targets_.proved(joint_->bound());
    targets_.found(bench_.designs.best->value);
    if (targets_.low() > before || targets_.high() < found) tell();
    if (targets_.within(options_.gap)) break;
  }
  // The reported bound is the one the certificate proves.
  targets_.set_low(at_least);
  if (auto proof = joint_->proof(); proof && proof->target >= search_.proof.target)
    search_.proof = std::move(*proof), targets_.proved(search_.proof.target);
  done_.proved = targets_.low() >= targets_.high();
}

void ExactRun::by_targets() {
  while (!stopped() && !done_.proved && !close_enough()) {
    const std::optional<double> target = targets_.next(options_.gap);
    if (!target) return;
    const Answer answer = search_.below(*target);
    if (answer == Answer::unknown) return;
    if (kind_.several && answer == Answer::found) search_.improve();
    take(answer, *target);
    if (!targets_.has_open() && answer == Answer::open) return;
  }
}

bool ExactRun::close_enough() const {
  return search_.proof.target > 0.0 && bench_.designs.best && targets_.within(options_.gap);
}

void ExactRun::tell() const {
  if (!options_.progress) return;
  const double period = task_.sample_period,
               incumbent = bench_.designs.best ? bench_.designs.best->value * period : unlimited;
  options_.progress({targets_.low() * period, incumbent,
                     bench_.designs.best ? (incumbent - targets_.low() * period) / incumbent : 1.0});
}

}  // namespace accdec
