#include <algorithm>
#include <chrono>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include <accdec/certificate.hpp>
#include <accdec/design/anytime.hpp>
#include <accdec/design/coarse_design.hpp>
#include <accdec/design/covered_part.hpp>
#include <accdec/design/fixed_order.hpp>
#include <accdec/design/larger_order.hpp>
#include <accdec/design/merged_result.hpp>
#include <accdec/design/smoothed_bound.hpp>
#include <accdec/design/standard_shapes.hpp>
#include <accdec/design/supply_start.hpp>
#include <accdec/exact/exact_run.hpp>
#include <accdec/exact/size.hpp>
#include <accdec/family.hpp>
#include <accdec/files.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/task/conflict.hpp>
#include <accdec/task/convexity.hpp>
#include <accdec/task/equal_corners.hpp>
#include <accdec/task/order_bound.hpp>
#include <accdec/task/symmetry.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// Up to this order slsqp, which is dense, is faster than ipopt.
constexpr int dense_order_max = 150;

/// The task without the limits that make the set of filters non-convex; without its modes if there are none such. With
/// many taps, the linear programs of modes are the slowest.
Task easier_part(Task task) {
  if (is_convex(task)) task.machine.modes.clear();
  for (Axis& axis : task.machine.axes) axis.power_max = axis.regeneration_max = unlimited;
  task.machine.power_total_max = task.machine.regeneration_total_max = unlimited;
  for (TaskCorner& corner : task.corners) corner.speed_min = 0.0;
  return task;
}

/// One design by all methods, each with its share of the time limit.
class Anytime {
 public:
  Anytime(const Task& task, const DesignOptions& options) : task_(task), options_(options), exact_run_(task) {}

  DesignResult run() {
    const bool convex = is_convex(task_);
    const bool several = task_.corners.size() > 1;
    // Shares of the time limit, tried on the shipped and random tasks. The proof of a single corner is usually short,
    // and otherwise other methods add little. With several corners, or limits that are not convex, a good design
    // shortens the proof that continues from it.
    coarse(0.2);  // of filters of many taps only
    exact(several ? 0.2 : convex ? 0.9 : 0.3);
    if (settled() || close_enough()) return *exact_;
    if (!has_bound() && !(convex && task_.machine.modes.empty())) bound_of_part(easier_part(task_), 0.1);
    // A very quiet filter is usually found only by a window made for it, and then at once.
    if (!exact_->has_design()) shapes(0.1);
    // Free taps reach all that a control's own filters reach.
    families(0.2);
    const double share = several ? 0.35 : 0.2;
    const bool dense = several && task_.design.order_min <= dense_order_max;
    if (dense) local("nlopt-slsqp", 0.4 * share);
    // A proof this close to its end soon finds what a second solver could find.
    if (!dense || !exact_->gap || *exact_->gap > 0.05) local(options_.nlp.solver, share);
    if (several || !convex || !exact_->has_design()) exact(1.0);
    if (settled()) return *exact_;
    return finish();
  }

  /// For tasks with limits that the exact method does not know.
  DesignResult run_in_part() {
    exact_ = DesignResult();
    const bool ideal = Response(task_.machine, task_.sample_period).ideal();
    // Bounds of the order do not see a shared supply. A first design does, and the local solvers need many times as
    // long for many taps.
    const bool supply = limits_supply(task_.machine);
    if (!supply) coarse(0.1);
    if (auto start = supply_start(task_, options_, std::min(0.3 * options_.time_limit, left())))
      offer_design(std::move(*start));
    else
      shapes(ideal ? 0.1 : 0.4);
    if (supply) coarse(0.3, best_ ? best_->filter->order() : 0);
    linear_part(0.2);
    const bool finished = bound_of_part(covered_part(filter_with_smoothing(task_)), ideal ? 0.4 : 0.6);
    judge();
    const std::string of_what = what_bound(task_, bound_ ? bound_->certificate.get() : nullptr, finished);
    // A part that has no design names the limits in conflict.
    if (exact_->status != Status::infeasible)
      exact_->message = of_what;
    else if (!task_.machine.prefilter_taps.empty())
      exact_->message += "; " + of_what;
    if (settled()) return *exact_;
    if (best_ && best_->status == Status::optimal) return finish();
    families(1.0);
    local("nlopt-slsqp", 0.3);
    local(options_.nlp.solver, 1.0);
    if (over()) exact_->stop = left() <= 0.0 ? StopReason::time_limit : StopReason::interrupted;
    return finish();
  }

