#include <algorithm>
#include <limits>

#include <accdec/exact/lemma_prover.hpp>
#include <accdec/exact/limit_model.hpp>
#include <accdec/exact/one_width.hpp>

namespace accdec::exact {
namespace {

/// Linear programs that one attempt at a stronger lemma may use, in addition to twice the number of the lemma's own
/// proof.
constexpr long attempt = 40;
constexpr long no_budget = std::numeric_limits<long>::max() / 2;

}  // namespace

LemmaProver::LemmaProver(const Task& task, const std::function<bool()>& stop, const Window& window, int number)
    : task_(task),
      stop_(stop),
      cost_(cost_of(task)),
      sees_all_(LimitModel(task).convex() &&
                std::ranges::none_of(task.corners, [](const TaskCorner& c) { return c.contour_max.has_value(); })),
      number_(number),
      some_(task, stop),
      any_(task, stop, window) {}

bool LemmaProver::refutes(bool wide, int order, const std::vector<int>& most, long budget,
                          std::vector<proof::Node>& tree) {
  TogetherSearch::Answer answer = of(wide).refute(order, most, budget, tree);
  if (answer.refuted) tree = std::move(answer.tree);
  return answer.refuted;
}

JointLemma LemmaProver::lemma(bool wide, int order, const std::vector<int>& most, std::vector<proof::Node> tree) const {
  JointLemma lemma;
  lemma.prover = number_;
  lemma.wide = wide;
  lemma.order = wide ? std::numeric_limits<int>::max() : order;
  lemma.tree = std::move(tree);
  for (std::size_t j = 0; j < most.size(); ++j)
    if (most[j] >= 0) lemma.delays.push_back({static_cast<int>(j), most[j]});
  return lemma;
}

std::optional<JointLemma> LemmaProver::no_filter_up_to(int order) {
  std::vector<proof::Node> tree;
  const std::vector<int> all(task_.corners.size(), -1);
  if (!refutes(false, order, all, 2000, tree)) return std::nullopt;
  return lemma(false, order, all, std::move(tree));
}

/// A lemma of one corner: the longest delay above `low` that no filter has, by bisection.
std::optional<JointLemma> LemmaProver::longest_refuted(std::size_t j, bool wide, int shorter, int low, int high) {
  std::vector<int> most(task_.corners.size(), -1);
  std::vector<proof::Node> tree, best;
  const long budget = wide ? 200 : no_budget;
  while (high - low > 1 && !stop_()) {
    most[j] = low + (high - low) / 2;
    if (refutes(wide, shorter, most, budget, tree)) {
      low = most[j];
      best = std::move(tree);
    } else {
      high = most[j];
    }
  }
  if (best.empty()) return std::nullopt;
  most[j] = low;
  return lemma(wide, shorter, most, std::move(best));
}

std::vector<JointLemma> LemmaProver::single_corner(std::size_t j, int shorter, int known) {
  std::vector<JointLemma> lemmas;
  if (task_.corners[j].delay) return lemmas;
  // The known delay holds, perhaps with another order only.
  const int high = std::min(known, shorter + 2);
  int low = -1;
  if (task_.corners[j].error_max) {
    if (auto found = longest_refuted(j, true, shorter, -1, high)) {
      low = found->delays.front().delay;
      lemmas.push_back(std::move(*found));
    }
  }
  if (!sees_all_ || !task_.corners[j].error_max) {
    if (auto found = longest_refuted(j, false, shorter, low, high)) lemmas.push_back(std::move(*found));
  }
  return lemmas;
}

void LemmaProver::work_on(JointWork& work, const JointTree& tree, const JointLemmas& lemmas, double target) {
  const long before = linear_programs();
  const std::size_t some = some_.multipliers().size(), any = any_.multipliers().size();
  if (!extend(work, tree, lemmas)) check(work, tree, target);
  // Without this, what failed attempts leave behind would grow with time.
  const std::vector<proof::Node> nothing;
  const auto found = [&](bool wide) -> const auto& {
    return work.lemma && work.lemma->wide == wide ? work.lemma->tree : nothing;
  };
  some_.forget(some, found(false));
  any_.forget(any, found(true));
  work.spent = linear_programs() - before;
}

/// Extends a lemma that would settle something in the node if it held for longer filters; most lemmas do.
bool LemmaProver::extend(JointWork& work, const JointTree& tree, const JointLemmas& lemmas) {
  const bool wide = work.order > tree.most_short();
  std::vector<char> failed(lemmas.size(), 0);
  for (;;) {
    std::size_t chosen = lemmas.size();
    double best = -1.0;
    for (std::size_t l = 0; l < lemmas.size(); ++l) {
      if (!lemmas[l].from.empty() || lemmas[l].order >= work.order || lemmas.given_up(l, work.order) || failed[l] != 0)
        continue;
      const JointLemmas::Judgement is = lemmas.judge(l, tree[work.node]);
      if (is.verdict == JointLemmas::Verdict::satisfied) continue;
      if (is.increase > best) best = is.increase, chosen = l;
    }
    if (chosen == lemmas.size() || stop_()) return false;
    const std::vector<int> most = lemmas[chosen].most(task_.corners.size());
    std::vector<proof::Node> proof;
    const long budget = 5000 + 30 * static_cast<long>(lemmas[chosen].tree.size());
    if (refutes(wide, work.order, most, budget, proof)) {
      work.lemma = lemma(wide, work.order, most, std::move(proof));
      work.extended = static_cast<int>(chosen);
      return true;
    }
    failed[chosen] = 1;
    work.failed.emplace_back(chosen, wide ? tree.most_short() + 1 : work.order);
  }
}

/// Asks whether the node's smallest delays hold together.
void LemmaProver::check(JointWork& work, const JointTree& tree, double target) {
  const JointNode& at = tree[work.node];
  const double room = target - tree.cost(at);
  std::vector<proof::Node> proof;
  if (refutes(true, work.order, at.d1, no_budget, proof)) {
    work.lemma = learn(at, room, true, work.order, std::move(proof));
    return;
  }
  TogetherSearch::Answer answer = some_.refute(work.order, at.d1, no_budget);
  if (answer.refuted) {
    work.lemma = learn(at, room, false, work.order, std::move(answer.tree));
    return;
  }
  if (some_.best()->value < target * (1.0 - 1e-12)) return;
  if (by_one_width(task_) && check_width(work, at, target)) return;
  work.undecided = !stop_();
}

/// Some filter holds the delays, but perhaps none with which one width gives them. The proof is for these delays alone,
/// and then for longer ones of all corners of a feed, as far as it still holds.
bool LemmaProver::check_width(JointWork& work, const JointNode& at, double target) {
  std::vector<int> most = at.d1;
  TogetherSearch::Answer answer = some_.refute(work.order, most, no_budget, {}, at.d1);
  if (!answer.refuted) return some_.best()->value < target * (1.0 - 1e-12);
  for (std::size_t j = 0; j < most.size() && !stop_(); ++j) {
    const auto same = [&](std::size_t i) { return same_by_width(task_, static_cast<int>(i), static_cast<int>(j)); };
    std::size_t first = 0;
    while (!same(first)) ++first;
    if (first < j) continue;
    std::vector<int> longer = most;
    for (std::size_t i = 0; i < most.size(); ++i) longer[i] += same(i) ? 1 : 0;
    const long budget = attempt + static_cast<long>(answer.tree.size());
    TogetherSearch::Answer more = some_.refute(work.order, longer, budget, answer.tree, at.d1);
    if (more.refuted) answer.tree = std::move(more.tree), most = std::move(longer);
  }
  work.lemma = lemma(false, work.order, most, std::move(answer.tree));
  work.lemma->from = at.d1;
  return true;
}

/// Leaves out corners that the proof does not need. Those whose delays are cheap to raise are tried first.
void LemmaProver::leave_out(std::vector<std::size_t>& corners, std::vector<int>& most, bool wide, int order,
                            long budget, std::vector<proof::Node>& tree) {
  std::sort(corners.begin(), corners.end(),
            [&](std::size_t a, std::size_t b) { return cost_.delay[a] < cost_.delay[b]; });
  for (std::size_t i = 0; i < corners.size() && corners.size() > 1;) {
    const std::size_t j = corners[i];
    const int had = most[j];
    most[j] = -1;
    if (refutes(wide, order, most, budget, tree)) {
      const std::vector<char> still = of(wide).corners_used(tree);
      std::erase_if(corners, [&](std::size_t k) { return !still[k]; });
      for (std::size_t k = 0; k < most.size(); ++k)
        if (!still[k]) most[k] = -1;
    } else {
      most[j] = had;
      ++i;
    }
  }
}

/// Generalises a proof that a node's smallest delays do not hold together. It is reduced to the fewest corners, then to
/// the largest delays it holds for.
/// @param room  that the target leaves above the node's cost
JointLemma LemmaProver::learn(const JointNode& node, double room, bool wide, int order, std::vector<proof::Node> tree) {
  const std::vector<int>& d1 = node.d1;
  std::vector<int> most = d1;
  const std::vector<char> used = of(wide).corners_used(tree);
  std::vector<std::size_t> corners;
  for (std::size_t j = 0; j < most.size(); ++j) {
    if (used[j])
      corners.push_back(j);
    else
      most[j] = -1;
  }
  const long budget = attempt + static_cast<long>(tree.size());
  leave_out(corners, most, wide, order, budget, tree);
  std::vector<char> stuck(most.size(), 0);
  while (!stop_()) {
    std::size_t lowest = most.size();
    double least = std::numeric_limits<double>::infinity();
    for (const std::size_t j : corners) {
      const double more = cost_.delay[j] * (most[j] + 1 - d1[j]);
      if (!stuck[j] && more < least && more < room && !task_.corners[j].delay) least = more, lowest = j;
    }
    if (lowest == most.size()) break;
    ++most[lowest];
    if (!refutes(wide, order, most, budget, tree)) --most[lowest], stuck[lowest] = 1;
  }
  return lemma(wide, order, most, std::move(tree));
}

}  // namespace accdec::exact
