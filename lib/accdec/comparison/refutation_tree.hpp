#pragma once

#include <memory>
#include <utility>
#include <vector>

#include <accdec/certificate.hpp>

namespace accdec::comparison {

/// The tree of a refutation while its parts are refuted, in any order. Node 0 is the whole.
class RefutationTree {
 public:
  RefutationTree() : nodes_(1) {}
  int keep(proof::Multipliers set) {
    sets_.push_back(std::move(set));
    return static_cast<int>(sets_.size()) - 1;
  }
  void close(int node, proof::Node refuted) { nodes_[static_cast<std::size_t>(node)].what = std::move(refuted); }
  /// @return the nodes of both parts
  std::pair<int, int> split(int node, proof::Node split);
  /// @param task  the limits that were refuted
  std::shared_ptr<const Certificate> certificate(const Task& task) const;

 private:
  struct Entry {
    proof::Node what{};
    int first = -1, second = -1;  ///< of a split
  };
  std::vector<Entry> nodes_;
  std::vector<proof::Multipliers> sets_;
};

}  // namespace accdec::comparison
