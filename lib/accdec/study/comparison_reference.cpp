#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include <accdec/design/exact/exact.hpp>
#include <accdec/design/exact/relaxation.hpp>
#include <accdec/design/limit_rows.hpp>
#include <accdec/design/order_bound.hpp>
#include <accdec/study/comparison_case.hpp>

namespace accdec::study {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
/// Relative to max(1, objective): where bisection stops.
constexpr double accuracy = 1e-6;

bool convex(const Task& task) {
  const auto& axes = task.machine.axes;
  return std::all_of(axes.begin(), axes.end(), [](const Axis& a) { return a.power_max >= unlimited && a.regeneration_max >= unlimited; }) &&
         std::all_of(task.corners.begin(), task.corners.end(), [](const TaskCorner& c) { return c.speed_min <= 0.0; });
}

/// The task with its bands as the frequencies the formulations impose them at.
Task with_frequencies(const CaseSpec& spec) {
  Task task = spec.task;
  task.machine.modes.clear();
  const auto frequencies = initial_frequencies(spec.task, spec.order);
  for (std::size_t m = 0; m < frequencies.size(); ++m) {
    for (const double f : frequencies[m]) {
      Mode mode = spec.task.machine.modes[m];
      mode.frequency_low = mode.frequency_high = f;
      task.machine.modes.push_back(mode);
    }
  }
  return task;
}

/// The convex limits at fixed order, delays and samples, with every tolerance times `scale`; infinite: without them.
exact::Outcome solve(Task task, const CaseSpec& spec, const std::vector<int>& delays, const std::vector<int>& samples, double scale) {
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
  for (std::size_t j = 0; j < task.corners.size(); ++j) box.corners.push_back({delays[j], delays[j], samples[j], samples[j]});
  return relaxation.solve(box, spec.task.design.symmetric);
}

/// sigma of MarginProblem for a filter.
double margin_of(const Task& task, const Filter& filter, const std::vector<int>& delays, const std::vector<int>& samples) {
  double worst = 0.0;
  for (std::size_t j = 0; j < task.corners.size(); ++j) {
    const TaskCorner& corner = task.corners[j];
    if (!corner.error_max || *corner.error_max == 0.0) continue;
    const double p = corner.geometry.feed_in * task.sample_period / *corner.error_max * filter.remaining_moment(samples[j]);
    const double q = corner.geometry.feed_out * task.sample_period / *corner.error_max * filter.elapsed_moment(samples[j] - delays[j]);
    worst = std::max(worst, p * p + q * q + 2.0 * corner.geometry.cos_interior() * p * q);
  }
  return worst;
}

Reference infeasible(std::string method) { return {Reference::Proof::infeasible, infinity, infinity, std::move(method)}; }

/// Proof of infeasibility that needs no tolerance, or a filter that holds the convex limits.
std::optional<Reference> no_filter_at_all(const Task& task, const CaseSpec& spec, const std::vector<int>& delays, const std::vector<int>& samples,
                                          std::optional<Filter>& filter) {
  if (order_lower_bound(spec.task, spec.order) > spec.order) return infeasible("fastest start within the limits takes a larger order");
  const exact::Outcome outcome = solve(task, spec, delays, samples, infinity);
  if (outcome.kind == exact::Outcome::refuted) return infeasible("linear programme refuted by its dual multipliers");
  if (outcome.kind == exact::Outcome::feasible) filter = outcome.filter;
  return std::nullopt;
}

Reference margin_reference(const CaseSpec& spec, const std::vector<int>& samples, double time_limit) {
  const auto began = std::chrono::steady_clock::now();
  const auto late = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count() > time_limit; };
  const Task task = with_frequencies(spec);
  std::optional<Filter> filter;
  if (const auto none = no_filter_at_all(task, spec, spec.delays, samples, filter)) return *none;
  Reference reference{Reference::Proof::bound, 0.0, infinity, ""};
  if (filter) reference.upper = margin_of(task, *filter, spec.delays, samples);
  while (filter && reference.upper - reference.lower > accuracy * std::max(1.0, reference.upper) && !late()) {
    // In the error, not its square: far above the optimum that halves faster.
    const double scale = 0.5 * (std::sqrt(reference.lower) + std::sqrt(reference.upper));
    const exact::Outcome outcome = solve(task, spec, spec.delays, samples, scale);
    if (outcome.kind == exact::Outcome::refuted) {
      reference.lower = scale * scale;
    } else if (outcome.kind == exact::Outcome::feasible) {
      reference.upper = std::min(scale * scale, margin_of(task, *outcome.filter, spec.delays, samples));
    } else {
      break;  // rounding decides: what is proved so far stays
    }
  }
  const bool closed = reference.upper - reference.lower <= 10.0 * accuracy * std::max(1.0, reference.upper);
  if (closed && convex(task)) {
    reference.proof = Reference::Proof::optimal;
    reference.method = "exact: bisection with refuting linear programmes";
  } else {
    reference.upper = infinity;
    reference.method = convex(task) ? "exact bound, bisection not finished" : "exact bound without power, regeneration and smallest speed";
  }
  return reference;
}

Reference delay_reference(const CaseSpec& spec, const std::vector<int>& delays, const std::vector<int>& samples) {
  std::optional<Filter> filter;
  if (const auto none = no_filter_at_all(with_frequencies(spec), spec, delays, samples, filter)) return *none;
  return {Reference::Proof::bound, 0.0, infinity, "delays are not negative"};
}

Reference design_reference(const CaseSpec& spec, double time_limit) {
  ExactOptions options;
  options.time_limit = time_limit;
  options.certificate = false;
  Task task = spec.task;
  task.design.order_min = task.design.order_max = spec.order;
  const DesignResult result = design_exact(task, options);
  if (result.status == Status::infeasible) return infeasible("exact: " + result.message);
  const double period = task.sample_period;
  Reference reference{Reference::Proof::bound, result.lower_bound.value_or(0.0) / period, infinity, "exact bound"};
  if (result.status != Status::optimal) return reference;
  reference.proof = Reference::Proof::optimal;
  reference.lower = reference.upper = result.cycle_time / period;
  reference.method = "exact design at this order";
  return reference;
}

}  // namespace

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
  switch (spec.question) {
    case Question::margin: return margin_reference(spec, subject.samples(), time_limit);
    case Question::delay: return delay_reference(spec, subject.blend_delays(), std::vector<int>(spec.task.corners.size(), 0));
    case Question::design: return design_reference(spec, time_limit);
  }
  return {};
}

}  // namespace accdec::study
