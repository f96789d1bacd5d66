#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <tuple>

#include <fmt/format.h>

#include <accdec/comparison/comparison_case.hpp>
#include <accdec/comparison/reference_delay.hpp>
#include <accdec/comparison/reference_proof.hpp>
#include <accdec/design/anytime.hpp>
#include <accdec/design/limit_rows.hpp>
#include <accdec/exact/exact.hpp>
#include <accdec/exact/relaxation.hpp>
#include <accdec/files.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/nlp/violation.hpp>
#include <accdec/task/convexity.hpp>
#include <accdec/task/objective.hpp>
#include <accdec/task/order_bound.hpp>

namespace accdec::comparison {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
/// Width at which bisection stops, relative to max(1, objective).
constexpr double accuracy = 1e-6;
/// The widest bracket of a proved optimum; half of what solvers are granted.
constexpr double closed = 5e-5;
/// Largest amount by which a known point may break rows, in units of a row. It is the linear programs' own tolerance,
/// and solvers may use as much.
constexpr double held = 1e-7;

/// The task with its bands replaced by the frequencies at which the formulations impose them.
Task with_frequencies(const CaseSpec& spec) {
  Task task = spec.task;
  task.machine.modes.clear();
  const auto frequencies = initial_frequencies(spec.task, spec.order);
  for (std::size_t m = 0; m < frequencies.size(); ++m) {
    for (const double f : frequencies[m]) {
      Mode mode = spec.task.machine.modes[m];
      mode.frequency_low = mode.frequency_high = f;
      for (const double damping : {mode.damping_low, mode.damping_high}) {
        Mode one = mode;
        one.damping_low = one.damping_high = damping;
        task.machine.modes.push_back(one);
        if (mode.damping_low == mode.damping_high) break;
      }
    }
  }
  return task;
}

/// The convex limits at fixed order, delays and samples, with every tolerance times `scale`; infinite: without them.
exact::Outcome solve(Task task, const CaseSpec& spec, const std::vector<int>& delays, const std::vector<int>& samples,
                     double scale) {
  for (TaskCorner& corner : task.corners) {
    if (!corner.error_max) continue;
    if (std::isinf(scale) || *corner.error_max == 0.0) {
      corner.error_max.reset();
    } else {
      *corner.error_max *= scale;
    }
  }
  const exact::LimitModel model(task);
  exact::Relaxation relaxation(model, spec.order);
  exact::Box box;
  box.order = spec.order;
  for (std::size_t j = 0; j < task.corners.size(); ++j)
    box.corners.push_back({delays[j], delays[j], samples[j], samples[j]});
  if (!model.convex() && !model.shrink(box)) {
    exact::Outcome nothing;
    nothing.kind = exact::Outcome::refuted;
    return nothing;
  }
  return relaxation.solve(box, spec.task.design.symmetric);
}

/// sigma of MarginProblem for a filter.
double margin_of(const Task& task, const Filter& filter, const std::vector<int>& delays,
                 const std::vector<int>& samples) {
  double worst = 0.0;
  for (std::size_t j = 0; j < task.corners.size(); ++j) {
    const TaskCorner& corner = task.corners[j];
    if (!corner.error_max || *corner.error_max == 0.0) continue;
    const double p =
        corner.geometry().feed_in * task.sample_period / *corner.error_max * filter.remaining_moment(samples[j]);
    const double q = corner.geometry().feed_out * task.sample_period / *corner.error_max *
                     filter.elapsed_moment(samples[j] - delays[j]);
    worst = std::max(worst, p * p + q * q + 2.0 * corner.geometry().cos_interior() * p * q);
  }
  return worst;
}

Reference infeasible(std::string method, long work, std::shared_ptr<const InstanceProof> why = nullptr) {
  return {Reference::Proof::infeasible, infinity, infinity, std::move(method), work, std::move(why)};
}

/// A proof of infeasibility without any tolerance, or a filter that holds the convex limits.
std::optional<Reference> no_filter_at_all(const Task& task, const ComparisonCase& subject,
                                          const std::vector<int>& delays, const std::vector<int>& samples,
                                          std::optional<Filter>& filter) {
  const CaseSpec& spec = subject.spec();
  const bool too_short = order_lower_bound(spec.task, spec.order) > spec.order;
  const exact::Outcome outcome = solve(task, spec, delays, samples, infinity);
  std::shared_ptr<const InstanceProof> why;
  if (too_short || outcome.kind == exact::Outcome::refuted)
    why = instance_proof_of(subject, std::nullopt, one_part(certificate_of(task, outcome)));
  if (too_short) return infeasible("fastest start within the limits takes a larger order", 0, why);
  if (why) return infeasible("linear program refuted by its dual multipliers", 1, why);
  if (outcome.kind == exact::Outcome::feasible) filter = outcome.filter;
  return std::nullopt;
}

/// An error scale above that of any filter of the order at any sample: a leg runs at most its feed all the time.
double largest_error_scale(const Task& task, int order) {
  double most = 0.0;
  for (const TaskCorner& corner : task.corners) {
    if (!corner.error_max || *corner.error_max == 0.0) continue;
    const auto geometry = corner.geometry();
    most = std::max(most, (geometry.feed_in + geometry.feed_out) * task.sample_period * order / *corner.error_max);
  }
  return most;
}

/// Search for the least error scale; value^2 is sigma.
class MarginSearch : public ReferenceSearch {
 public:
  MarginSearch(Task& task, const CaseSpec& spec, const std::vector<int>& samples, std::function<bool()> late)
      : ReferenceSearch(task, spec.order, spec.delays, std::move(late)),
        task_(task),
        plain_(task),
        spec_(spec),
        samples_(samples) {}

