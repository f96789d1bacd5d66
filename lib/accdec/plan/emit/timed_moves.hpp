#pragma once

#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include <accdec/gcode/number.hpp>
#include <accdec/program.hpp>

namespace accdec {

/// Moves of an unused axis that wait, see emit_for_linuxcnc.
class TimedMoves {
 public:
  /// @param axis  0: there are none
  explicit TimedMoves(char axis) : axis_(axis) {}
  bool used() const { return axis_ != 0; }

  void require(const ProgramResult& result) const {
    const Toolpath& path = result.plan.path;
    for (const std::size_t a : path.axes) {
      if (program_axes[a] == axis_)
        throw std::invalid_argument(fmt::format("axis {} cannot time delays: the program moves it", axis_));
    }
    for (const auto& passed : path.kept_words) {
      if (passed.words.starts_with("G4"))
        throw std::invalid_argument("the program dwells (G4), which LinuxCNC does not time in samples");
    }
    for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
      if (result.plan.delay(b) == lost_at_ends)
        throw std::invalid_argument(
            fmt::format("block {} has a delay of {} samples, which timed moves cannot have: they have 1, 3, 4, ..",
                        b + 1, lost_at_ends));
    }
  }

  std::string remark() const {
    return fmt::format(
        "(for LinuxCNC, with the filter behind joint.N.motor-pos-cmd: moves of axis {} time the delays)\n", axis_);
  }
  std::string begin() const { return used() ? fmt::format("G0 {}0\n", axis_) : ""; }

  /// Away from 0, or back.
  std::string wait(int delay, double period) {
    const int samples = delay - lost_at_ends;
    if (samples < 1) return "";
    away_ = !away_;
    return fmt::format("G93\nG1 {}{} F{}\nG94\n", axis_, away_ ? "0.01" : "0",
                       plain_number(60.0 / (samples * period), 9));
  }

 private:
  /// Samples that the ends of a block and of the move behind it take.
  static constexpr int lost_at_ends = 2;

  char axis_;
  bool away_ = false;
};

}  // namespace accdec
