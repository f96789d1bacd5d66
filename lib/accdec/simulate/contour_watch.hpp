#pragma once

#include <cstdint>
#include <vector>

#include <accdec/simulate/command_stream.hpp>
#include <accdec/simulate/simulate.hpp>

namespace accdec {

/// The largest distance of a motion from the programmed path: of the polyline through its samples from the nearest of
/// the blocks that act on it. These are the blocks commanded within the filter's length before.
class PathContour {
 public:
  /// Refers to the path. @param reach  samples by which the motion may be behind the command
  PathContour(const CommandTiming& timing, std::int64_t reach, std::size_t first, std::size_t last);
  /// The next samples, as SampleSink has them.
  void look(std::int64_t number, std::int64_t count, const double* const* position);
  /// Adds the use of the limit, and where it is broken.
  void finish(Simulation& result) const;

 private:
  struct Nearest {
    std::size_t block = 0;
    double distance = 0.0;
  };
  Nearest nearest(const double* point) const;
  void note(const Nearest& found, const double* point);
  void between(const double* from, const double* to, int depth);

  const Toolpath& path_;
  std::int64_t reach_;
  std::size_t n_, first_, last_;
  BlockTimes times_;
  std::size_t low_, high_;  // the blocks that act on the samples seen last
  std::int64_t number_ = 0;
  std::vector<double> before_;
  std::size_t block_before_;
  double worst_ = 0.0;
  std::size_t worst_block_ = 0;
  std::int64_t worst_sample_ = 0;
  std::vector<Simulation::OffPath> off_;
};

}  // namespace accdec