  /// For tasks whose linear programs of the exact method are too large.
  DesignResult run_without_linear_programs(const std::string& why) {
    exact_ = DesignResult();
    exact_->message = why;
    // Beyond these orders a single step of a local solver may take longer than the time limit leaves.
    const int most = task_.design.order_max;
    const int least = std::min(most, std::max(task_.design.order_min, order_lower_bound(task_, most)));
    const bool small = task_.corners.size() <= 100 && least <= 10'000;
    if (small) coarse(0.2);
    shapes(small ? 0.4 : 1.0);
    if (small) local(options_.nlp.solver, 1.0);
    return finish();
  }

  double left() const { return options_.time_limit - seconds_since(began_); }

 private:
  using Clock = std::chrono::steady_clock;
  bool over() const { return left() <= 0.0 || (options_.cancel != nullptr && options_.cancel->load()); }
  bool settled() const { return exact_->status == Status::optimal || exact_->status == Status::infeasible; }
  bool has_bound() const { return exact_->lower_bound || bound_; }
  bool close_enough() const {
    return options_.exact.gap > 0.0 && exact_ && exact_->gap && *exact_->gap <= options_.exact.gap;
  }
  void tell(const std::string& line) const {
    if (options_.progress) options_.progress(line);
  }

  void exact(double share) {
    if (exact_ && (over() || close_enough())) return;
    ExactOptions exact = exact_options(options_, std::min(share * options_.time_limit, left()));
    if (best_) exact.start = best_->filter;
    if (options_.progress) {
      exact.progress = [this](const ExactProgress& p) {
        // The bound of parts without designs is infinite: there is no news before it is finite.
        if (!(p.bound < unlimited)) return;
        const std::string bound = fmt::format("bound {:.3f} ms", p.bound * 1e3);
        tell(p.incumbent < unlimited
                 ? fmt::format("{}, best {:.3f} ms, gap {:.1f} %", bound, p.incumbent * 1e3, 100.0 * p.gap)
                 : bound + ", no design yet");
      };
    }
    DesignResult result = exact_run_.go_on(exact);
    if (options_.exact.certificate && !result.certificate) {
      // Stopped before anything was proved: a bound that nobody can check is no bound.
      result.lower_bound.reset();
      result.gap.reset();
    }
    if (exact_) {
      offer_bound(*exact_);
      if (exact_->has_design()) offer_design(*exact_);
    }
    exact_ = std::move(result);
  }

  void local(const std::string& solver, double share) {
    if (over() || close_enough()) return;
    // In less time local solvers find nothing, least where corners share a filter, and the exact method needs the time.
    const double least = task_.corners.size() > 1 ? 0.5 : 0.2;
    if (exact_->has_design() && share * options_.time_limit < least) return;
    DesignOptions options = options_;
    options.method = Method::nlp;
    options.nlp.solver = solver;
    if (solver != options_.nlp.solver) options.nlp.options.native.clear();
    options.time_limit = std::min(share * options_.time_limit, left());
    tell(fmt::format("looking for a design with {} for at most {:.2g} s", solver, options.time_limit));
    DesignResult result;
    try {
      result = design_nlp(task_, options);
    } catch (const SolverRefuses& why) {
      result.message = why.what();
    }
    if (!result.has_design()) {
      // Nothing is proved and nothing found: but the local search knows which limits conflict.
      if (result.stop == StopReason::finished) local_message_ = result.message;  // its own stop is no news
      return;
    }
    if (!exact_ || !exact_->has_design() || result.objective() < exact_->objective()) offer_design(std::move(result));
  }

  /// @param known_order  see coarse_design
  void coarse(double share, int known_order = 0) {
    if (over()) return;
    if (auto result = coarse_design(task_, options_, std::min(share * options_.time_limit, left()), known_order))
      offer_design(std::move(*result));
  }

  void shapes(double share) {
    if (over()) return;
    if (auto result = best_standard_shape(task_, std::min(share * options_.time_limit, left()), options_.cancel))
      offer_design(std::move(*result));
  }

