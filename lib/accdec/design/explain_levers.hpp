#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <accdec/machine/utilisation.hpp>
#include <accdec/task/task.hpp>

namespace accdec {

/// A number of a task that narrows what a design may do: the bound of a limit, a feed, the highest order, a given
/// delay.
struct Lever {
  std::string name;                                  ///< "acceleration x", "corner error A", "feed in A"
  std::string key;                                   ///< of a task file, as in studies: "axis.x.jerk_max_mm_s3"
  std::string unit;                                  ///< for people
  double per_si = 1.0;                               ///< value in `unit` = per_si * value in SI
  std::optional<LimitKind> kind;                     ///< none: no limit of the machine or the corner
  std::string axis, corner;                          ///< empty where it belongs to none
  double frequency_low = 0.0, frequency_high = 0.0;  ///< Hz, of vibration
  double value = 0.0;                                ///< SI, as the task has it
  double end = unlimited;                            ///< SI, the value that gives all the room there is
  double scale = 0.0;                                ///< SI, > 0: what shares are of; the value, or where that is 0
                                                     ///< 1 um, 0.1 % of residual, one sample
  bool upper = true;                                 ///< room is a larger value
  bool whole = false;                                ///< whole numbers only
  std::function<void(Task&, double)> set;            ///< SI

  /// The value with a share more room: value (1 +- share), not beyond `end`; whole numbers move by at least one.
  double moved(double share) const;
  /// Whether this use is one of the lever's limit.
  bool concerns(const LimitUse& use) const;
};

/// Levers that are moved together, by the same share: one alone, the same limit on all axes or at all corners, or all.
struct Room {
  std::string name;  ///< "jerk x", "jerk of all axes"
  std::string key;   ///< "axis.*.jerk_max_mm_s3"; empty where no one key sets them all
  std::vector<Lever> levers;

  Task given_to(const Task& task, double share) const;
  /// Every lever at its end.
  Task all_given_to(const Task& task) const;
};

/// Every limit of a task that is there, in the order of axes, corners and modes.
std::vector<Lever> limit_levers(const Task& task);

/// What besides a limit can stand in the way of a design: feeds (a pair of levers for every corner), the highest order,
/// given delays. Tasks with a given filter choose no order, and of many corners only the feeds of all are asked about.
std::vector<Room> other_rooms(const Task& task);
/// The highest order, as in `other_rooms`.
Lever order_lever(const Task& task);

/// Of more corners than this each by itself is not asked about, only all together: every question is a design.
inline constexpr std::size_t corners_apart_max = 1000;

/// One room for each lever; before those of a kind that has several, one that holds them all.
std::vector<Room> rooms_of(const std::vector<Lever>& levers);

}  // namespace accdec
