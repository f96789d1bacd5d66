#pragma once

#include <functional>
#include <set>
#include <span>
#include <vector>

#include <accdec/family.hpp>

namespace accdec {

/// Searches the member of least cost of a family of averages. Only values of the cost are known, and each is expensive,
/// for example the time of a whole program. The caller offers starts; then smaller and smaller steps around the best
/// are tried. No member is tried twice. The minimum is not proved.
///
/// FamilySearch is another search on purpose: it proves the best member. Its refusals, its bounds on ranges and its
/// sums of cascades come from a task's limits on every corner. A cost with no more than values has none of these. Both
/// share the families and their members; one class would hold both loops.
class TrialSearch {
 public:
  using Cost = std::function<double(const Filter& filter)>;  ///< infinite for a filter that will not do

  struct Bounds {
    int order_min = 0, order_max = 0;
    bool keep_single = false;  ///< an average of one tap stays one: the cost has no use for another average
  };
  /// @param family  with averages, without pairs; it must outlive the object
  /// @param stop    asked before every trial: nothing is tried any more; may be empty
  TrialSearch(const Family& family, const Bounds& bounds, Cost cost, std::function<bool()> stop = {});

  /// Tries one member, longest average first; another order of lengths and orders out of bounds are passed over.
  /// @return whether it is the best so far
  bool offer(const std::vector<int>& lengths);
  /// Steps around the best, each average alone and all together: first a part of the longest, then half of it ..
  /// @param parts  the first step is the longest average over this
  void refine(int parts);

  bool found() const { return !best_.empty(); }
  const std::vector<int>& best() const { return best_; }  ///< lengths; empty if none is found
  Filter filter() const { return make_filter(family_.member(best_)); }
  double cost() const { return cost_of_best_; }  ///< infinite if none is found
  long tried() const { return static_cast<long>(seen_.size()); }

 private:
  bool stopped() const { return stop_ && stop_(); }

  const Family& family_;
  Bounds bounds_;
  Cost cost_;
  std::function<bool()> stop_;
  std::set<std::vector<int>> seen_;
  std::vector<int> best_;
  double cost_of_best_;
};

}  // namespace accdec
