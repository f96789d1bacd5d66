#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <accdec/families/quick_refusals.hpp>
#include <accdec/families/slow_members.hpp>
#include <accdec/family.hpp>
#include <accdec/task/delay_kinds.hpp>
#include <accdec/task/objective.hpp>

namespace accdec {

/// Internal to the room: the search behind `best_member`, of one family for one task.
class FamilySearch {
 public:
  /// Keeps references: both arguments must outlive the object.
  /// @param below  samples: only what costs less is looked for
  /// @param members  visits the members of an order that are looked at; empty: all of the family
  using Members = std::function<void(int order, const MemberVisitor& visit)>;
  FamilySearch(const Task& task, const Family& baseline, double below = unlimited, Members members = {});
  /// @param stop  asked again and again, within an order, too
  void run(std::function<bool()> stop = {});
  bool complete() const { return !late_; }  ///< false if it was stopped: then the best is not known

  const std::optional<FilterSpec>& best() const { return best_; }
  const KindDelays& delays() const { return delays_; }
  double cost() const { return best_ ? cheapest_ : unlimited; }  ///< samples
  long tried() const { return tried_; }                          ///< filters built, and ranges bounded

 private:
  bool late();
  /// Better by more than the rounding of sums of weights.
  bool better(double cost) const { return cost < cheapest_ * (1.0 - 1e-12); }
  void order(int order);
  void search_parameter(const FilterSpec& spec, const RealParameter& parameter);
  void offer(const FilterSpec& spec);
  void offer_cascade(std::span<const int> lengths, const FilterSpec& spec);
  bool cheap_refusal(std::span<const int> lengths, const FilterSpec& spec);
  bool too_slow(std::span<const int> lengths, const FilterSpec& spec);
  bool too_slow(const Cascade& cascade, int order, int spare) const;

  const Task& task_;
  std::shared_ptr<const Task> on_taps_;  ///< the limits by which filters are refused before their motion is looked at
  const Family& family_;
  Members members_;
  LinearCost cost_;
  bool by_feed_;                   ///< corners may be passed at a part of the feed: an error then needs no delay
  std::vector<int> least_delays_;  ///< lower bounds for all filters within the limits
  QuickRefusals refusals_;
  SlowMembers slow_;
  std::function<bool()> stop_now_;
  bool late_ = false;
  double cheapest_;
  std::optional<FilterSpec> best_;
  KindDelays delays_;
  long tried_ = 0, visited_ = 0;
};

}  // namespace accdec
