#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <accdec/filter.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/simulate/simulate.hpp>
#include <accdec/task/blend_limits.hpp>

namespace accdec {

/// The changes of a round of repair, ascending.
struct RepairWork {
  struct Slow {
    std::size_t block;
    double factor;  ///< on its duration, > 1
  };
  std::vector<std::size_t> raise;  ///< joints whose delay is too short
  std::vector<Slow> slow;          ///< blocks whose feed is too high
  bool empty() const { return raise.empty() && slow.empty(); }
};

/// Changes delays and feeds and simulates again only the blocks around them.
class Repair {
 public:
  /// @param machine  nullptr: limits are left alone
  /// @param path            durations of its blocks may grow
  /// @param delays, errors  of the whole program, kept by reference and kept up to date
  Repair(Toolpath& path, const Filter& filter, double sample_period, const Machine* machine, std::vector<int>& delays,
         std::vector<double>& errors);

  /// A corner whose error breaks its bound is raised. Around a smooth joint with such an error, the feed is lowered. On
  /// curves the error grows with the square of the feed, whereas a command that rests for a sample again and again uses
  /// up the jerk limit. For every block blamed for a broken limit, the corner before it is raised. If its delay is
  /// already longer than the filter, the nearest earlier one that can still be raised is taken. Inside curves the feed
  /// is also lowered. If there is neither, a block shorter than the filter breaks the limit by itself, by its start and
  /// its stop together. It is slowed. So is a longer one that is faster than the filter can start or stop: inside a leg
  /// that does not matter until a joint is delayed. Joints not repaired after twenty rounds are raised, smooth ones
  /// too.
  RepairWork failing(const Simulation& simulation) const;
  /// One round: makes changes, simulates around them again, and returns what fails there now. @param step  samples to
  /// raise by
  RepairWork round(const RepairWork& work, int step);
  /// Lowers the delay of a joint, not below `least`, as far as everything around it still holds.
  void lower(std::size_t joint, int least);

 private:
  struct Range {
    std::size_t first, last;            // blocks to simulate, whole runs
    std::size_t eval_first, eval_last;  // joints that a change may affect, seen with enough motion on both sides
  };
  Range around(std::size_t joint) const;
  void simulate(const Range& range);
  void judge(std::size_t first, std::size_t last, RepairWork& failing) const;
  /// @param use  of a bound on a distance, > 1
  void mend(std::size_t joint, double use, RepairWork& work) const;
  /// Mends where the motion leaves the path. If longer delays are no help, the blocks there are slowed.
  void mend(const Simulation::OffPath& off, RepairWork& work) const;
  void blame(std::uint32_t block, RepairWork& work) const;
  /// Largest factor <= 1 on its feed with which a block surely starts and stops within the limits.
  double start_factor(std::size_t block) const;
  /// False if there was nothing to slow.
  bool slow_around(std::size_t joint, double factor, RepairWork& work) const;
  void accept(std::size_t first, std::size_t last);
  /// The delay of a joint, longer by `step` samples, or by what the control has.
  int raised(std::size_t joint, int step) const;

  Toolpath& path_;
  std::vector<double> first_duration_;  // s, of every block
  const Filter& filter_;                // of the command
  const FilterBehind behind_;
  const Machine* machine_;
  std::optional<BlendLimits> limits_;  // of that machine
  CommandTiming timing_;
  std::vector<int>& delays_;
  std::vector<double>& errors_;
  std::vector<double> scratch_;
  Simulation found_;  // in the part simulated last
  int rounds_ = 0;
  int apart_;    // delay from which the commands of a joint's legs do not overlap
  int settled_;  // and from which their motions do not
};

}  // namespace accdec
