#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <accdec/certificate/certificate.hpp>
#include <accdec/certificate/checked_rows.hpp>
#include <accdec/certificate/constant_feed.hpp>
#include <accdec/task/verifier.hpp>

namespace accdec {
namespace {

using nlohmann::json;

class Checker {
 public:
  Checker(const Task& task, const json& certificate, double target, const std::function<bool()>& stop)
      : task_(task),
        rows_(task),
        tree_(certificate.at("tree")),
        multipliers_(certificate.at("multipliers")),
        target_(target),
        stop_(stop) {}

  std::size_t run() {
    CheckedBox root;
    root.order_most = task_.design.order_max;
    for (const TaskCorner& c : task_.corners) {
      // Nothing changes from d = N + 2 on, nor from k = N + d + 1 on.
      const int d1 = c.delay.value_or(0), d2 = c.delay.value_or(task_.design.order_max + 2);
      root.corners.push_back({d1, d2, 0, d2 + task_.design.order_max + 1});
    }
    node(root, 0);
    if (next_ != tree_.size()) throw Rejected("the tree goes on after its end");
    return leaves_;
  }

 private:
  int least_order() const { return std::max(task_.design.order_min, 0); }

  /// Largest order with which a design in the box can be shorter than the target; cuts delays that cannot. -1: none.
  int largest_order(CheckedBox& whole) const {
    std::vector<CheckedRange>& box = whole.corners;
    whole.budget.reset();
    const int least = std::max(least_order(), whole.order_least);
    if (std::isinf(target_)) return whole.order_most < least ? -1 : whole.order_most;
    const double limit = target_ * (1.0 - 1e-9);
    // Machine time pays the filter once a run, the corners' own times once a corner.
    double filter = task_.design.objective == Objective::cycle ? task_.design.runs : 0.0, value = 0.0;
    for (std::size_t j = 0; j < box.size(); ++j) {
      if (task_.design.objective == Objective::corner) filter += task_.corners[j].weight;
      value += task_.corners[j].weight * box[j].d1;
    }
    const int order =
        static_cast<int>(std::min<double>(whole.order_most, std::ceil((limit - value) / filter - 1.0) - 1.0));
    if (order < least) return -1;
    for (std::size_t j = 0; j < box.size(); ++j) {
      const double room = (limit - value - filter * (least + 1)) / task_.corners[j].weight;
      box[j].d2 = std::min(box[j].d2, box[j].d1 + static_cast<int>(std::clamp(room, 0.0, 1e8)));
    }
    // A little more than rounding can have taken away.
    whole.budget = (limit - value - filter * (least + 1)) + 1e-12 * limit;
    return order;
  }

  const json& next(int depth) {
    if (next_ >= tree_.size()) throw Rejected("the tree is cut off: not every pair of order and delay is refuted");
    if (depth > 1000) throw Rejected("the tree is too deep");
    if (stop_ && stop_()) throw Rejected("it could not be checked in the time allowed");
    return tree_[next_++];
  }

  void node(CheckedBox box, int depth) {
    const json& entry = next(depth);
    const CheckedBox whole = box;
    box.order = largest_order(box);
    if (box.order >= 0) {
      for (CheckedRange& r : box.corners) r.k2 = std::min(r.k2, box.order + r.d2 + 1);
    }
    const bool empty = box.order < 0 || std::any_of(box.corners.begin(), box.corners.end(),
                                                    [](const CheckedRange& r) { return r.k1 > r.k2; });
    if (entry.is_null()) {
      if (!empty) throw Rejected(fmt::format("{} is left out as too long, but is not", describe(box)));
    } else if (box.order < 0) {
      throw Rejected("the tree goes on where every design is too long");
    } else if (entry.is_number_integer()) {
      leaf(entry.get<int>(), box, false);
    } else if (entry == "unreachable") {
      unreachable(box);
    } else if (entry.is_array() && entry.size() == 3 && entry[1] == "B") {
      const auto [first, second] = parts(entry, whole, box.order);
      node(first, depth + 1);
      node(second, depth + 1);
    } else if (entry.is_array() && entry.size() == 3 && entry[1].is_string()) {
      split(entry, whole, depth);
    } else if (entry.is_array() && entry.size() == 2 && entry[0] == "N") {
      const int at = entry[1].get<int>();
      if (at < std::max(least_order(), whole.order_least) || at >= whole.order_most)
        throw Rejected("the tree splits outside the box");
      CheckedBox shorter = whole, longer = whole;
      shorter.order_most = at;
      longer.order_least = at + 1;
      node(shorter, depth + 1);
      node(longer, depth + 1);
    } else if (entry.is_array() && entry.size() == 2 && task_.design.symmetric) {
      require_one_delay(box);
      for (const json& index : entry) {
        if (box.order >= least_order()) leaf(index.get<int>(), box, true);
        --box.order;
      }
    } else if (entry.is_array() && entry.size() == 1 && entry[0] == "symmetric" && task_.design.symmetric) {
      require_one_delay(box);
      exact_order(box, depth + 1);
      if (--box.order >= least_order()) exact_order(box, depth + 1);
    } else {
      throw Rejected("an entry of the tree is none of the known kinds");
    }
  }

