#pragma once

#include <cstdint>
#include <vector>

#include <accdec/machine.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/simulate.hpp>
#include <accdec/simulate/motion_buffer.hpp>

namespace accdec {

/// Keeps the worst use of every finite limit of an axis and of the shared supply while the motion passes.
class LimitWatch {
 public:
  /// @param machine  nullptr: nothing is watched
  LimitWatch(const Machine* machine, std::size_t dimensions, double sample_period, bool blame);

  /// From this index of the buffer on block `block` is commanded.
  void mark(std::int64_t index, std::size_t block) {
    if (!worst_.empty() && (marks_.empty() || marks_.back().second != block)) marks_.emplace_back(index, block);
  }
  /// Reads the new samples of the buffer.
  void look(const MotionBuffer& motion, std::size_t block);
  /// Reads a stretch of steady motion at u m per sample.
  void steady(const MotionBuffer& motion, const double* u, std::size_t block);
  void finish(std::vector<LimitUse>& limits, const Toolpath& path) const;
  /// With `blame`: every block during whose command a limit was broken, ascending.
  const std::vector<std::uint32_t>& broken() const { return broken_; }

 private:
  struct Worst {
    LimitKind kind{};
    const AxisLimit* limit = nullptr;  // none: of the supply
    std::size_t axis = 0;
    double bound = 0.0;
    double value = 0.0;
    std::int64_t sample = 0;
    std::size_t block = 0;
  };
  void look_axes(const MotionBuffer& motion, std::size_t block);
  void look_supply(const MotionBuffer& motion, std::size_t block);
  /// Takes the value of a new sample. @param known  number of broken blocks before the new samples
  void take(Worst& worst, double value, bool blame, const MotionBuffer& motion, std::int64_t index, std::size_t block,
            std::size_t known);
  void order_broken(std::size_t known);
  /// @param velocity, acceleration, jerk  in m and samples
  AxisState state_at(std::size_t axis, double velocity, double acceleration, double jerk) const;

  /// Block commanded at an index of the buffer.
  std::size_t block_at(std::int64_t index, std::size_t current) const;

  const Machine* machine_;
  double period_, still_;  // s; m/s, up to which an axis stands still
  bool blame_;
  std::vector<std::uint32_t> broken_;
  std::vector<Worst> worst_;
  std::vector<std::pair<std::int64_t, std::size_t>> marks_;  // index, block
};

}  // namespace accdec
