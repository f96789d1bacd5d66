#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/design/conflict.hpp>
#include <accdec/design/design.hpp>
#include <accdec/design/formulation.hpp>
#include <accdec/design/order_bound.hpp>
#include <accdec/design/verifier.hpp>
#include <accdec/motion/shapes.hpp>
#include <accdec/motion/smallest_delay.hpp>

namespace accdec {
namespace {

using Clock = std::chrono::steady_clock;

/// The search over N and integer d around the two smooth problems.
class Search {
 public:
  Search(const Task& task, const DesignOptions& options)
      : task_(task), options_(options), solver_(solvers::find_solver(options.solver)), began_(Clock::now()) {
    reduced_ = !solver_.capabilities().equality_rows;
    for (const TaskCorner& corner : task.corners) weight_ += corner.weight;
    for (std::size_t a = 0; a < task.machine.axes.size(); ++a) {
      for (const TaskCorner& corner : task.corners) {
        const auto i = static_cast<Eigen::Index>(a);
        coupled_ = coupled_ || corner.speed_min > 0.0 ||
                   corner.geometry.direction_in[i] * corner.geometry.direction_out[i] != 0.0;
      }
    }
  }

  /// Whether some order up to a few times the shortest start has a relaxed design, or a plain shape holds all limits: without limits on
  /// starting, the best filter passes the command through, which the relaxation's interpolation cannot express.
  bool has_relaxed_design() {
    for (const int order : {task_.design.order_min, task_.design.order_min + 1}) {
      if (order > task_.design.order_max) break;
      std::vector<double> pass_through(static_cast<std::size_t>(order) + 1, 0.0);
      pass_through[0] = 1.0;
      for (const Filter& filter : {Filter(pass_through), boxcar(order)}) {
        if (assess(task_, filter, rounded_up(guess_delays(filter), order), false).status == Status::feasible) return true;
      }
    }
    const int first = std::max(task_.design.order_min, order_lower_bound(task_, task_.design.order_max));
    const int last = std::min(task_.design.order_max, 3 * first + 30);
    for (int order = first; order <= last && !stopped(); order = std::max(order + 1, order + order / 3)) {
      if (relaxed(order)) return true;
    }
    return false;
  }

  DesignResult run() {
    const int first = std::max(task_.design.order_min, order_lower_bound(task_, task_.design.order_max));
    const int low = first > task_.design.order_max ? first : smallest_order(first);
    if (low <= task_.design.order_max) {
      const int best = best_order(low);
      // The relaxation differs from the integer problem by about a sample, so its neighbours get their chance too, nearest first.
      for (const int step : {0, 1, -1, 2, -2, 3, 4}) {
        const int order = best + step;
        if (order < low || order > task_.design.order_max || stopped()) continue;
        if (incumbent_ && optimistic_cost(order) >= incumbent_->cost) continue;
        integer_design(order);
      }
      // A relaxation that held but could not be rounded at its best order may be at a larger one.
      const int last = std::min(task_.design.order_max, 2 * best + 20);
      for (int order = best + 5; !incumbent_ && order <= last && !stopped(); order += 1 + order / 16) integer_design(order);
    }
    return finish();
  }

 private:
  struct Relaxed {
    double cost = 0.0;  // samples, weighted
    std::vector<double> delays, instants;
    std::optional<Filter> filter;
  };
  struct Candidate {
    double cost = 0.0;  // samples, weighted
    std::vector<int> delays;
    Filter filter;
  };

  bool stopped() const { return elapsed() > options_.time_limit || (options_.cancel != nullptr && options_.cancel->load()); }
  double elapsed() const { return std::chrono::duration<double>(Clock::now() - began_).count(); }

  void tell(const std::string& line) const {
    if (options_.progress) options_.progress(line);
  }

  solvers::Result solve(const nlp::Problem& problem, const std::vector<double>& start) {
    solvers::Options options = options_.solver_options;
    options.cancel = options_.cancel;
    options.time_limit = std::min(options.time_limit, std::max(0.01, options_.time_limit - elapsed()));
    solvers::Result result = solver_.solve(problem, start, options);
    evaluations_ += result.counts.objective;
    wall_time_ += result.wall_time;
    claimed_ = std::string(to_string(result.claim));
    last_message_ = result.message;
    if (result.claim == solvers::Claim::refused) throw std::invalid_argument(solver_.name() + ": " + result.message);
    return result;
  }

