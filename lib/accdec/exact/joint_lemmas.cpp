#include <algorithm>
#include <limits>

#include <accdec/exact/joint_prover.hpp>

// How the joint proof finds its lemmas.

namespace accdec::exact {
namespace {

/// Linear programs that one attempt at a stronger lemma may use, in addition to twice the number of the lemma's own
/// proof.
constexpr long attempt = 40;

}  // namespace

/// @param wide  for filters of any order; else up to `order`
bool Joint::refutes(Prover& prover, bool wide, int order, const std::vector<int>& most, long budget,
                    std::vector<proof::Node>& tree) const {
  Search::Together answer = prover.of(wide).refute_together(order, most, budget, tree);
  if (answer.refuted) tree = std::move(answer.tree);
  return answer.refuted;
}

Joint::Lemma Joint::lemma(const Prover& prover, bool wide, int order, const std::vector<int>& most,
                          std::vector<proof::Node> tree) const {
  Lemma lemma;
  lemma.prover = prover.number;
  lemma.wide = wide;
  lemma.order = wide ? std::numeric_limits<int>::max() : order;
  lemma.tree = std::move(tree);
  for (std::size_t j = 0; j < most.size(); ++j)
    if (most[j] >= 0) lemma.delays.push_back({static_cast<int>(j), most[j]});
  return lemma;
}

/// Generalises a proof that these delays do not hold together: to the fewest corners and the largest delays it holds
/// for.
Joint::Lemma Joint::learn(Prover& prover, const Node& node, bool wide, int order, std::vector<proof::Node> tree) const {
  const std::vector<int>& d1 = node.d1;
  std::vector<int> most = d1;
  const std::vector<char> used = prover.of(wide).corners_used(tree);
  std::vector<std::size_t> corners;
  for (std::size_t j = 0; j < most.size(); ++j) {
    if (used[j])
      corners.push_back(j);
    else
      most[j] = -1;
  }
  const long budget = attempt + static_cast<long>(tree.size());
  // Corners whose delays are cheap to raise are tried first for leaving out.
  std::sort(corners.begin(), corners.end(),
            [&](std::size_t a, std::size_t b) { return cost_.delay[a] < cost_.delay[b]; });
  for (std::size_t i = 0; i < corners.size() && corners.size() > 1;) {
    const std::size_t j = corners[i];
    const int had = most[j];
    most[j] = -1;
    if (refutes(prover, wide, order, most, budget, tree)) {
      const std::vector<char> still = prover.of(wide).corners_used(tree);
      std::erase_if(corners, [&](std::size_t k) { return !still[k]; });
      for (std::size_t k = 0; k < most.size(); ++k)
        if (!still[k]) most[k] = -1;
    } else {
      most[j] = had;
      ++i;
    }
  }
  std::vector<char> stuck(most.size(), 0);
  const double room = target() - cost(node);
  while (!stop_()) {
    std::size_t lowest = most.size();
    double least = std::numeric_limits<double>::infinity();
    for (const std::size_t j : corners) {
      const double more = cost_.delay[j] * (most[j] + 1 - d1[j]);
      if (!stuck[j] && more < least && more < room && !task_.corners[j].delay) least = more, lowest = j;
    }
    if (lowest == most.size()) break;
    ++most[lowest];
    if (!refutes(prover, wide, order, most, budget, tree)) --most[lowest], stuck[lowest] = 1;
  }
  return lemma(prover, wide, order, most, std::move(tree));
}

}  // namespace accdec::exact