 protected:
  void place(const Part&, double value, exact::Box& box) override {
    for (std::size_t j = 0; j < task_.corners.size(); ++j) {
      box.corners[j].k1 = box.corners[j].k2 = samples_[j];
      if (task_.corners[j].error_max) *task_.corners[j].error_max = value * *plain_.corners[j].error_max;
    }
    follow_tolerances();
  }
  double value_of(const Filter& filter, const Part&) override {
    return std::sqrt(margin_of(plain_, filter, spec_.delays, samples_));
  }
  bool approach_is_enough() const override {
    return std::ranges::count_if(plain_.corners, [](const TaskCorner& c) { return c.error_max.has_value(); }) == 1;
  }

 private:
  Task& task_;
  const Task plain_;
  const CaseSpec& spec_;
  const std::vector<int>& samples_;
};

std::function<bool()> timer(double limit) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(limit);
  return [end] { return std::chrono::steady_clock::now() > end; };
}

std::string with_splits(const Task& task) {
  return is_convex(task) ? "" : ", chords of power and speed limits split on responses";
}

Reference margin_reference(const ComparisonCase& subject, double time_limit) {
  const CaseSpec& spec = subject.spec();
  Task task = with_frequencies(spec);
  std::optional<Filter> filter;
  if (const auto none = no_filter_at_all(task, subject, spec.delays, subject.samples(), filter)) return *none;
  Reference reference{Reference::Proof::bound, 0.0, infinity, "exact bound"};
  const double trial = filter ? std::sqrt(margin_of(task, *filter, spec.delays, subject.samples())) : 1.0;
  for (TaskCorner& corner : task.corners) {
    if (corner.error_max && *corner.error_max == 0.0) corner.error_max.reset();
  }
  const auto began = std::chrono::steady_clock::now();
  MarginSearch search(task, spec, subject.samples(), timer(time_limit));
  // First the precision needed for judging, then as far as it is quick.
  for (const double wanted : {0.8 * closed, accuracy}) {
    search.run(std::max(trial, 1e-6), [wanted](double upper) {
      return wanted * std::max(1.0, upper * upper) / (2.0 * std::max(upper, 1e-9));
    });
    if (!is_convex(task) && std::chrono::steady_clock::now() - began > std::chrono::duration<double>(0.05 * time_limit))
      break;
  }
  reference.lower = search.lower * search.lower;
  reference.work = search.linear_programs();
  reference.refutation = instance_proof_of(subject, reference.lower, one_part(search.proof()));
  if (!search.best && search.lower > largest_error_scale(subject.spec().task, spec.order))
    return infeasible("exact: linear programs that refute every corner error", reference.work, reference.refutation);
  if (!search.best) return reference;
  const auto& problem = dynamic_cast<const MarginProblem&>(*subject.problem(true));
  std::vector<double> x = problem.start_from(*search.best);
  x[static_cast<std::size_t>(problem.sigma())] = search.upper * search.upper * (1.0 + 1e-12);
  const double upper = problem.objective(x);
  if (upper - reference.lower <= closed * std::max(1.0, upper) && nlp::largest_violation(problem, x) <= held) {
    reference.proof = Reference::Proof::optimal;
    reference.upper = upper;
    reference.method = "exact: bisection with refuting linear programs" + with_splits(task);
  } else {
    reference.method = fmt::format("exact bound, bisection not finished (gap {:.2g})", upper - reference.lower);
  }
  return reference;
}