  /// If nothing better may follow, at least the filters that controls have are searched in earnest.
  void families(double share) {
    if (over() || task_.filter) return;
    constexpr double most = 2.0;  // s; the two-stage averages take a few ms
    const double seconds = std::min({most, share * options_.time_limit, left()});
    for (FamilyResult& member : best_members(task_, seconds, options_.cancel)) {
      if (!member.spec || !member.result.has_design()) continue;
      DesignResult found = std::move(member.result);
      found.task = task_;
      found.solver.method = "shapes", found.solver.name = "family search", found.solver.version = "accdec";
      offer_design(std::move(found));
    }
  }

  /// In front of a control's smoothing only linear limits are known. Without one the covered part has more.
  void linear_part(double share) {
    if (task_.machine.prefilter_taps.empty()) return;
    Task part = easier_part(task_);
    part.machine.modes = task_.machine.modes;
    if (exact_covers(part)) bound_of_part(part, share);
  }

  /// A bound without power, regeneration and smallest speed also holds with them.
  /// @return whether the proof of the part was finished
  bool bound_of_part(const Task& part, double share) {
    if (over() || !options_.exact.certificate) return false;
    ExactOptions exact = exact_options(options_, std::min(share * options_.time_limit, left()));
    exact.gap = 0.0;
    DesignResult found = design_exact(part, exact);
    const bool finished = found.status == Status::optimal || found.status == Status::infeasible;
    const auto late = [this] { return over(); };
    const bool smooths = !task_.machine.prefilter_taps.empty();
    if (found.has_design() && smooths) {
      if (auto whole = in_front_of_smoothing(task_, *found.filter, late); whole && whole->has_design())
        whole->solver = found.solver, offer_design(*std::move(whole));
    } else if (found.has_design() && !exact_covers(task_)) {
      std::vector<int> delays;
      for (const CornerResult& corner : found.corners) delays.push_back(corner.delay);
      DesignResult whole = assess(task_, *found.filter, delays, false);
      whole.solver = found.solver;
      if (whole.has_design()) offer_design(std::move(whole));
    }
    if (smooths && part.machine.prefilter_taps.empty()) found = without_smoothing(task_, std::move(found));
    if (!found.certificate) return finished;
    if (found.status == Status::infeasible && !exact_covers(task_)) {
      found.task = task_;
      if (check_certificate(task_, found, late).accepted) exact_ = std::move(found);
      return finished;
    }
    if (!found.lower_bound) return finished;
    found.task = task_;
    found.status = Status::feasible;
    if (check_certificate(task_, found, late).accepted) offer_bound(found);
    return finished;
  }

  /// Whether the best design is as short as the bound.
  void judge() {
    if (!best_ || !bound_ || !bound_->lower_bound) return;
    if (best_->objective() * (1.0 - 1e-9) <= *bound_->lower_bound) best_->status = Status::optimal;
  }
  void offer_bound(const DesignResult& found) {
    if (!found.lower_bound) return;
    if (!bound_ || *found.lower_bound > *bound_->lower_bound) bound_ = found;
  }
  /// Families have shapes that are not symmetric.
  void offer_design(DesignResult found) {
    if (found.has_design() && !symmetric_as_asked(task_, *found.filter)) return;
    if (!best_ || found.objective() < best_->objective()) best_ = std::move(found);
  }

  /// The best design with the highest bound.
  DesignResult finish() {
    // With very many corners, copying takes as long as searching.
    DesignResult exact = std::move(*exact_), result;
    if (best_ && (!exact.has_design() || best_->objective() <= exact.objective())) {
      result = std::move(*best_);
      const SolverReport& prover = exact.solver;
      if (result.solver.method == "exact") {
        result.solver = prover;
      } else {
        result.solver.name = prover.name.empty() ? result.solver.name : prover.name + "+" + result.solver.name;
        result.solver.version =
            prover.version.empty() ? result.solver.version : prover.version + ", " + result.solver.version;
        result.solver.evaluations += prover.evaluations;
      }
      result.solver.method = "exact";
      result.status = Status::feasible;
      result.message = exact.has_design() ? exact.message : "not proved shortest: " + exact.message;
      result.stop = exact.stop;
      result.lower_bound = exact.lower_bound, result.certificate = exact.certificate;
    } else {
      result = std::move(exact);
    }
    if (bound_ && (!result.lower_bound || *bound_->lower_bound > *result.lower_bound)) {
      result.lower_bound = bound_->lower_bound;
      result.certificate = bound_->certificate;
    }
    result.solver.wall_time = options_.time_limit - left();
    if (!result.has_design()) {
      result.task = task_;
      if (result.lower_bound)
        result.message += fmt::format("; proved: none is shorter than {:.6g} ms", 1e3 * *result.lower_bound);
      else
        result.message += "; nothing is proved about how short one may be";
      if (!local_message_.empty()) result.message += "; " + local_message_;
      return result;
    }
    judge_gap(result);
    return result;
  }

