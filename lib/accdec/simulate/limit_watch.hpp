#pragma once

#include <cstdint>
#include <vector>

#include <accdec/machine.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/simulate.hpp>
#include <accdec/simulate/motion_buffer.hpp>

namespace accdec {

/// Keeps the worst use of every finite axis limit while the motion passes.
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
    const AxisLimit* limit = nullptr;
    std::size_t axis = 0;
    double bound = 0.0;
    double value = 0.0;
    std::int64_t sample = 0;
    std::size_t block = 0;
  };
  void order_broken(std::size_t known);
  double value_at(const Worst& worst, double velocity, double acceleration, double jerk) const;

  /// Block commanded at an index of the buffer.
  std::size_t block_at(std::int64_t index, std::size_t current) const;

  const Machine* machine_;
  double period_;
  bool blame_;
  std::vector<std::uint32_t> broken_;
  std::vector<Worst> worst_;
  std::vector<std::pair<std::int64_t, std::size_t>> marks_;  // index, block
};

}  // namespace accdec