/// The point of the reduced DelayProblem for a filter, with its least delays and their instants.
std::vector<double> delay_point(const ComparisonCase& subject, const Filter& filter,
                                const std::vector<std::unique_ptr<DelaySearch>>& searches) {
  const Task& task = subject.spec().task;
  const nlp::Problem& problem = *subject.problem(true);
  std::vector<double> delays, instants(task.corners.size(), 0.0);
  for (const TaskCorner& corner : task.corners) delays.push_back(corner.delay.value_or(0));
  for (const auto& search : searches) {
    const std::size_t j = search->corner();
    const auto [delay, instant] = search->delay_of(filter, delays[j]);
    if (!task.corners[j].delay) delays[j] = delay;
    instants[j] = instant;
  }
  std::vector<double> x = dynamic_cast<const DelayProblem&>(problem).start_from(filter, delays);
  for (const auto& search : searches) {
    for (int i = 0; i < problem.num_variables(); ++i) {
      if (problem.variable_name(i) == "t " + task.corners[search->corner()].name)
        x[static_cast<std::size_t>(i)] = instants[search->corner()];
    }
  }
  return x;
}

/// The sum of what each corner needs with a filter made for it alone. It is the proved optimum if one filter is as good
/// for all. Without a delay to choose the optimum is 0, unless no filter holds a corner at its given delay.
Reference delay_reference(const ComparisonCase& subject, double time_limit) {
  const CaseSpec& spec = subject.spec();
  const Task task = with_frequencies(spec);
  std::optional<Filter> filter;
  if (const auto none =
          no_filter_at_all(task, subject, subject.blend_delays(), std::vector<int>(task.corners.size(), 0), filter))
    return *none;
  std::vector<std::size_t> free, given;
  for (std::size_t j = 0; j < task.corners.size(); ++j) {
    if (task.corners[j].error_max && *task.corners[j].error_max > 0.0)
      (task.corners[j].delay ? given : free).push_back(j);
  }
  const bool all_given = free.empty();
  Reference reference{Reference::Proof::bound, 0.0, infinity, "delays are not negative"};
  const auto began = std::chrono::steady_clock::now();
  // Those with a given delay, too: it may be shorter than any filter allows.
  std::vector<std::size_t> corners = free;
  corners.insert(corners.end(), given.begin(), given.end());
  std::vector<Task> tasks(corners.size(), task);  // kept: searches refer to them
  std::vector<std::unique_ptr<DelaySearch>> searches;
  std::vector<InstanceProof::Part> parts;
  for (std::size_t n = 0; n < corners.size(); ++n) {
    const std::size_t j = corners[n];
    for (std::size_t i = 0; i < task.corners.size(); ++i) {
      if (i != j) tasks[n].corners[i].error_max.reset();
    }
    const double left = time_limit - seconds_since(began);
    searches.push_back(std::make_unique<DelaySearch>(tasks[n], j, spec.order, subject.blend_delays(),
                                                     timer(left / static_cast<double>(corners.size() - n))));
    DelaySearch& search = *searches.back();
    const double share = free.size() == 1 ? 1.0 : 0.2;
    const std::optional<int> delay = task.corners[j].delay;
    search.run(spec.order + 1.0, [&](double upper) {
      return delay && upper <= *delay ? infinity : share * closed * std::max(1.0 / task.corners[j].weight, upper);
    });
    reference.work += search.linear_programs();
    std::vector<InstanceProof::Part> alone;
    if (search.proof()) alone.push_back({static_cast<int>(j), search.lower, *search.proof()});
    // A delay of more than the order is an exact stop, which changes nothing any more.
    if (!search.best && search.lower > spec.order + 1.0)
      return infeasible("exact: linear programs that refute every delay of corner " + task.corners[j].name,
                        reference.work, instance_proof_of(subject, std::nullopt, alone));
    if (delay && search.lower > *delay + closed * std::max(1.0, static_cast<double>(*delay)))
      return infeasible("exact: linear programs that refute the given delay of corner " + task.corners[j].name,
                        reference.work, instance_proof_of(subject, std::nullopt, alone));
    if (delay) continue;
    reference.lower += task.corners[j].weight * search.lower;
    if (search.lower > 0.0) parts.insert(parts.end(), alone.begin(), alone.end());
  }
  if (!all_given) reference.refutation = instance_proof_of(subject, reference.lower, std::move(parts));
  reference.method = free.size() > 1 ? "exact bound: the sum of what each corner needs on its own" : "exact bound";
  std::vector<Filter> made;
  for (const auto& search : searches) {
    if (search->best) made.push_back(*search->best);
  }
  if (all_given && filter) made.push_back(*filter);
  for (const Filter& best : made) {
    const nlp::Problem& problem = *subject.problem(true);
    const std::vector<double> x = delay_point(subject, best, searches);
    const double upper = problem.objective(x);
    if (upper - reference.lower > closed * std::max(1.0, upper) || nlp::largest_violation(problem, x) > held ||
        upper >= reference.upper)
      continue;
    reference.proof = Reference::Proof::optimal;
    reference.upper = upper;
    reference.method = "exact: linear programs that refute intervals of instants" + with_splits(task);
    if (all_given)
      reference.method = "every delay is given; a filter that holds all limits is known";
    else if (free.size() > 1)
      reference.method += "; one filter is best for each corner";
  }
  if (reference.proof != Reference::Proof::optimal && free.size() == 1)
    reference.method += ", branch and bound not finished";
  return reference;
}