  static bool held(const solvers::Result& result) {
    return result.verification.verdict == solvers::Verdict::optimal || result.verification.verdict == solvers::Verdict::feasible;
  }

  /// A filter to start from: the trapezoid of this order, or the fastest start stretched to it.
  Filter guess(int order) const { return order < 2 ? boxcar(order) : trapezoid(order, order / 3); }

  std::vector<double> guess_delays(const Filter& filter) const {
    const DelayFinder smallest(filter);
    std::vector<double> delays;
    for (const TaskCorner& corner : task_.corners) {
      const double period = task_.sample_period;
      delays.push_back(corner.delay.value_or(
          corner.error_max ? smallest(corner.geometry.cos_interior(), corner.geometry.feed_in * period,
                                      corner.geometry.feed_out * period, *corner.error_max)
                           : 0));
    }
    return delays;
  }

  std::vector<int> rounded_up(const std::vector<double>& delays, int order) const {
    std::vector<int> integers;
    for (const double d : delays) integers.push_back(std::clamp(static_cast<int>(std::ceil(d - 1e-3)), 0, order + 1));
    for (std::size_t j = 0; j < delays.size(); ++j) {
      if (task_.corners[j].delay) integers[j] = *task_.corners[j].delay;
    }
    return integers;
  }

  FormulationOptions formulation(int order, std::vector<int> blend_delays) {
    FormulationOptions f;
    f.order = order;
    f.blend_delays = std::move(blend_delays);
    f.mode_frequencies = initial_frequencies(task_, order);
    for (std::size_t i = 0; i < extra_frequencies_.size(); ++i) {
      f.mode_frequencies[i].insert(f.mode_frequencies[i].end(), extra_frequencies_[i].begin(), extra_frequencies_[i].end());
    }
    f.reduced = reduced_;
    return f;
  }

  /// Adds the frequencies at which a filter breaks its bands. False when it breaks none.
  bool refine_bands(const Filter& filter) {
    bool added = false;
    extra_frequencies_.resize(task_.machine.modes.size());
    const std::vector<LimitUse> uses = vibration_utilisation(filter, task_.sample_period, task_.machine);
    for (std::size_t i = 0; i < uses.size(); ++i) {
      const Mode& mode = task_.machine.modes[i];
      if (uses[i].utilisation <= 1.0 || mode.frequency_low == mode.frequency_high) continue;
      const std::vector<double>& known = extra_frequencies_[i];
      const double apart = 1e-3 * (mode.frequency_high - mode.frequency_low);
      const bool old = std::any_of(known.begin(), known.end(), [&](double f) { return std::abs(f - uses[i].frequency) < apart; });
      if (old) continue;
      extra_frequencies_[i].push_back(uses[i].frequency);
      added = true;
    }
    return added;
  }

  /// Problem (b) at one order; nothing when it has no feasible point (or the solver finds none).
  const std::optional<Relaxed>& relaxed(int order) {
    const auto known = relaxed_.find(order);
    if (known != relaxed_.end()) return known->second;
    std::optional<Relaxed> best;
    bool consistent = true;
    Filter start = guess(order);
    std::vector<double> delays = guess_delays(start);
    for (int pass = 0; pass < 6 && !stopped(); ++pass) {
      const std::vector<int> blend = rounded_up(delays, order);
      const DelayProblem problem(task_, formulation(order, blend));
      const solvers::Result result = solve(problem, problem.start_from(start, delays));
      if (!held(result)) {
        best.reset();
        break;
      }
      Relaxed found{weight_ * (order + 1.0), problem.delays(result.x), problem.instants(result.x), filter_from(result.x, order)};
      for (std::size_t j = 0; j < task_.corners.size(); ++j) found.cost += task_.corners[j].weight * found.delays[j];
      start = *found.filter;
      delays = found.delays;
      const std::vector<int> next = rounded_up(delays, order);
      const bool moved = coupled_ && next != blend;
      // A step of one between passes is rounding; more means that the smallest speed holds at one delay and the error at another.
      consistent = true;
      for (std::size_t j = 0; j < next.size(); ++j) {
        consistent = consistent && (task_.corners[j].speed_min <= 0.0 || std::abs(next[j] - blend[j]) <= 1);
      }
      best = std::move(found);
      const bool refined = refine_bands(start);
      if (!refined && !moved) break;
    }
    if (!consistent) best.reset();
    tell(best ? fmt::format("N = {}: relaxed cycle time {:.3f} ms", order, best->cost * task_.sample_period * 1e3)
              : fmt::format("N = {}: no relaxed design", order));
    return relaxed_[order] = std::move(best);
  }

