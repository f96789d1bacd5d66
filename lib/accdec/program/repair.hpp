#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <accdec/motion/filter.hpp>
#include <accdec/program/simulate.hpp>

namespace accdec {

/// What a round of repair has to change, ascending.
struct RepairWork {
  std::vector<std::size_t> raise;  ///< joints whose delay is too short
  std::vector<std::size_t> slow;   ///< blocks that break a limit however long the delays around them are
  bool empty() const { return raise.empty() && slow.empty(); }
};

/// Changes delays and feeds and re-simulates only what is around them.
class Repair {
 public:
  /// @param machine  nullptr: limits are left alone
  /// @param path            durations of its blocks may grow
  /// @param delays, errors  of the whole program, kept by reference and kept up to date
  Repair(Toolpath& path, const Filter& filter, double sample_period, const Machine* machine, std::vector<int>& delays,
         std::vector<double>& errors);

  /// Raises joints whose error breaks its bound, and for every block blamed for a broken limit the joint before it, or, if that is
  /// longer than the filter already, the nearest one before that still can be lengthened. Where there is none a block shorter than
  /// the filter breaks the limit by itself, its start and its stop together: it is slowed.
  RepairWork failing(std::span<const std::uint32_t> broken) const;
  /// One round: changes, re-simulates around the changes, and returns what fails there now. @param step  samples to raise by
  RepairWork round(const RepairWork& work, int step);
  /// Lowers the delay of a joint, not below `least`, as far as everything around it holds.
  void lower(std::size_t joint, int least);

 private:
  struct Range {
    std::size_t first, last;            // blocks to simulate, whole runs
    std::size_t eval_first, eval_last;  // joints that a change may touch, seen with enough motion on both sides
  };
  Range around(std::size_t joint) const;
  void simulate(const Range& range);
  void judge(std::size_t first, std::size_t last, RepairWork& failing) const;
  void blame(std::uint32_t block, RepairWork& work) const;
  void accept(std::size_t first, std::size_t last);

  Toolpath& path_;
  const Filter& filter_;
  const Machine* machine_;
  CommandTiming timing_;
  std::vector<int>& delays_;
  std::vector<double>& errors_;
  std::vector<double> scratch_;
  std::vector<std::uint32_t> broken_;
  int apart_;  // delay from which the legs of a joint do not overlap
};

}  // namespace accdec
