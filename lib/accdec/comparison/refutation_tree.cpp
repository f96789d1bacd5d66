#include <accdec/comparison/refutation_tree.hpp>

namespace accdec::comparison {

std::pair<int, int> RefutationTree::split(int node, proof::Node split) {
  const int first = static_cast<int>(nodes_.size()), second = first + 1;
  nodes_[static_cast<std::size_t>(node)] = {std::move(split), first, second};
  nodes_.resize(nodes_.size() + 2);
  return {first, second};
}

std::shared_ptr<const Certificate> RefutationTree::certificate(const Task& task) const {
  proof::BranchAndBound proof;
  proof.objective = task.design.objective;
  if (proof.objective == Objective::cycle) proof.runs = task.design.runs;
  proof.multipliers = sets_;
  if (task.design.symmetric) proof.tree.emplace_back(proof::SymmetricOrders{});
  for (std::vector<int> left{0}; !left.empty();) {
    const Entry& entry = nodes_[static_cast<std::size_t>(left.back())];
    left.pop_back();
    proof.tree.push_back(entry.what);
    if (entry.first < 0) continue;
    left.push_back(entry.second);
    left.push_back(entry.first);
  }
  return std::make_shared<Certificate>(Certificate{std::move(proof)});
}

}  // namespace accdec::comparison