  double relaxed_cost(int order) {
    const auto& r = relaxed(order);
    return r ? r->cost : nlp::infinity;
  }

  double optimistic_cost(int order) {
    const auto& r = relaxed(order);
    if (!r) return nlp::infinity;
    double cost = weight_ * (order + 1.0);
    // The B-spline path keeps up to an eighth of a second difference farther off than the samples: at most about one sample of delay.
    for (std::size_t j = 0; j < task_.corners.size(); ++j) {
      cost += task_.corners[j].weight * std::max(0.0, std::ceil(r->delays[j] - 1.0));
    }
    return cost;
  }

  /// Smallest order from `first` on with a relaxed design: feasibility is monotone in N, for a zero tap can be appended.
  int smallest_order(int first) {
    const int last = task_.design.order_max;
    int low = first, step = 1;
    while (low <= last && !stopped() && !relaxed(low)) {
      if (low == last) return last + 1;
      low = std::min(last, low + step);
      step *= 2;
    }
    if (stopped() || low == first) return low;
    int bad = std::max(first, low - step / 2);
    while (low - bad > 1 && !stopped()) {
      const int middle = bad + (low - bad) / 2;
      (relaxed(middle) ? low : bad) = middle;
    }
    return low;
  }

  /// Order of least relaxed cost: N falls, the delays rise; the sum has one valley.
  int best_order(int low) {
    const auto ceiling = [&] { return static_cast<int>(std::min(best_relaxed_ / weight_, 1e9)); };
    const auto cost = [&](int order) {
      const double c = relaxed_cost(order);
      if (c < best_relaxed_) best_relaxed_ = c, best_order_ = order;
      return c;
    };
    cost(low);
    int a = low, b = low, step = 1;
    // Bracket by doubling, then narrow by thirds.
    while (b < task_.design.order_max && !stopped()) {
      const int next = std::min({task_.design.order_max, b + step, std::max(ceiling(), b)});
      if (next == b) break;
      const bool rising = cost(next) > cost(b);
      if (!rising) a = b;
      b = next;
      if (rising) break;
      step *= 2;
    }
    while (b - a > 2 && !stopped()) {
      const int left = a + (b - a) / 3, right = b - (b - a) / 3;
      (cost(left) <= cost(right) ? b : a) = cost(left) <= cost(right) ? right : left;
    }
    for (int order = a; order <= b && !stopped(); ++order) cost(order);
    return best_order_ < 0 ? low : best_order_;
  }

  /// Problem (a) at integer delays; a verified candidate or nothing. `sigma` receives (error/tolerance)^2, infinite when no point holds.
  std::optional<Filter> margin_design(int order, const std::vector<int>& delays, const Filter& start, std::vector<int> samples,
                                      double* sigma) {
    Filter from = start;
    std::optional<Filter> found;
    *sigma = nlp::infinity;
    for (int pass = 0; pass < 6 && !stopped(); ++pass) {
      const MarginProblem problem(task_, formulation(order, delays), samples);
      const solvers::Result result = solve(problem, problem.start_from(from));
      if (!held(result)) return std::nullopt;
      from = filter_from(result.x, order);
      found = from;
      *sigma = result.x[static_cast<std::size_t>(problem.sigma())];
      bool again = refine_bands(from);
      for (std::size_t j = 0; j < task_.corners.size(); ++j) {
        const int nearest = measure(Blend(from, task_.corners[j].geometry, delays[j], task_.sample_period)).corner_error_sample;
        if (task_.corners[j].error_max && nearest != samples[j]) {
          samples[j] = nearest;
          again = true;
        }
      }
      if (!again) break;
    }
    return found;
  }