  /// A shorter symmetric filter becomes one of the box's order, or of one less, by as many zeros at either end, which
  /// moves its sample k. That order must then not depend on how k was split: it comes from the delays, so they must be
  /// down to one each.
  static void require_one_delay(const CheckedBox& box) {
    const bool one =
        std::all_of(box.corners.begin(), box.corners.end(), [](const CheckedRange& r) { return r.d1 == r.d2; });
    if (!one)
      throw Rejected(
          fmt::format("{} refutes symmetric filters of one order for several delays at once", describe(box)));
  }

  /// Symmetric filters of exactly the box's order.
  void exact_order(const CheckedBox& box, int depth) {
    const json& entry = next(depth);
    if (entry.is_number_integer()) {
      leaf(entry.get<int>(), box, true);
    } else if (entry == "unreachable") {
      unreachable(box);
    } else if (entry.is_array() && entry.size() == 3 && entry[1] == "B") {
      const auto [first, second] = parts(entry, box, box.order);
      exact_order(first, depth + 1);
      exact_order(second, depth + 1);
    } else {
      throw Rejected("an entry of the tree is none of the known kinds");
    }
  }

  void split(const json& entry, const CheckedBox& box, int depth) {
    const int j = entry[0].get<int>(), at = entry[2].get<int>();
    if (j < 0 || j >= static_cast<int>(box.corners.size()))
      throw Rejected("the tree splits a corner that is not there");
    CheckedBox first = box, second = box;
    CheckedRange &a = first.corners[static_cast<std::size_t>(j)], &b = second.corners[static_cast<std::size_t>(j)];
    const bool delay = entry[1] == "d";
    if (!delay && entry[1] != "k") throw Rejected("the tree splits neither a delay nor a sample");
    if (at < (delay ? a.d1 : a.k1) || at >= (delay ? a.d2 : a.k2)) throw Rejected("the tree splits outside the box");
    (delay ? a.d2 : a.k2) = at;
    (delay ? b.d1 : b.k1) = at + 1;
    node(first, depth + 1);
    node(second, depth + 1);
  }

  /// B_k at most a level, and at least it.
  static std::pair<CheckedBox, CheckedBox> parts(const json& entry, const CheckedBox& box, int order) {
    const int k = entry[0].get<int>();
    const double level = entry[2].get<double>();
    if (k < 1 || k > order) throw Rejected("the tree splits a response that is not there");
    if (!(level >= 0.0 && level <= 1.0)) throw Rejected("the tree splits a response outside 0 .. 1");
    std::pair<CheckedBox, CheckedBox> both{box, box};
    both.first.cuts.push_back({k, true, level});
    both.second.cuts.push_back({k, false, level});
    return both;
  }

  void unreachable(const CheckedBox& box) {
    ++leaves_;
    if (rows_.tube(box)) throw Rejected(fmt::format("{} is called unreachable, but is not", describe(box)));
  }

  static std::string describe(const CheckedBox& box) {
    std::string text = fmt::format("order up to {}", box.order);
    for (const CheckedRange& r : box.corners)
      text += fmt::format(", d = {} .. {} (k = {} .. {})", r.d1, r.d2, r.k1, r.k2);
    for (const CheckedCut& c : box.cuts)
      text += fmt::format(", B_{} {} {:.6g}", c.sample, c.upper ? "<=" : ">=", c.level);
    return text;
  }

