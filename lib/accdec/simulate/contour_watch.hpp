#pragma once

#include <cstdint>
#include <vector>

#include <accdec/simulate/command_stream.hpp>
#include <accdec/simulate/simulate.hpp>

namespace accdec {

/// The largest distance of a motion from the programmed path: of the polyline through its samples from the nearest of
/// the blocks that act on it. Behind a filter, these are the blocks commanded within its length before.
class PathContour {
 public:
  /// For a trajectory, whose samples say on which blocks they may be. Refers to the path.
  explicit PathContour(const Toolpath& path) : PathContour(path, 0) {}
  /// Refers to the path. @param reach  samples by which the motion may be behind the command
  PathContour(const CommandTiming& timing, std::int64_t reach, std::size_t first, std::size_t last);
  /// The next samples, as SampleSink has them.
  void look(std::int64_t number, std::int64_t count, const double* const* position);
  /// A later sample of a trajectory, straight on from the one before. @param first, last  blocks that it may be on
  void look(std::int64_t number, const double* position, std::size_t first, std::size_t last);
  LimitUse use() const;
  /// Adds the use of the limit, and where it is broken.
  void finish(Simulation& result) const;
  /// Points where it is broken, ascending.
  std::vector<Simulation::OffPath> off() const;

 private:
  struct Nearest {
    std::size_t block = 0;
    double distance = 0.0;
  };
  PathContour(const Toolpath& path, std::size_t first);
  Nearest nearest(const double* point) const;
  void look(const double* now);
  void note(const Nearest& found, const double* point);
  void between(const double* from, const double* to, int depth);

  const Toolpath& path_;
  std::size_t n_, first_, last_ = 0;
  std::int64_t reach_ = 0;
  BlockTimes times_;
  std::size_t low_, high_;  // the blocks that act on the samples seen last
  std::size_t oldest_ = 0;  // of the blocks that the trajectory's last sample may be on
  std::int64_t number_ = 0;
  std::vector<double> before_;
  std::size_t block_before_;
  double worst_ = 0.0;
  std::size_t worst_block_ = 0;
  std::int64_t worst_sample_ = 0;
  std::vector<Simulation::OffPath> off_;
};

/// The contour of a whole trajectory.
PathContour contour_of(const Toolpath& path, const Trajectory& trajectory, double sample_period);

}  // namespace accdec
