#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <accdec/simulate.hpp>

namespace accdec {

/// Radius in m of the tube around every block: the larger tolerance of the joints at its ends. Stops grant none.
/// Blocks that go straight on have one tube, by the joints at both ends of it.
std::vector<double> tube_radii(const Toolpath& path);

/// The same within Toolpath::contour_max: how far in m a sample may be off its block.
std::vector<double> allowed_off(const Toolpath& path);

/// Feed of every block in m/s; unlimited for rapid moves, which the velocity limits of axes bound.
std::vector<double> feed_limits(const Toolpath& path);

/// Follows a free motion by its positions. Every sample must lie in the tube of its block. No step may be longer than
/// the faster feed of the blocks at its ends allows. Stops and dwells must be kept.
class TubeCheck {
 public:
  TubeCheck(const Toolpath& path, double sample_period);
  /// The next sample after the start and its block.
  void look(const double* position, std::size_t block);
  /// After the last sample. Empty if all holds, else the first that does not.
  std::string finish();

 private:
  void wrong(const std::string& what, std::size_t block);
  void look_stops(std::size_t block);

  const Toolpath& path_;
  double period_;
  std::vector<double> radius_, feed_, before_;
  std::vector<std::int64_t> rested_;  // of every block: samples exactly at its end
  std::size_t block_ = 0;
  std::int64_t sample_ = 0, rested_first_ = 0;
  bool left_ = false;  // the first point
  std::string wrong_;
};

}  // namespace accdec