Reference no_reference(const std::string& reason) {
  return {Reference::Proof::bound, 0.0, infinity, "no reference: " + reason};
}

/// Whether the linear programs of the two smooth problems, which are of the taps, know all limits.
bool of_the_taps(const Task& task) {
  return Response(task.machine, task.sample_period).ideal() && !limits_supply(task.machine) &&
         std::ranges::none_of(task.machine.modes, &Mode::of_axis) &&
         std::ranges::none_of(task.corners, [](const TaskCorner& c) { return c.contour_max.has_value(); });
}

}  // namespace

DesignResult exact_at_order(const CaseSpec& spec, double time_limit, bool certificate) {
  ExactOptions options;
  options.time_limit = time_limit;
  options.certificate = certificate;
  Task task = spec.task;
  task.design.order_min = task.design.order_max = spec.order;
  return design_exact(task, options);
}

Reference reference_of(const DesignResult& result) {
  if (result.status == Status::infeasible) return infeasible("exact: " + result.message, result.solver.evaluations);
  const double period = result.task.sample_period;
  // Rounded down: seconds over the period may be a bit above the samples.
  const double lower = result.lower_bound.value_or(0.0) / period * (1.0 - 4.0 * std::numeric_limits<double>::epsilon());
  Reference reference{Reference::Proof::bound, lower, infinity, "exact bound", result.solver.evaluations};
  if (result.status != Status::optimal) return reference;
  reference.proof = Reference::Proof::optimal;
  std::vector<int> delays;
  for (const CornerResult& corner : result.corners) delays.push_back(corner.delay);
  reference.lower = reference.upper = cost_of(result.task)(result.filter->order(), delays);
  reference.method = "exact design at this order";
  return reference;
}

std::string_view to_string(Reference::Proof proof) {
  switch (proof) {
    case Reference::Proof::optimal: return "proved";
    case Reference::Proof::infeasible: return "infeasible proved";
    case Reference::Proof::bound: return "bound";
  }
  return "?";
}

Reference reference_of(const ComparisonCase& subject, double time_limit) {
  const CaseSpec& spec = subject.spec();
  if (!subject.objection().empty()) return no_reference(subject.objection());
  const bool known = spec.question == Question::design ? exact_covers(spec.task) : of_the_taps(spec.task);
  if (!known)
    return no_reference(
        "the exact method knows no response of the machine, shared supply, contour or vibration of an axis "
        "here");
  switch (spec.question) {
    case Question::margin: return margin_reference(subject, time_limit);
    case Question::delay: return delay_reference(subject, time_limit);
    case Question::design: return reference_of(exact_at_order(spec, time_limit, false));
  }
  return {};
}

}  // namespace accdec::comparison
