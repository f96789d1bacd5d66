#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/corner.hpp>
#include <accdec/design/fixed_order.hpp>
#include <accdec/filter.hpp>
#include <accdec/machine/blend_behind.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/task/objective.hpp>

namespace accdec {
namespace {

/// Whether the point holds all rows, by the verifier.
bool held(const solvers::Result& result) {
  return result.verification.verdict == solvers::Verdict::optimal ||
         result.verification.verdict == solvers::Verdict::feasible;
}

/// The same, and found by the solver: a start that is returned unchanged does not count.
bool own(const solvers::Result& result, const std::vector<double>& start) {
  if (result.verification.verdict == solvers::Verdict::optimal) return true;
  const bool claimed = result.claim == solvers::Claim::solved || result.claim == solvers::Claim::acceptable;
  return held(result) && (claimed || result.x != start);
}

/// The machine with the slowest servo for all axes, without negative taps.
Machine one_servo(const Task& task) {
  Machine machine = task.machine;
  give_slowest_servo(machine, task.sample_period);
  for (Axis& axis : machine.axes) axis = averaging(axis);
  return machine;
}

/// The start: the trapezoid of this order, with a third of it for each ramp.
Filter guess(int order) {
  return order < 2 ? boxcar(order) : trapezoid(order, order / 3);
}

}  // namespace

std::string step_too_long(const Task& task, int order, double time_limit) {
  constexpr double seconds_an_entry = 1e-6;
  double limits = 0.0;  // of all axes
  for (const Axis& axis : task.machine.axes) {
    for (const AxisLimit& limit : axis_limits) limits += axis.*limit.bound < unlimited ? 1.0 : 0.0;
  }
  // Each corner has two leg distances over all taps, and three neighbours per sample and limit of the blend.
  const double n = order + Response(task.machine, task.sample_period).order() + 1.0,
               corners = static_cast<double>(task.corners.size());
  const double entries = corners * (2.0 * n + 3.0 * 1.5 * n * limits);
  // Exchanged pivots fill the factors in, more so with more corners. At order 19 a factorisation took up to 0.15 s with
  // 200 corners and 2 s with 600.
  constexpr double corners_that_double = 120.0;
  const double seconds = seconds_an_entry * entries * (1.0 + corners / corners_that_double);
  if (seconds <= 0.5 + 0.05 * time_limit) return "";
  return fmt::format(
      "a step of a local solver on {} corners at order {} takes about {:.2g} s, too long for a time limit of {:.3g} s",
      task.corners.size(), order, seconds, time_limit);
}

FixedOrderDesigner::FixedOrderDesigner(const Task& task, const DesignOptions& options)
    : task_(task),
      options_(options),
      solver_(solvers::find_solver(options.nlp.solver)),
      response_(one_servo(task), task.sample_period) {
  reduced_ = options.nlp.reduced.value_or(false) || !solver_.capabilities().equality_rows;
  filter_cost_ = cost_of(task).filter;
  for (const TaskCorner& corner : task.corners) {
    const auto& in = corner.geometry().direction_in;
    const auto& out = corner.geometry().direction_out;
    coupled_ = coupled_ || corner.speed_min > 0.0 || (in.array() * out.array() != 0.0).any();
  }
}

double FixedOrderDesigner::lag() const {
  const Filter response = motion(Filter({1.0}));
  return response.mean_delay() - response.first_nonzero_tap();
}

solvers::Result FixedOrderDesigner::solve(const nlp::Problem& problem, const std::vector<double>& start) {
  solvers::Options options = options_.nlp.options;
  options.cancel = options_.cancel;
  options.time_limit = std::min(options.time_limit, std::max(0.01, options_.time_limit - elapsed()));
  solvers::Result result = solver_.solve(problem, start, options);
  counts_ += result.counts;
  wall_time_ += result.wall_time;
  claimed_ = std::string(to_string(result.claim));
  last_message_ = result.message;
  if (result.claim == solvers::Claim::refused) throw SolverRefuses(solver_.name() + ": " + result.message);
  return result;
}

std::vector<double> FixedOrderDesigner::guess_delays(const Filter& filter) const {
  const DelayFinder smallest(motion(filter));
  std::vector<double> delays;
  for (const TaskCorner& corner : task_.corners) {
    const double period = task_.sample_period;
    delays.push_back(corner.delay.value_or(
        corner.error_max ? smallest(corner.geometry().cos_interior(), corner.geometry().feed_in * period,
                                    corner.geometry().feed_out * period, *corner.error_max)
                         : 0));
  }
  return delays;
}

std::vector<int> FixedOrderDesigner::rounded_up(const std::vector<double>& delays, int order) const {
  std::vector<int> integers;
  for (const double d : delays)
    integers.push_back(std::clamp(static_cast<int>(std::ceil(d - 1e-3)), 0, order + response_.order() + settling));
  for (std::size_t j = 0; j < delays.size(); ++j) {
    if (task_.corners[j].delay) integers[j] = *task_.corners[j].delay;
  }
  return integers;
}

std::vector<int> FixedOrderDesigner::parting_delays(int order) const {
  return rounded_up(std::vector<double>(task_.corners.size(), order + response_.order() + settling), order);
}

FormulationOptions FixedOrderDesigner::formulation(int order, std::vector<int> blend_delays) {
  FormulationOptions f;
  f.order = order;
  f.blend_delays = std::move(blend_delays);
  f.mode_frequencies = initial_frequencies(task_, order);
  for (std::size_t i = 0; i < extra_frequencies_.size(); ++i) {
    f.mode_frequencies[i].insert(f.mode_frequencies[i].end(), extra_frequencies_[i].begin(),
                                 extra_frequencies_[i].end());
  }
  f.reduced = reduced_;
  f.stop = [this] { return stopped(); };
  return f;
}

LimitUse FixedOrderDesigner::worst_residual(const Filter& command, const Mode& mode,
                                            const std::vector<int>& delays) const {
  LimitUse worst = residual_utilisation(command, 0.0, fastest_leg(task_, mode.axis), 0, task_.sample_period, mode);
  for (std::size_t j = 0; j < delays.size(); ++j) {
    const Corner& g = task_.corners[j].geometry();
    const double in = g.feed_in * g.direction_in[mode.axis], out = g.feed_out * g.direction_out[mode.axis];
    if (in == 0.0 || out == 0.0) continue;
    LimitUse use = residual_utilisation(command, in, out, delays[j], task_.sample_period, mode);
    if (use.utilisation > worst.utilisation) worst = use;
  }
  return worst;
}

bool FixedOrderDesigner::refine_bands(const Filter& filter, const std::vector<int>& delays) {
  bool added = false;
  extra_frequencies_.resize(task_.machine.modes.size());
  const Filter command = response_.command(filter);
  const std::vector<LimitUse> uses = vibration_utilisation(command, task_.sample_period, task_.machine);
  std::size_t next = 0;
  for (std::size_t i = 0; i < task_.machine.modes.size(); ++i) {
    const Mode& mode = task_.machine.modes[i];
    const LimitUse use = mode.of_axis() ? worst_residual(command, mode, delays) : uses[next++];
    if (use.utilisation <= 1.0 || mode.frequency_low == mode.frequency_high) continue;
    const std::vector<double>& known = extra_frequencies_[i];
    const double apart = 1e-3 * (mode.frequency_high - mode.frequency_low);
    const bool old =
        std::any_of(known.begin(), known.end(), [&](double f) { return std::abs(f - use.frequency) < apart; });
    if (old) continue;
    extra_frequencies_[i].push_back(use.frequency);
    added = true;
  }
  return added;
}

const std::optional<FixedOrderDesigner::Relaxed>& FixedOrderDesigner::relaxed(int order) {
  const auto known = relaxed_.find(order);
  if (known != relaxed_.end()) return known->second;
  std::optional<Relaxed> best = relax(order);
  tell(best ? fmt::format("N = {}: relaxed cycle time {:.3f} ms", order, best->cost * task_.sample_period * 1e3)
            : fmt::format("N = {}: no relaxed design", order));
  return relaxed_[order] = std::move(best);
}

std::optional<FixedOrderDesigner::Relaxed> FixedOrderDesigner::relax(int order) {
  std::optional<Relaxed> best;
  try {
    relax(order, best);
  } catch (const BuildStopped&) {  // the best so far remains
  }
  return best;
}

void FixedOrderDesigner::relax(int order, std::optional<Relaxed>& best) {
  bool consistent = true, parted = false;
  Filter start = options_.nlp.start && options_.nlp.start->order() == order ? *options_.nlp.start : guess(order);
  std::vector<double> delays = guess_delays(start);
  for (int pass = 0; pass < 8 && !stopped(); ++pass) {
    // When the legs do not overlap, a blend is a stop and a start: its limits cannot be looser.
    const std::vector<int> blend = parted ? parting_delays(order) : rounded_up(delays, order);
    const DelayProblem problem(task_, formulation(order, blend));
    const solvers::Result result = solve(problem, problem.start_from(start, delays));
    // A relaxation only guides the search, so a start that holds is good enough.
    if (!held(result)) {
      // The delays that the errors alone need, found with parted legs, were an attempt. The earlier point that held
      // still guides the search.
      if (best && (best->parted || parted)) break;
      if (!coupled_ || parted) {
        best.reset();
        return;
      }
      parted = true;
      continue;
    }
    Relaxed next_relaxed{filter_cost_ * (order + 1.0), problem.delays(result.x), problem.instants(result.x),
                         filter_from(result.x, order), parted};
    for (std::size_t j = 0; j < task_.corners.size(); ++j) {
      next_relaxed.cost += task_.corners[j].weight * (parted ? blend[j] : next_relaxed.delays[j]);
    }
    start = *next_relaxed.filter;
    delays = next_relaxed.delays;
    const std::vector<int> next = rounded_up(delays, order);
    const bool moved = coupled_ && next != blend;
    // A step of one between passes is rounding. A larger one means that the smallest speed and the error hold at
    // different delays.
    consistent = true;
    for (std::size_t j = 0; j < next.size(); ++j) {
      consistent = consistent && (task_.corners[j].speed_min <= 0.0 || std::abs(next[j] - blend[j]) <= 1);
    }
    if (best && best->parted && parted) break;  // parted a second time: overlaps come and go
    best = std::move(next_relaxed);
    const bool refined = refine_bands(start);
    if (!refined && !moved) break;
    parted = false;
  }
  if (!consistent) best.reset();
}

std::vector<double> FixedOrderDesigner::contour_times(const Filter& filter, const std::vector<int>& delays) const {
  std::vector<double> times;
  for (std::size_t j = 0; j < delays.size(); ++j)
    times.push_back(contour_time(motion(filter), task_.corners[j].geometry(), delays[j]));
  return times;
}

int FixedOrderDesigner::nearest_sample(const Filter& filter, std::size_t corner, int delay) const {
  const Corner& g = task_.corners[corner].geometry();
  return measure(FilterBehind(filter, task_.machine, task_.sample_period), g, delay, task_.sample_period)
      .corner_error_sample;
}

std::optional<Filter> FixedOrderDesigner::largest_margin(int order, const std::vector<int>& delays, const Filter& start,
                                                         std::vector<int> samples) {
  std::optional<Filter> found;
  try {
    enlarge_margin(order, delays, start, std::move(samples), found);
  } catch (const BuildStopped&) {  // the last one found remains
  }
  return found;
}

void FixedOrderDesigner::enlarge_margin(int order, const std::vector<int>& delays, Filter from,
                                        std::vector<int> samples, std::optional<Filter>& found) {
  for (int pass = 0; pass < 6 && !stopped(); ++pass) {
    FormulationOptions options = formulation(order, delays);
    options.contour_times = contour_times(from, delays);
    options.mode_blends = true;
    const MarginProblem problem(task_, options, samples);
    const std::vector<double> point = problem.start_from(from);
    const solvers::Result result = solve(problem, point);
    if (!own(result, point)) {
      found.reset();
      return;
    }
    from = filter_from(result.x, order);
    found = from;
    bool again = refine_bands(from, delays);
    const std::vector<double> times = contour_times(from, delays);
    for (std::size_t j = 0; j < times.size(); ++j)
      again = again || (task_.corners[j].contour_max && std::abs(times[j] - options.contour_times[j]) > 0.1);
    for (std::size_t j = 0; j < task_.corners.size(); ++j) {
      const int nearest = nearest_sample(from, j, delays[j]);
      if (task_.corners[j].error_max && nearest != samples[j]) {
        samples[j] = nearest;
        again = true;
      }
    }
    if (!again) break;
  }
}

SolverReport FixedOrderDesigner::report() const {
  return {"nlp",      solver_.name(), solver_.library_version(), claimed_, static_cast<long>(counts_.objective),
          wall_time_, counts_};
}

}  // namespace accdec
