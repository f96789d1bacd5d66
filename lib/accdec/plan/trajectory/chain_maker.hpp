#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include <accdec/plan/trajectory/available.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// Shares of the limits, lowered by repair.
struct ProfileShares {
  std::vector<float> acceleration;  ///< by place: 2 b for leg b, 2 b + 1 for the corner after it
  std::vector<float> speed;         ///< by corner
  explicit ProfileShares(std::size_t blocks) : acceleration(2 * blocks, 1.0F), speed(blocks + 1, 1.0F) {}
};

/// Makes the chain of a path, and makes parts of it again after shares have changed.
class ChainMaker {
 public:
  /// References are kept.
  ChainMaker(const Toolpath& path, const AvailableAcceleration& available);

  /// Makes the whole chain. Corners whose shares have not changed stay as they are.
  const ProfileChain& make(const ProfileShares& shares);
  /// Makes legs first .. last again with the same speeds at both ends. They are slowed so that all samples after them
  /// are the same, only whole samples later. Then these stay verified. False, with nothing changed, if this cannot be
  /// driven: then more legs must change.
  /// @param phases  see ProfileMotion, of the chain as it is
  bool remake(const ProfileShares& shares, std::size_t first, std::size_t last, const std::vector<double>& phases);
  const ProfileChain& chain() const { return chain_; }
  ProfileChain take() { return std::move(chain_); }

 private:
  std::size_t levels() const { return static_cast<std::size_t>(chain_.levels); }
  const double* unit(std::size_t b) const { return units_.data() + b * n_; }
  void measure(std::size_t b);
  void set_ramp(std::size_t b, double share);
  void set_corner(std::size_t c, const ProfileShares& shares);
  void set_part(const ProfileShares& shares, std::size_t first, std::size_t last);

  const Toolpath& path_;
  const AvailableAcceleration& available_;
  const std::size_t n_;
  /// The largest speed of a corner, and the shares of its place and of the legs beside it that gave it.
  struct Corner {
    float before = -1.0F, at = -1.0F, after = -1.0F;
    double speed = 0.0;
  };
  ProfileChain chain_;
  std::vector<double> units_;
  std::vector<Corner> corners_;
};

}  // namespace accdec