  void leaf(int index, CheckedBox box, bool symmetric) {
    if (index < 0 || index >= static_cast<int>(multipliers_.size()))
      throw Rejected("the tree names multipliers that are not there");
    ++leaves_;
    CheckedSum sum(box.order);
    sum.delays.resize(box.corners.size());
    sum.samples.resize(box.corners.size());
    for (const json& row : multipliers_[static_cast<std::size_t>(index)]) {
      if (stop_ && stop_()) throw Rejected("it could not be checked in the time allowed");
      rows_.add(row, box, sum);
    }
    if (box.nothing_left) return;
    Interval suffix(0.0);
    for (std::size_t i = sum.taps.size(); i-- > 0;) {
      suffix = suffix + sum.cumulative[i + 1];
      sum.taps[i] = sum.taps[i] + suffix;
    }
    std::vector<double> least;
    for (const Interval& c : sum.taps) least.push_back(c.lo);
    if (symmetric) {
      const std::vector<double> plain = least;
      for (std::size_t i = 0; i < least.size(); ++i)
        least[i] = (0.5 * (Interval(plain[i]) + Interval(plain[plain.size() - 1 - i]))).lo;
    }
    // For any lambda: sum c b >= lambda + sum u min(0, c - lambda). The best is the c at which the cheapest taps are
    // full.
    const double tap_max = rows_.tap_max(), room = 1.0 / tap_max;
    if (static_cast<double>(least.size()) < room * (1.0 - 1e-12)) return;  // not even full taps reach a sum of 1
    std::vector<double> sorted = least;
    const auto full = static_cast<std::ptrdiff_t>(std::min(static_cast<double>(sorted.size() - 1), room));
    std::nth_element(sorted.begin(), sorted.begin() + full, sorted.end());
    const double lambda = sorted[static_cast<std::size_t>(full)];
    Interval bound(lambda);
    for (const double c : least) {
      if (c < lambda) bound = bound + Interval(tap_max) * (Interval(c) - Interval(lambda));
    }
    bound = bound - sum.rhs;
    for (std::size_t j = 0; j < box.corners.size(); ++j) {
      const CheckedRange& r = box.corners[j];
      if (sum.delays[j].lo < 0.0) bound = bound + Interval(sum.delays[j].lo) * static_cast<double>(r.d2 - r.d1);
      if (sum.samples[j].lo < 0.0) bound = bound + Interval(sum.samples[j].lo) * static_cast<double>(r.k2 - r.k1);
    }
    if (!(bound.lo > 0.0)) {
      throw Rejected(fmt::format("{} is not refuted by its multipliers (margin {:.3g})", describe(box), bound.lo));
    }
  }

  const Task& task_;
  CheckedRows rows_;
  const json& tree_;
  const json& multipliers_;
  double target_;
  const std::function<bool()>& stop_;
  std::size_t next_ = 0, leaves_ = 0;
};

/// What is wrong with the objective a certificate names; empty when it is the task's.
std::string other_objective(const Task& task, const json& certificate) {
  const bool cycle = task.design.objective == Objective::cycle;
  const std::string asked = cycle ? "cycle" : "corner", named = certificate.value("objective", "");
  if (named != asked)
    return fmt::format("the certificate is about the objective \"{}\", the task's is \"{}\"", named, asked);
  if (!cycle) return {};
  const double runs = certificate.value("runs", 0.0);
  if (runs == task.design.runs) return {};
  return fmt::format("the certificate is about {} runs, the task asks for {}", runs, task.design.runs);
}

}  // namespace

CheckReport check_certificate(const Task& task, const DesignResult& result, const std::function<bool()>& stop) {
  try {
    if (result.certificate.empty()) return {false, "there is no certificate"};
    const json certificate = json::parse(result.certificate);
    if (certificate.at("schema") != "accdec.certificate/1") {
      return {false, "the certificate's schema is unknown; known is accdec.certificate/1"};
    }
    const std::string kind = certificate.at("kind").get<std::string>();
    if (kind == "constant feed") {
      if (result.status != Status::infeasible)
        return {false, "the certificate is one of infeasibility, the status is not"};
      const std::string broken = broken_at_constant_feed(task);
      if (broken.empty()) return {false, "no limit is broken at constant feed"};
      return {true, broken};
    }
    if (kind != "branch and bound") return {false, "the certificate's kind is unknown: " + kind};
    if (const std::string other = other_objective(task, certificate); !other.empty()) return {false, other};
    double target = unlimited;
    if (result.status == Status::infeasible) {
      if (!certificate.at("bound_samples").is_null())
        return {false, "the certificate proves a bound, not that nothing exists"};
    } else {
      if (!result.lower_bound) return {false, "the result claims no lower bound"};
      const double claimed = result.status == Status::optimal ? result.objective() : *result.lower_bound;
      target = claimed / task.sample_period;
      if (result.status == Status::optimal && *result.lower_bound < result.objective() * (1.0 - 1e-9)) {
        return {false, "the status is optimal, but the lower bound is below the cycle time"};
      }
      if (!certificate.at("bound_samples").is_null()) {
        const double proved = certificate.at("bound_samples").get<double>();
        if (proved < target * (1.0 - 1e-9))
          return {false, fmt::format("the certificate proves {} samples, the result claims {}", proved, target)};
        target = proved;
      }
    }
    const std::size_t leaves = Checker(task, certificate, target, stop).run();
    return {true, std::isinf(target)
                      ? fmt::format("{} parts refuted: nothing holds all limits", leaves)
                      : fmt::format("{} parts refuted: under the limits as written no {} time is shorter than {:.9g} s",
                                    leaves, task.design.objective == Objective::cycle ? "cycle" : "corner",
                                    target * task.sample_period)};
  } catch (const Rejected& e) {
    return {false, e.what()};
  } catch (const json::exception& e) {
    return {false, std::string("the certificate cannot be read: ") + e.what()};
  }
}

}  // namespace accdec
