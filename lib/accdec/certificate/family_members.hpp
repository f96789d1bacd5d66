#pragma once

#include <functional>
#include <span>
#include <utility>
#include <vector>

#include <accdec/task.hpp>

// Internal to the room: the members of a controller's families, as the checker of proofs builds them.

namespace accdec {

/// A filter with what its legs do, sample by sample.
struct FamilyMember {
  std::vector<double> taps;                ///< sum 1
  std::vector<double> gone;                ///< B_k, k = 0 .. N + 1
  std::vector<double> left;                ///< 1 - B_k, summed from the far end
  std::vector<double> way_left, way_gone;  ///< full-speed samples: p(k) and q(k), k = 0 .. N + 1

  int order() const { return static_cast<int>(taps.size()) - 1; }
};

/// @param taps  in any scale
FamilyMember member_of(std::vector<double> taps);

/// Taps of a family with a length and a real number, in any scale. @param number  SI: time constant, alpha, cut-off
std::vector<double> grid_taps(SettingFamily family, int order, double number, double period);

/// Taps of endless poles in series, cut off where at most 1e-4 of their step is left, in any scale.
/// @param constants  samples; 0: off  @param most  the order of longer ones
std::vector<double> taps_of_poles(const std::vector<int>& constants, int most);

/// Whether a controller's stage takes a length of so many samples.
bool settable(const SettableStage& stage, int samples, double period);

/// Moving averages in series with impulses behind them, before their taps are made.
struct AveragesOutline {
  std::span<const int> lengths;                              ///< samples; 1: off
  std::span<const std::pair<std::size_t, double>> impulses;  ///< sample and weight, of any sum; one: no shaper
};

/// Visits every member of a family with an order in the task's bounds and below `order_end`.
/// @param visit  the member, and what it is in words
/// @param skip   whether a member is left out; its taps are then never made
void visit_family(const Task& task, SettingFamily family, int order_end,
                  const std::function<void(const FamilyMember&, const std::string&)>& visit,
                  const std::function<bool(const AveragesOutline&)>& skip = {});

}  // namespace accdec
