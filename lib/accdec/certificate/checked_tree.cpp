#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include <accdec/certificate/checked_leaves.hpp>
#include <accdec/certificate/checked_parts.hpp>
#include <accdec/certificate/checked_tree.hpp>
#include <accdec/certificate/node_reader.hpp>
#include <accdec/machine/limits.hpp>

namespace accdec {
namespace {

/// Walks through a proof's lemmas and tree, and keeps track of the part of all designs that a node is about.
class CheckedTree {
 public:
  CheckedTree(const Task& task, const proof::BranchAndBound& proof, const CheckedWhole& whole,
              const std::function<bool()>& stop)
      : task_(task), proof_(proof), whole_(whole), leaves_(task, proof.multipliers, stop), nodes_(stop) {}

  std::size_t run() {
    const double target = whole_.target;
    for (const proof::Lemma& l : proof_.lemmas) {
      // A lemma holds whatever the cost, and its proof uses no other lemma.
      whole_.target = unlimited;
      lemma(l);
    }
    whole_.target = target;
    lemmas_.known = proof_.lemmas.size();
    whole_tree(proof_.tree, [&] { node(root(), 0); });
    return leaves_.checked() + lemmas_.cited;
  }

 private:
  /// All designs.
  CheckedBox root() const {
    CheckedBox root;
    root.in_position = proof_.in_position;
    root.order_most = task_.design.order_max;
    for (const TaskCorner& c : task_.corners) {
      // From d = N + 2 on nothing changes, as no limit is on more than a first difference; nor from k = N + d + 1 on.
      static_assert(most_differences == 1);
      // A response delays both by its length, in-position by its latency.
      const int more = leaves_.longer() + (proof_.in_position ? leaves_.rows().latency() : 0);
      const int d1 = c.delay.value_or(0), d2 = c.delay.value_or(task_.design.order_max + 2 + more);
      const int last = d2 + task_.design.order_max + 1 + leaves_.longer();
      root.corners.push_back({d1, d2, 0, last, 0.0, static_cast<double>(last)});
    }
    for (std::size_t j = 0; j < whole_.samples.size(); ++j) root.corners[j].k1 = root.corners[j].k2 = whole_.samples[j];
    root.instants = whole_.instants;
    return root;
  }

  template <typename Check>
  void whole_tree(const std::vector<proof::Node>& tree, const Check& check) {
    nodes_.begin(tree);
    check();
    nodes_.require_end();
  }

  void lemma(const proof::Lemma& l) {
    CheckedBox box = root();
    for (const proof::CornerDelay& d : l.delays) {
      if (d.corner < 0 || d.corner >= static_cast<int>(box.corners.size()))
        throw Rejected("a lemma names a corner that is not there");
      CheckedRange& r = box.corners[static_cast<std::size_t>(d.corner)];
      r.d2 = std::min(r.d2, d.delay);
      if (r.d2 < r.d1) throw Rejected("a lemma names a delay that its corner cannot have");
      r.k2 = r.d2 + task_.design.order_max + 1 + leaves_.longer();
    }
    for (const proof::CornerDelay& d : l.from) {
      if (d.corner < 0 || d.corner >= static_cast<int>(box.corners.size()))
        throw Rejected("a lemma names a corner that is not there");
      CheckedRange& r = box.corners[static_cast<std::size_t>(d.corner)];
      r.d1 = std::max(r.d1, d.delay);
      if (r.d2 < r.d1) throw Rejected("a lemma names a delay that its corner cannot have");
    }
    if (!l.window) {
      box.order_most = std::min(box.order_most, l.order);
      whole_tree(l.tree, [&] { node(box, 0); });
      return;
    }
    const proof::Window& w = *l.window;
    if (w.order < 2 || w.order > 1'000'000 || w.anchor < 0 || w.anchor >= static_cast<int>(box.corners.size()))
      throw Rejected("a lemma's window is none");
    box.window = true;
    box.order = w.order;
    // The anchor's sample is `at` once the filter is shifted. For the other corners, the first and the last sample
    // stand for all samples before and after them. There p and q are at most their values at the ends.
    for (CheckedRange& r : box.corners) r.k2 = r.d2 + w.order + 1 + leaves_.longer();
    CheckedRange& anchor = box.corners[static_cast<std::size_t>(w.anchor)];
    if (!task_.corners[static_cast<std::size_t>(w.anchor)].error_max || w.at < 0 || w.at > anchor.k2)
      throw Rejected("a lemma's window has no anchor");
    anchor.k1 = anchor.k2 = w.at;
    whole_tree(l.tree, [&] { window(box, 0); });
  }

