#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include <accdec/certificate/checked_response.hpp>
#include <accdec/certificate/checked_rows.hpp>
#include <accdec/certificate/corner_feed_check.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/task/corner_feed.hpp>
#include <accdec/task/objective.hpp>

namespace accdec {
namespace {

constexpr double most_ways = 20'000.0;

/// Ways past a corner by number: an exact stop, a part of the feed, the feed. A limit that holds on one holds on those
/// before.
class FeedWays {
 public:
  explicit FeedWays(const ControllerSettings& control)
      : control_(control), parts_(corner_feed_multiples(control.corner_feed_step)) {}

  int count() const { return parts_ + 2; }
  bool allowed(int way) const {
    return control_.names(way == 0            ? DelayKind::exact_stop
                          : way == parts_ + 1 ? DelayKind::continuous
                                              : DelayKind::corner_feed);
  }
  double part(int way) const { return way == parts_ + 1 ? 1.0 : way * control_.corner_feed_step; }

 private:
  const ControllerSettings& control_;
  int parts_;
};

/// Limits for which a stop at feed asks no more than a start, and a slower corner no more than a faster one.
void require_known(const Task& task) {
  const auto known = [](const Axis& axis) {
    return axis.damping == 0.0 && axis.coulomb == 0.0 &&
           !limited_beside(axis, {LimitKind::velocity, LimitKind::acceleration, LimitKind::jerk, LimitKind::force});
  };
  const auto undamped = [](const Mode& mode) { return !mode.of_axis() && mode.damping_high == 0.0; };
  const auto open = [](const TaskCorner& corner) { return corner.speed_min == 0.0 && !corner.delay; };
  if (!std::ranges::all_of(task.machine.axes, known) || !std::ranges::all_of(task.machine.modes, undamped) ||
      !std::ranges::all_of(task.corners, open) || limits_supply(task.machine))
    throw Rejected("corner feeds are not proved with limits of this task");
  const auto& kinds = task.settings->delays;
  const bool others = std::ranges::any_of(kinds, [](DelayKind kind) {
    return kind != DelayKind::corner_feed && kind != DelayKind::continuous && kind != DelayKind::exact_stop;
  });
  if (others) throw Rejected("corner feeds are not proved beside other delays");
}

/// The legs of every corner as straight lines at feed, and the corner at its part of the feed unless it is a stop.
Task at_feeds(const Task& task, const FeedWays& ways, const std::vector<int>& multiples) {
  Task slow = task;
  slow.settings.reset();
  slow.corners.clear();
  slow.design.objective = Objective::cycle, slow.design.runs = 1.0, slow.design.order_min = 0;
  for (std::size_t j = 0; j < multiples.size(); ++j) {
    const Corner& g = task.corners[j].geometry();
    for (const bool first : {true, false}) {
      const Eigen::VectorXd& along = first ? g.direction_in : g.direction_out;
      const std::vector<double> direction(along.begin(), along.end());
      const double feed = first ? g.feed_in : g.feed_out;
      slow.corners.emplace_back("", DirectedLegs{direction, direction}, feed, feed, static_cast<int>(direction.size()));
      slow.corners.back().delay = 0;
    }
    if (multiples[j] == 0) continue;
    slow.corners.push_back(task.corners[j]);
    const double part = ways.part(multiples[j]);
    slow.corners.back().set_feeds(part * g.feed_in, part * g.feed_out);
    slow.corners.back().delay = 0, slow.corners.back().weight = 1.0;
  }
  return slow;
}

/// The least cost of all ways with the orders that the parts leave.
class LeastCost {
 public:
  LeastCost(const Task& task, const FeedWays& ways, const std::vector<proof::CornerFeedPart>& parts,
            const std::vector<int>& least_orders)
      : task_(task),
        ways_(ways),
        parts_(parts),
        least_orders_(least_orders),
        response_(CheckedResponse(task).longer()),
        smoothing_(static_cast<int>(std::max<std::size_t>(1, task.machine.prefilter_taps.size())) - 1) {}

  double run() {
    visit(0);
    return least_;
  }

 private:
  void visit(std::size_t j) {
    if (j == task_.corners.size()) {
      least_ = std::min(least_, cost());
      return;
    }
    for (int way = 0; way < ways_.count(); ++way) {
      if (!ways_.allowed(way)) continue;
      chosen_.push_back(way);
      visit(j + 1);
      chosen_.pop_back();
    }
  }

