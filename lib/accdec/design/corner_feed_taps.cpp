#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <accdec/design/corner_feed_taps.hpp>
#include <accdec/exact/minimal_conflict.hpp>
#include <accdec/exact/one_tolerance.hpp>
#include <accdec/exact/search.hpp>
#include <accdec/exact/size.hpp>
#include <accdec/files.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/task/conflict.hpp>
#include <accdec/task/corner_feed.hpp>
#include <accdec/task/equal_corners.hpp>
#include <accdec/task/objective.hpp>

namespace accdec {
namespace {

/// At most so many ways past all corners together.
constexpr double most_ways = 20'000.0;

bool covered(const Task& task) {
  const ControllerSettings& control = *task.settings;
  const auto listed = [](DelayKind kind) {
    return kind == DelayKind::corner_feed || kind == DelayKind::continuous || kind == DelayKind::exact_stop;
  };
  const auto plain = [](const Axis& axis) {
    return axis.damping == 0.0 && axis.coulomb == 0.0 &&
           !limited_beside(axis, {LimitKind::velocity, LimitKind::acceleration, LimitKind::jerk, LimitKind::force});
  };
  const auto undamped = [](const Mode& mode) { return !mode.of_axis() && mode.damping_high == 0.0; };
  const auto open = [](const TaskCorner& corner) { return corner.speed_min == 0.0 && !corner.delay; };
  const double ways = corner_feed_multiples(control.corner_feed_step) + 2.0;
  return std::ranges::all_of(control.delays, listed) && std::ranges::all_of(task.machine.axes, plain) &&
         std::ranges::all_of(task.machine.modes, undamped) && std::ranges::all_of(task.corners, open) &&
         !limits_supply(task.machine) && std::pow(ways, static_cast<double>(task.corners.size())) <= most_ways;
}

/// Looks for the ways past the corners that cost least with the shortest filter that has them. A way is a multiple of
/// the step of the feed; 0 is an exact stop, and the largest is the feed itself.
class CornerFeedSearch {
 public:
  CornerFeedSearch(const Task& task, const std::function<bool()>& late,
                   const std::function<double(const Filter&)>& offer, double best)
      : task_(task),
        late_(late),
        offer_(offer),
        best_(best),
        cost_(cost_of(task)),
        step_(task.settings->corner_feed_step),
        feed_(corner_feed_multiples(step_) + 1) {
    const Response response(task.machine, task.sample_period);
    if (!response.ideal()) response_ = response.motion(Filter({1.0})).order();
    smoothing_ = response.prefilter_order();
    const ControllerSettings& control = *task.settings;
    if (control.names(DelayKind::exact_stop)) allowed_.push_back(0);
    for (int way = 1; way < feed_; ++way) allowed_.push_back(way);
    if (control.names(DelayKind::continuous)) allowed_.push_back(feed_);
  }

  std::optional<CornerFeedBound> run() {
    std::string none = none_at_slowest();
    const bool found = find_order(slowest());
    if (found && std::min(cheapest().cost, best_) == unlimited) return proof(unlimited, std::move(none));
    if (!none.empty()) return CornerFeedBound{unlimited, nullptr, std::move(none)};
    if (!found) return std::nullopt;
    for (std::size_t j = 0; j < task_.corners.size(); ++j) find_fastest(j);
    for (;;) {
      const Cheapest best = cheapest();
      if (std::min(best.cost, best_) == unlimited) return proof(unlimited);
      if (best.cost >= best_ * (1.0 - 1e-12)) return proof(best_);
      const auto known = [&](const Part& part) { return part.is.multiples == best.ways; };
      if (std::ranges::any_of(parts_, known) || !find_order(best.ways)) return proof(best.cost);
    }
  }

 private:
  struct Part {
    proof::CornerFeedPart is;
    int order = 0;  ///< no filter is shorter
  };
  struct Cheapest {
    double cost = unlimited;
    std::vector<int> ways;
  };

  std::vector<int> slowest() const { return std::vector<int>(task_.corners.size(), allowed_.front()); }
  /// The limits that no filter holds together even at the slowest feeds; empty if that is not known.
  std::string none_at_slowest() const {
    if (best_ < unlimited || allowed_.front() == 0) return "";
    auto refuted = exact::refute_one_tolerance(at(slowest()), late_, late_);
    if (!refuted) return "";
    exact::Conflict conflict{std::move(refuted->conflict), !late_()};
    std::erase_if(conflict.limits, [](const std::string& limit) { return limit.starts_with(delay_in_conflict); });
    return fmt::format("even at the slowest corner feed, {:g} of the programmed one, {}", part(allowed_.front()),
                       exact::to_message(conflict, task_));
  }
  /// Orders above it cost more than the best design, whatever the ways.
  int most_useful() const {
    return static_cast<int>(std::clamp(best_ / cost_.filter - 1.0, 0.0, static_cast<double>(task_.design.order_max)));
  }

  /// The fastest way past one corner that any useful filter has, by bisection.
  void find_fastest(std::size_t j) {
    std::size_t held = 0, broken = allowed_.size();
    std::vector<int> ways = slowest();
    while (broken - held > 1 && !late_()) {
      const std::size_t middle = held + (broken - held) / 2;
      ways[j] = allowed_[middle];
      find_order(ways);
      (order_of(ways) > most_useful() ? broken : held) = middle;
    }
  }

  double part(int way) const { return way == feed_ ? 1.0 : way * step_; }