  void window(const CheckedBox& box, int depth) {
    const proof::Node& entry = nodes_.next(depth);
    if (const auto* refuted = std::get_if<proof::Refuted>(&entry)) {
      leaves_.refute(refuted->multipliers, box, false);
    } else if (const auto* split = std::get_if<proof::Split>(&entry)) {
      const auto [first, second] = checked_parts(*split, box);
      window(first, depth + 1);
      window(second, depth + 1);
    } else {
      throw Rejected("filters of any order are neither refuted nor split on a delay or sample");
    }
  }

  void check(const proof::ByLemma& n, const CheckedBox&, const CheckedBox& box, int) {
    if (n.lemma < 0 || n.lemma >= static_cast<int>(lemmas_.known))
      throw Rejected("the tree names a lemma that is not there");
    ++lemmas_.cited;
    const proof::Lemma& l = proof_.lemmas[static_cast<std::size_t>(n.lemma)];
    bool covers = l.window || box.order <= l.order;
    for (const proof::CornerDelay& d : l.delays)
      covers = covers && box.corners[static_cast<std::size_t>(d.corner)].d2 <= d.delay;
    for (const proof::CornerDelay& d : l.from)
      covers = covers && box.corners[static_cast<std::size_t>(d.corner)].d1 >= d.delay;
    if (!covers) throw Rejected(fmt::format("{} is not what lemma {} is about", describe(box), n.lemma));
  }

  int least_order() const { return std::max(task_.design.order_min, 0); }

  /// Largest order with which a design in the box can be shorter than the target; cuts delays that cannot. -1: none.
  int largest_order(CheckedBox& whole) const {
    std::vector<CheckedRange>& box = whole.corners;
    whole.budget.reset();
    const int least = std::max(least_order(), whole.order_least);
    if (std::isinf(whole_.target)) return whole.order_most < least ? -1 : whole.order_most;
    const double limit = whole_.target * (1.0 - 1e-9);
    // Machine time counts the filter once per run; the corners' own times count it once per corner.
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
    // The margin is slightly larger than the possible rounding.
    whole.budget = (limit - value - filter * (least + 1)) + 1e-12 * limit;
    return order;
  }

  void node(CheckedBox box, int depth) {
    const proof::Node& entry = nodes_.next(depth);
    const CheckedBox whole = box;
    if (box.in_position) leaves_.rows().order_delays(box);
    box.order = largest_order(box);
    if (box.in_position && box.order >= 0) leaves_.rows().end_delays(box);
    if (box.order >= 0) {
      for (CheckedRange& r : box.corners) {
        // At the last sample the motion has ended: what holds later holds there.
        const int last = box.order + r.d2 + 1 + leaves_.longer();
        r.k2 = std::min(r.k2, last);
        r.c2 = std::min(r.c2, static_cast<double>(last));
      }
    }
    const bool too_long = std::holds_alternative<proof::TooLong>(entry);
    const bool empty = box.order < 0 || std::any_of(box.corners.begin(), box.corners.end(), [](const CheckedRange& r) {
                         return r.d1 > r.d2 || r.k1 > r.k2 || r.c1 > r.c2;
                       });
    if (too_long && !empty) throw Rejected(fmt::format("{} is left out as too long, but is not", describe(box)));
    if (too_long) return;
    if (box.order < 0) throw Rejected("the tree goes on where every design is too long");
    std::visit([&](const auto& n) { check(n, whole, box, depth); }, entry);
  }

  // One function per kind of node. `whole` is the part after the splits; `box` is what the target leaves of it.

  void check(const proof::TooLong&, const CheckedBox&, const CheckedBox&, int) {}

  void check(const proof::Refuted& n, const CheckedBox&, const CheckedBox& box, int) {
    leaves_.refute(n.multipliers, box, false);
  }

  void check(const proof::RefutedInstants& n, const CheckedBox&, const CheckedBox& box, int) {
    leaves_.refute_instants(n, box, false);
  }