  double cost() const {
    int order = 0;
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      if (std::ranges::equal(parts_[p].multiples, chosen_, std::less_equal()))
        order = std::max(order, least_orders_[p]);
    }
    const int taps = std::max(order, task_.design.order_min) + 1;
    if (taps > task_.design.order_max + 1) return unlimited;
    double sum = 0.0, weights = 0.0;
    for (std::size_t j = 0; j < chosen_.size(); ++j) {
      const double weight = task_.corners[j].weight;
      // An exact stop lasts until filter and smoothing are empty.
      const double stop = taps - 1 + smoothing_, slow = 2.0 * (taps + 1 + response_) * (1.0 - ways_.part(chosen_[j]));
      sum += weight * (chosen_[j] == 0 ? stop : slow);
      weights += weight;
    }
    return sum + taps * (task_.design.objective == Objective::cycle ? task_.design.runs : weights);
  }

  const Task& task_;
  const FeedWays& ways_;
  const std::vector<proof::CornerFeedPart>& parts_;
  const std::vector<int>& least_orders_;
  int response_, smoothing_;
  std::vector<int> chosen_;
  double least_ = unlimited;
};

}  // namespace

std::string check_corner_feeds(
    const proof::CornerFeeds& proof, const Task& task, const DesignResult& result,
    const std::function<void(const proof::BranchAndBound&, const Task&, const DesignResult&)>& orders) {
  if (!task.settings || !task.settings->names(DelayKind::corner_feed) || task.filter)
    throw Rejected("the certificate is about corner feeds, which the task's control does not have");
  require_known(task);
  const FeedWays ways(*task.settings);
  if (std::pow(ways.count(), static_cast<double>(task.corners.size())) > most_ways)
    throw Rejected("there are too many ways past the corners");
  const bool none = result.status == Status::infeasible;
  if (none && proof.bound_samples) throw Rejected("the certificate proves a bound, not that nothing exists");
  if (!none && !proof.bound_samples)
    throw Rejected("the certificate proves that nothing exists, the result has a design");
  if (!none && !result.lower_bound) throw Rejected("the result claims no lower bound");
  std::vector<int> least;
  for (const proof::CornerFeedPart& part : proof.parts) {
    const auto known = [&](int way) { return way >= 0 && way < ways.count(); };
    if (part.multiples.size() != task.corners.size() || !std::ranges::all_of(part.multiples, known))
      throw Rejected("a part has no multiple of the corner feed's step for every corner");
    DesignResult bound;
    bound.status = part.orders.bound_samples ? Status::feasible : Status::infeasible;
    bound.lower_bound = part.orders.bound_samples.value_or(unlimited) * task.sample_period;
    orders(part.orders, at_feeds(task, ways, part.multiples), bound);
    // No filter takes less than the bound's samples, which are its taps.
    const double taps = part.orders.bound_samples.value_or(task.design.order_max + 2.0);
    least.push_back(static_cast<int>(std::ceil(taps * (1.0 - 1e-8))) - 1);
  }
  const double proved = LeastCost(task, ways, proof.parts, least).run();
  if (none) {
    if (proved < unlimited) throw Rejected("the certificate leaves ways past the corners");
    return fmt::format("{} parts of the feeds refuted: no filter up to order {} holds all limits; {}",
                       proof.parts.size(), task.design.order_max, about_corner_feeds);
  }
  const double bound = *proof.bound_samples,
               claimed =
                   (result.status == Status::optimal ? result.objective() : *result.lower_bound) / task.sample_period;
  if (std::min(proved, bound) < claimed * (1.0 - 1e-9))
    throw Rejected(fmt::format("the certificate proves {:.9g} samples, the result claims {:.9g}",
                               std::min(proved, bound), claimed));
  if (bound > proved * (1.0 + 1e-9)) throw Rejected("the certificate claims more than its parts prove");
  if (result.status == Status::optimal && *result.lower_bound < result.objective() * (1.0 - 1e-9))
    throw Rejected("the status is optimal, but the lower bound is below the cycle time");
  return fmt::format(
      "{} parts of the feeds refuted: no {} time is shorter than {:.9g} s, within the tolerance of the "
      "verification; {}",
      proof.parts.size(), to_string(task.design.objective), claimed * task.sample_period, about_corner_feeds);
}

}  // namespace accdec