  /// The legs as straight lines at feed, whose starts and stops are those of the run, and the corners at their parts.
  Task at(const std::vector<int>& ways) const {
    Task slow = task_;
    slow.settings.reset(), slow.baseline.reset();
    slow.corners.clear();
    slow.design.objective = Objective::cycle, slow.design.runs = 1.0, slow.design.order_min = 0;
    for (std::size_t j = 0; j < ways.size(); ++j) {
      const Corner& g = task_.corners[j].geometry();
      add_straight(g.direction_in, g.feed_in, slow);
      add_straight(g.direction_out, g.feed_out, slow);
      if (ways[j] == 0) continue;
      TaskCorner corner = task_.corners[j];
      corner.set_feeds(part(ways[j]) * g.feed_in, part(ways[j]) * g.feed_out);
      corner.delay = 0, corner.weight = 1.0;
      slow.corners.push_back(std::move(corner));
    }
    return slow;
  }
  static void add_straight(const Eigen::VectorXd& along, double feed, Task& task) {
    const std::vector<double> direction(along.begin(), along.end());
    TaskCorner straight("", DirectedLegs{direction, direction}, feed, feed, static_cast<int>(direction.size()));
    straight.delay = 0;
    task.corners.push_back(std::move(straight));
  }

  /// Finds the least order with given ways, as far as it is useful. False: no better one is known than before.
  bool find_order(const std::vector<int>& ways) {
    const Task slow = at(ways);
    const MergedTask merged = merge_equal_corners(slow);
    const Task& subject = merged.smaller() ? merged.task : slow;
    exact::Workbench bench(subject, late_);
    exact::Search search(bench);
    double target = most_useful() + 2.0;
    try {
      auto answer = exact::Search::Answer::found;
      while ((answer = search.below(target)) == exact::Search::Answer::found) {
        target = bench.designs.best->value;
        best_ = std::min(best_, offer_(bench.designs.best->filter));
      }
      if (answer != exact::Search::Answer::proved) return false;
    } catch (const exact::TooLarge&) {
      return false;
    }
    const int least = static_cast<int>(std::ceil(target * (1.0 - 1e-8))) - 1;
    if (!parts_.empty() && least <= order_of(ways)) return false;
    auto tree = std::get<proof::BranchAndBound>(exact::certify(search.proof, subject)->proof);
    tree.corner_of = merged.of;
    parts_.push_back({proof::CornerFeedPart{ways, std::move(tree)}, least});
    return true;
  }

  /// The largest of the least orders known of slower ways.
  int order_of(const std::vector<int>& ways) const {
    int order = 0;
    for (const Part& part : parts_) {
      if (std::ranges::equal(part.is.multiples, ways, std::less_equal())) order = std::max(order, part.order);
    }
    return order;
  }

  double cost(const std::vector<int>& ways) const {
    const int order = std::max(order_of(ways), task_.design.order_min);
    if (order > task_.design.order_max) return unlimited;
    double sum = cost_.filter * (order + 1);
    for (std::size_t j = 0; j < ways.size(); ++j)
      sum += cost_.delay[j] *
             (ways[j] == 0 ? order + smoothing_ : corner_feed_loss(part(ways[j]), corner_feed_lead(order, response_)));
    return sum;
  }

  Cheapest cheapest() const {
    Cheapest best;
    std::vector<std::size_t> at(task_.corners.size(), 0);
    std::vector<int> ways(at.size(), allowed_.front());
    for (bool more = true; more;) {
      if (const double now = cost(ways); now < best.cost) best = {now, ways};
      more = false;
      for (std::size_t j = 0; j < at.size() && !more; ++j) {
        at[j] = at[j] + 1 == allowed_.size() ? 0 : at[j] + 1;
        ways[j] = allowed_[at[j]];
        more = at[j] > 0;
      }
    }
    return best;
  }

  /// With the parts that the bound needs.
  CornerFeedBound proof(double bound, std::string none = "") {
    for (std::size_t p = parts_.size(); p-- > 0;) {
      Part part = std::move(parts_[p]);
      parts_.erase(parts_.begin() + static_cast<std::ptrdiff_t>(p));
      if (cheapest().cost < bound * (1.0 - 1e-12))
        parts_.insert(parts_.begin() + static_cast<std::ptrdiff_t>(p), std::move(part));
    }
    proof::CornerFeeds proof;
    if (bound < unlimited) proof.bound_samples = bound;
    for (Part& part : parts_) proof.parts.push_back(std::move(part.is));
    return {bound, std::make_shared<Certificate>(Certificate{std::move(proof)}), std::move(none)};
  }

  const Task& task_;
  const std::function<bool()>& late_;
  const std::function<double(const Filter&)>& offer_;
  double best_;  ///< cost of the best design known, samples
  LinearCost cost_;
  double step_;
  int feed_, response_ = 0, smoothing_ = 0;
  std::vector<int> allowed_;  ///< ways, from the slowest
  std::vector<Part> parts_;
};

}  // namespace

std::optional<CornerFeedBound> prove_corner_feeds(const Task& task, const DesignOptions& options, double seconds,
                                                  double best, const std::function<double(const Filter&)>& offer) {
  if (!covered(task) || !Response(task.machine, task.sample_period).common()) return std::nullopt;
  const auto began = std::chrono::steady_clock::now();
  const std::function<bool()> late = [&] {
    return seconds_since(began) > seconds || (options.cancel != nullptr && options.cancel->load());
  };
  return CornerFeedSearch(task, late, offer, best).run();
}

}  // namespace accdec
