#include <cmath>

#include <accdec/exact/one_width.hpp>
#include <accdec/exact/search.hpp>

namespace accdec::exact {
std::shared_ptr<const Certificate> certify(const Proof& proof, const Task& task) {
  proof::BranchAndBound out;
  out.objective = task.design.objective;
  out.runs = task.design.runs;
  out.in_position = by_one_width(task);
  if (std::isfinite(proof.target)) out.bound_samples = proof.target;
  out.conflict = proof.conflict;
  // Splits that were tried but not taken leave multipliers that no leaf uses.
  std::vector<int> number(proof.multipliers.size(), -1);
  const auto use = [&](int& index) {
    if (index < 0) return;
    int& n = number[static_cast<std::size_t>(index)];
    if (n < 0) {
      out.multipliers.push_back(proof.multipliers[static_cast<std::size_t>(index)]);
      n = static_cast<int>(out.multipliers.size()) - 1;
    }
    index = n;
  };
  const auto renumbered = [&](proof::Node node) {
    if (auto* refuted = std::get_if<proof::Refuted>(&node)) {
      use(refuted->multipliers);
    } else if (auto* symmetric = std::get_if<proof::RefutedSymmetric>(&node)) {
      use(symmetric->multipliers);
      use(symmetric->shorter);
    }
    return node;
  };
  for (const proof::Node& node : proof.tree) out.tree.push_back(renumbered(node));
  for (proof::Lemma lemma : proof.lemmas) {
    for (proof::Node& node : lemma.tree) node = renumbered(node);
    out.lemmas.push_back(std::move(lemma));
  }
  return std::make_shared<Certificate>(Certificate{std::move(out)});
}

}  // namespace accdec::exact