  const Task& task_;
  const DesignOptions& options_;
  ExactRun exact_run_;
  Clock::time_point began_ = Clock::now();
  std::optional<DesignResult> exact_;  ///< result of the last run of the exact method
  std::optional<DesignResult> best_;   ///< a design from elsewhere that is shorter
  std::optional<DesignResult> bound_;  ///< a bound from elsewhere
  std::string local_message_;
};

/// Whether a given delay leaves too large a corner error. A longer filter seldom helps there, as it makes the error
/// larger; to look for one would take up to 20 s.
bool error_of_given_delay(const DesignResult& result) {
  const auto* proof =
      result.certificate == nullptr ? nullptr : std::get_if<proof::BranchAndBound>(&result.certificate->proof);
  const auto conflicts = [&](std::string_view name) {
    return std::ranges::any_of(proof->conflict, [&](const std::string& limit) { return limit.starts_with(name); });
  };
  return proof != nullptr && conflicts(delay_in_conflict) && conflicts(error_in_conflict);
}

DesignResult design_as_it_is(const Task& task, const DesignOptions& options) {
  Anytime anytime(task, options);
  try {
    const int most = task.design.order_max;
    exact::require_room(task, std::min(most, std::max(task.design.order_min, order_lower_bound(task, most))));
    DesignResult result = exact_covers(task) ? anytime.run() : anytime.run_in_part();
    if (result.status == Status::infeasible && !error_of_given_delay(result))
      result.message += larger_order_note(task, std::min(20.0, anytime.left()), options.cancel);
    return result;
  } catch (const exact::TooLarge& reason) {
    return anytime.run_without_linear_programs(reason.what());
  }
}

}  // namespace

bool exact_covers(const Task& task) {
  const auto chord_with_friction = [](const Axis& axis) {
    return axis.coulomb > 0.0 && (axis.power_max < unlimited || axis.regeneration_max < unlimited);
  };
  if (limits_supply(task.machine) || std::ranges::any_of(task.machine.axes, chord_with_friction)) return false;
  const Response response(task.machine, task.sample_period);
  if (response.ideal()) return true;
  return response.common();
}

void judge_gap(DesignResult& result) {
  result.gap.reset();
  if (!result.lower_bound) return;
  result.gap = std::max(0.0, (result.objective() - *result.lower_bound) / result.objective());
  if (*result.lower_bound < result.objective() * (1.0 - 1e-9)) return;
  result.status = Status::optimal;
  result.lower_bound = result.objective();
  result.gap = 0.0;
  result.message.clear();
  result.stop = StopReason::finished;
}

ExactOptions exact_options(const DesignOptions& options, double time_limit) {
  ExactOptions exact;
  exact.time_limit = time_limit;
  exact.gap = options.exact.gap;
  exact.cancel = options.cancel;
  exact.certificate = options.exact.certificate;
  exact.threads = options.exact.threads;
  return exact;
}

DesignResult design_anytime(const Task& task, const DesignOptions& options) {
  const MergedTask merged = merge_equal_corners(task);
  if (!merged.smaller()) return design_as_it_is(task, options);
  const DesignResult found = design_as_it_is(merged.task, options);
  if (auto result = of_whole_task(task, merged, found)) return *result;
  DesignOptions rest = options;
  rest.time_limit = std::max(1e-3, options.time_limit - found.solver.wall_time);
  return design_as_it_is(task, rest);
}

}  // namespace accdec