  void integer_design(int order) {
    const auto& r = relaxed(order);
    if (!r) return;
    std::vector<int> delays = rounded_up(r->delays, order);
    std::vector<int> samples;
    for (std::size_t j = 0; j < delays.size(); ++j) {
      const double t = r->instants[j] + delays[j] - r->delays[j];
      samples.push_back(r->instants[j] < 0.0 ? (order + delays[j]) / 2 : static_cast<int>(std::lround(t - 0.5)));
    }
    bool ok = attempt(order, delays, samples, *r->filter);
    // Repair: lengthen the delay of the corner with the largest error use, until all hold or the legs part.
    for (int tries = 0; !ok && tries < 12 && !stopped(); ++tries) {
      if (!lengthen(delays, order)) break;
      ok = attempt(order, delays, samples, *r->filter);
    }
    if (!ok) return;
    // And shorten while that works, the heaviest corner first.
    std::vector<std::size_t> by_weight(delays.size());
    for (std::size_t j = 0; j < by_weight.size(); ++j) by_weight[j] = j;
    std::stable_sort(by_weight.begin(), by_weight.end(),
                     [&](std::size_t i, std::size_t j) { return task_.corners[i].weight > task_.corners[j].weight; });
    for (const std::size_t j : by_weight) {
      if (task_.corners[j].delay) continue;
      while (delays[j] > 0 && !stopped()) {
        --delays[j];
        if (!attempt(order, delays, samples, *r->filter)) {
          ++delays[j];
          break;
        }
      }
    }
  }

  bool lengthen(std::vector<int>& delays, int order) const {
    std::optional<std::size_t> worst;
    for (std::size_t j = 0; j < delays.size(); ++j) {
      if (task_.corners[j].delay || !task_.corners[j].error_max || delays[j] > order) continue;
      if (!worst || last_error_use_[j] > last_error_use_[*worst]) worst = j;
    }
    if (!worst) return false;
    ++delays[*worst];
    return true;
  }

  bool attempt(int order, const std::vector<int>& delays, const std::vector<int>& samples, const Filter& start) {
    double sigma = 0.0;
    const std::optional<Filter> filter = margin_design(order, delays, start, samples, &sigma);
    last_error_use_.assign(delays.size(), 0.0);
    if (!filter) return false;
    for (std::size_t j = 0; j < delays.size(); ++j) {
      const TaskCorner& corner = task_.corners[j];
      if (!corner.error_max) continue;
      last_error_use_[j] = utilisation_of(
          LimitKind::corner_error, corner_error(Blend(*filter, corner.geometry, delays[j], task_.sample_period)), *corner.error_max);
    }
    DesignResult result = assess(task_, *filter, delays, false);
    if (result.status != Status::feasible) {
      last_message_ = result.message;
      return false;
    }
    const double cost = result.cycle_time / task_.sample_period;
    if (!incumbent_ || cost < incumbent_->cost - 1e-9) {
      incumbent_ = Candidate{cost, delays, *filter};
      tell(fmt::format("N = {}: verified cycle time {:.3f} ms", order, result.cycle_time * 1e3));
    }
    return true;
  }

  DesignResult finish() {
    DesignResult result;
    if (incumbent_) {
      result = assess(task_, incumbent_->filter, incumbent_->delays, false);
      if (stopped()) result.message = "stopped early; the best verified design so far";
    } else {
      result.task = task_;
      result.status = Status::failed;
      result.message = stopped() ? "stopped before a verified design was found" : no_design();
    }
    result.solver = {"nlp", solver_.name(), solver_.library_version(), claimed_, static_cast<long>(evaluations_), wall_time_};
    return result;
  }

  /// Why there is no design, as far as a local solver can tell: the limits without any one of which it finds one.
  std::string no_design() const {
    std::string message = fmt::format("{} found no design up to order {}", solver_.name(), task_.design.order_max);
    DesignOptions quiet = options_;
    quiet.progress = nullptr;
    quiet.time_limit = std::max(0.1, options_.time_limit - elapsed());
    const auto has_design = [&](const Task& task) { return Search(task, quiet).has_relaxed_design(); };
    const std::vector<std::string> conflict = limits_in_conflict(task_, has_design);
    if (!conflict.empty()) message += fmt::format("; limits in conflict (by local search, not proved): {}", fmt::join(conflict, ", "));
    if (!last_message_.empty()) message += "; last: " + last_message_;
    return message;
  }

  const Task& task_;
  const DesignOptions& options_;
  const solvers::Solver& solver_;
  Clock::time_point began_;
  bool reduced_ = false, coupled_ = false;
  double weight_ = 0.0;
  std::map<int, std::optional<Relaxed>> relaxed_;
  std::vector<std::vector<double>> extra_frequencies_;
  std::optional<Candidate> incumbent_;
  std::vector<double> last_error_use_;
  double best_relaxed_ = nlp::infinity;
  int best_order_ = -1;
  std::int64_t evaluations_ = 0;
  double wall_time_ = 0.0;
  std::string claimed_, last_message_;
};

}  // namespace

DesignResult design_nlp(const Task& task, const DesignOptions& options) { return Search(task, options).run(); }

}  // namespace accdec
