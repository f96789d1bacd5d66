#pragma once

#include <optional>
#include <vector>

#include <accdec/filter.hpp>
#include <accdec/task.hpp>

namespace accdec {

/// Whether two filters are one up to rounding.
bool same_taps(const Filter& a, const Filter& b);

/// One setting of a family.
struct SettableMember {
  SettingFamily family = SettingFamily::averages;
  /// Samples, one a stage; 1, or 0 of a pole, is off. With a real number: the length and the multiple of its step.
  std::vector<int> lengths{};
  FilterSpec spec{};

  int order() const { return spec.full_order(); }
  /// Different for different members.
  std::vector<int> key() const;
};

/// The members of the families that a task's settings name, within its orders, for searches that try one after
/// another. Keeps the reference.
class SettableMembers {
 public:
  static constexpr long most = 100'000;  ///< members listed

  explicit SettableMembers(const Task& task);
  /// Members of all families: orders that grow by a third, with stages of different shares.
  std::vector<SettableMember> spread() const;
  /// The nearest members to a filter; none if it is no cascade of averages.
  std::vector<SettableMember> like(const FilterSpec& filter) const;
  /// The member with the taps of a filter; none if no setting gives them.
  std::optional<SettableMember> same(const FilterSpec& filter) const;
  /// The members with which a start or stop at a feed keeps to its limits: v/a and a/j. @param jerk  unlimited: none
  std::vector<SettableMember> at_feed(double velocity, double acceleration, double jerk) const;
  /// Members with one or two times changed by about `step` samples.
  std::vector<SettableMember> around(const SettableMember& member, int step) const;
  /// An eighth of the longest time, samples, or a few.
  int coarse_step(const SettableMember& member) const;
  /// All members, the shortest filters first; at most `most`.
  const std::vector<SettableMember>& all() const { return all_; }
  /// Puts those first that differ least from a member.
  void sort_near(const SettableMember& member);
  /// Whether that is all.
  bool listed() const { return listed_; }
  /// In the controller's words.
  ChosenSettings chosen(const SettableMember& member) const;

 private:
  std::vector<int> options(SettingFamily family, std::size_t stage) const;
  /// With every time the nearest that can be set; empty where its order is out of bounds.
  void add(SettingFamily family, const std::vector<double>& lengths, double pair_delay,
           std::vector<SettableMember>& members) const;
  void add_grid(SettingFamily family, int length, double multiple, std::vector<SettableMember>& members) const;
  void list(SettingFamily family);
  void list_grid(SettingFamily family);
  void list_poles();
  const ShaperInfo* shaper_behind(SettingFamily family) const;  ///< null: none
  /// The delay between impulses that is next to this one, longer or shorter.
  double moved_delay(double delay, int by) const;
  std::vector<SettingFamily> families() const;
  std::size_t stages(SettingFamily family) const;

  const Task& task_;
  std::vector<std::vector<int>> averages_, poles_;  // of each stage, rising, off first
  std::vector<double> delays_;                      // between a shaper's impulses, rising; empty: no shaper
  std::vector<SettableMember> all_;
  bool listed_ = true;
};

}  // namespace accdec
