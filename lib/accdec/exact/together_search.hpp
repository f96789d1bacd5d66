#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <vector>

#include <accdec/exact/workbench.hpp>

namespace accdec::exact {

/// A window (window.hpp), and the position in it at which each corner is closest if it is the anchor. The anchor is the
/// first corner of `order_of_anchors` that counts.
struct Window {
  int order = 0;  ///< 0: there is none
  std::vector<int> at;
  std::vector<int> anchors;  ///< corners with a tolerance, the tightest first

  /// @param most  < 0 where a corner does not count. @return -1: there is none
  int anchor(const std::vector<int>& most) const {
    const auto found =
        std::find_if(anchors.begin(), anchors.end(), [&](int j) { return most[static_cast<std::size_t>(j)] >= 0; });
    return found == anchors.end() ? -1 : *found;
  }
};

/// Asks whether one filter holds several corners with given longest delays, whatever they cost. The joint proof asks
/// this, see joint.hpp. Only the samples are open here, and the linear program's own filter tells which of them to
/// split. No symmetry.
class TogetherSearch {
 public:
  /// @param window  if given: for filters of any order
  TogetherSearch(const Task& task, std::function<bool()> stop, Window window = {});

  struct Answer {
    bool refuted = false, holds = false;  ///< neither: stopped, or rounding decides
    std::vector<proof::Node> tree;        ///< refuted: the proof; its multipliers are in `multipliers()`
  };
  /// Whether a filter of at most this order holds these corners with delays up to `most` (one per corner; < 0: the
  /// corner does not count). Ends after `budget` linear programs. Filters met on the way are offered.
  /// @param like  a proof of this search for other delays, whose splits are taken first; empty: there is none
  /// @param from  least delays, one per corner; empty: any
  Answer refute(int order, const std::vector<int>& most, long budget, const std::vector<proof::Node>& like = {},
                const std::vector<int>& from = {});
  /// The corners that matter in a proof.
  std::vector<char> corners_used(const std::vector<proof::Node>& tree) const;
  const std::vector<Multipliers>& multipliers() const { return bench_.draft().multipliers(); }
  /// Forgets multipliers from this one on, except those of a proof and some used lately.
  void forget(std::size_t from, const std::vector<proof::Node>& tree) { bench_.draft().forget(from, tree); }

  /// The shortest design known.
  std::optional<Candidate>& best() { return bench_.designs.best; }
  long linear_programs() const { return bench_.linear_programs(); }

 private:
  BoxState refute(Box box, int depth);
  BoxState refute_like(const std::vector<proof::Node>& tree, std::size_t node, const Box& whole, int depth);
  BoxState both_like(const std::vector<proof::Node>& tree, std::size_t node, const Box& whole, int depth);
  std::optional<proof::Node> split(const Filter& filter, const Box& box) const;
  bool blend_holds(const Filter& filter, const Box& box, std::size_t corner, int delay) const;

  Workbench bench_;
  Window window_;
  std::vector<char> among_;  ///< corners that count
};

}  // namespace accdec::exact