  void check(const proof::Unreachable&, const CheckedBox&, const CheckedBox& box, int) {
    leaves_.require_unreachable(box);
  }

  void check(const proof::ResponseSplit& n, const CheckedBox& whole, const CheckedBox& box, int depth) {
    const auto [first, second] = checked_parts(n, whole, box.order + leaves_.longer());
    node(first, depth + 1);
    node(second, depth + 1);
  }

  void check(const proof::OrderSplit& n, const CheckedBox& whole, const CheckedBox&, int depth) {
    if (n.at < std::max(least_order(), whole.order_least) || n.at >= whole.order_most)
      throw Rejected("the tree splits outside the box");
    CheckedBox shorter = whole, longer = whole;
    shorter.order_most = n.at;
    longer.order_least = n.at + 1;
    node(shorter, depth + 1);
    node(longer, depth + 1);
  }

  /// Splits of a corner.
  template <class Split>
  auto check(const Split& n, const CheckedBox& whole, const CheckedBox&, int depth)
      -> decltype(checked_parts(n, whole), void()) {
    const auto [first, second] = checked_parts(n, whole);
    node(first, depth + 1);
    node(second, depth + 1);
  }

  void check(const proof::RefutedSymmetric& n, const CheckedBox&, const CheckedBox& box, int) {
    require_symmetric(box);
    CheckedBox one = box;
    leaves_.refute(n.multipliers, one, true);
    if (--one.order >= least_order()) leaves_.refute(n.shorter, one, true);
  }

  void check(const proof::SymmetricOrders&, const CheckedBox&, const CheckedBox& box, int depth) {
    require_symmetric(box);
    CheckedBox one = box;
    exact_order(one, depth + 1);
    if (--one.order >= least_order()) exact_order(one, depth + 1);
  }

  /// A shorter symmetric filter becomes one of the box's order, or of one less, by equal numbers of zeros at both ends.
  /// This moves its sample k. So that order must not depend on how k was split: it comes from the delays, and these
  /// must be single values.
  void require_symmetric(const CheckedBox& box) const {
    if (!task_.design.symmetric) throw Rejected("the tree refutes symmetric filters only, the task allows any");
    const bool one =
        std::all_of(box.corners.begin(), box.corners.end(), [](const CheckedRange& r) { return r.d1 == r.d2; });
    if (!one)
      throw Rejected(
          fmt::format("{} refutes symmetric filters of one order for several delays at once", describe(box)));
  }

  /// Symmetric filters of exactly the box's order.
  void exact_order(const CheckedBox& box, int depth) {
    const proof::Node& entry = nodes_.next(depth);
    if (const auto* refuted = std::get_if<proof::Refuted>(&entry)) {
      leaves_.refute(refuted->multipliers, box, true);
    } else if (const auto* instants = std::get_if<proof::RefutedInstants>(&entry)) {
      leaves_.refute_instants(*instants, box, true);
    } else if (std::holds_alternative<proof::Unreachable>(entry)) {
      leaves_.require_unreachable(box);
    } else if (const auto* split = std::get_if<proof::ResponseSplit>(&entry)) {
      const auto [first, second] = checked_parts(*split, box, box.order + leaves_.longer());
      exact_order(first, depth + 1);
      exact_order(second, depth + 1);
    } else if (const auto* reversal = std::get_if<proof::ReversalSplit>(&entry)) {
      const auto [first, second] = checked_parts(*reversal, box);
      exact_order(first, depth + 1);
      exact_order(second, depth + 1);
    } else if (const auto* at = std::get_if<proof::InstantSplit>(&entry)) {
      const auto [first, second] = checked_parts(*at, box);
      exact_order(first, depth + 1);
      exact_order(second, depth + 1);
    } else {
      throw Rejected("symmetric filters of one order are neither refuted nor split on a response or reversal");
    }
  }

  const Task& task_;
  const proof::BranchAndBound& proof_;
  CheckedWhole whole_;
  CheckedLeaves leaves_;
  NodeReader nodes_;
  struct {
    std::size_t cited = 0, known = 0;  // parts that name one; those that may be named
  } lemmas_;
};

}  // namespace

std::size_t check_tree(const Task& granted, const proof::BranchAndBound& proof, const CheckedWhole& whole,
                       const std::function<bool()>& stop) {
  return CheckedTree(granted, proof, whole, stop).run();
}

}  // namespace accdec
