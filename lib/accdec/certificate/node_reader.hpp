#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include <accdec/certificate/checked_rows.hpp>

namespace accdec {

/// Reads the nodes of a proof's trees in their order.
class NodeReader {
 public:
  /// @param stop  asked before every node; the reference is kept
  explicit NodeReader(const std::function<bool()>& stop) : stop_(stop) {}
  void begin(std::span<const proof::Node> tree) { tree_ = tree, next_ = 0; }
  /// @throws Rejected if there is none, the tree is too deep, or the time is over
  const proof::Node& next(int depth) {
    if (next_ >= tree_.size()) throw Rejected("the tree is cut off: not every pair of order and delay is refuted");
    if (depth > 1000) throw Rejected("the tree is too deep");
    if (stop_ && stop_()) throw Rejected("it could not be checked in the time allowed");
    return tree_[next_++];
  }
  /// @throws Rejected if nodes are left
  void require_end() const {
    if (next_ != tree_.size()) throw Rejected("the tree goes on after its end");
  }

 private:
  const std::function<bool()>& stop_;
  std::span<const proof::Node> tree_;
  std::size_t next_ = 0;
};

}  // namespace accdec
