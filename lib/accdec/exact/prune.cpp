#include <algorithm>
#include <map>

#include <accdec/exact/parts.hpp>
#include <accdec/exact/search.hpp>

namespace accdec::exact {
namespace {

class Pruner {
 public:
  Pruner(const LimitModel& model, const Proof& proof) : model_(model), from_(proof) { to_.target = proof.target; }

  std::optional<Proof> run(const Box& root) {
    copy(root);
    if (!holds_) return std::nullopt;
    for (std::size_t i = 0; i < to_.multipliers.size(); ++i) {
      Multipliers& y = to_.multipliers[i];
      std::size_t row = 0;
      std::erase_if(y, [&](const auto&) { return used_[i][row++] == 0; });
    }
    return std::move(to_);
  }

 private:
  void copy(const Box& whole) {
    Box box = whole;
    if (!tighten(model_.task(), from_.target, box) || no_sample(box)) {
      skip();
      to_.tree.push_back(proof::TooLong{});
      return;
    }
    box.end_samples();
    if (!model_.convex() && !model_.shrink(box)) {
      skip();
      to_.tree.push_back(proof::Unreachable{});
      return;
    }
    const proof::Node& node = from_.tree[next_++];
    if (const auto* refuted = std::get_if<proof::Refuted>(&node)) {
      leaf(refuted->multipliers, box);
      return;
    }
    to_.tree.push_back(node);
    if (!splits_corner(node)) {
      // The part was narrowed away under the longer target, so it is empty under the shorter one.
      holds_ = false;
      return;
    }
    const auto [first, second] = parts(whole, node);
    copy(first);
    copy(second);
  }

  /// Whether the orders left end before the samples begin.
  static bool no_sample(const Box& box) {
    for (std::size_t j = 0; j < box.corners.size(); ++j) {
      const CornerBox& c = box.corners[j];
      if (c.k1 > std::min(c.k2, box.last_sample(j)) || c.c1 > box.last_sample(j)) return true;
    }
    return false;
  }

  void leaf(int multipliers, const Box& box) {
    holds_ = holds_ && refutation(model_, from_.multipliers[static_cast<std::size_t>(multipliers)], box) > 0.0;
    to_.tree.push_back(proof::Refuted{kept(multipliers, box)});
  }

  /// Skips one node and all nodes below it.
  void skip() {
    if (!splits_corner(from_.tree[next_++])) return;
    skip();
    skip();
  }

  /// Number of these multipliers in the new proof; marks the rows that matter in the box.
  int kept(int index, const Box& box) {
    const Multipliers& y = from_.multipliers[static_cast<std::size_t>(index)];
    const auto [at, added] = index_.emplace(index, static_cast<int>(to_.multipliers.size()));
    if (added) to_.multipliers.push_back(y), used_.emplace_back(y.size(), 0);
    std::vector<char>& used = used_[static_cast<std::size_t>(at->second)];
    for (std::size_t r = 0; r < y.size(); ++r) {
      if (used[r] == 0 && has_terms(y[r].row, box)) used[r] = 1;
    }
    return at->second;
  }

  /// Rows at samples past the end of a shorter filter have no terms.
  bool has_terms(const proof::Row& id, const Box& box) const {
    if (std::holds_alternative<proof::Error>(id) || std::holds_alternative<proof::Vibration>(id) ||
        std::holds_alternative<proof::Contour>(id))
      return true;
    if (const auto* response = std::get_if<proof::Response>(&id);
        response && response->sample > box.order + box.longer())
      return false;
    if (const auto chord = chord_of(id); chord && chord->sample > model_.chords.last_sample(chord->family, box))
      return false;
    const SparseRow row = model_.row(id, box);
    return !row.no_terms() || row.constant > 1.0;
  }

  const LimitModel& model_;
  const Proof& from_;
  Proof to_;
  std::size_t next_ = 0;
  std::map<int, int> index_;
  std::vector<std::vector<char>> used_;  // by multipliers of the new proof and row
  bool holds_ = true;
};

}  // namespace

std::optional<Proof> pruned(const LimitModel& model, const Box& root, const Proof& proof) {
  return Pruner(model, proof).run(root);
}

}  // namespace accdec::exact
