#pragma once

#include <array>
#include <vector>

#include <accdec/simulate.hpp>

namespace accdec {

/// A part of a motion at constant acceleration, in s and m. Far from the origin, rounding is larger than the
/// acceleration leaves room for. So positions are counted from a point of the path, and only their sum is rounded.
struct MotionPiece {
  double duration = 0.0;
  const double* from = nullptr;
  bool steady = false;  ///< without acceleration
  std::array<double, program_axis_count> x{}, v{}, a{};
  /// The position of an axis, `time` after the beginning.
  double at(std::size_t axis, double time) const {
    return from[axis] + (x[axis] + (v[axis] + 0.5 * a[axis] * time) * time);
  }
};

/// The leg or corner of a chain that is being driven, as pieces of constant acceleration, and the piece reached.
class ProfilePieces {
 public:
  /// References are kept.
  ProfilePieces(const Toolpath& path, const ProfileChain& chain) : path_(path), chain_(chain), n_(path.dimensions()) {}
  /// Start driving a leg, or the corner before leg c.
  void begin_leg(std::size_t b);
  void begin_corner(std::size_t c);

  bool over() const { return piece_ == pieces_.size(); }
  bool last() const { return piece_ + 1 == pieces_.size(); }
  const MotionPiece& now() const { return pieces_[piece_]; }
  void go_on() { ++piece_; }

 private:
  void direction(std::size_t b, double* u) const;
  void leg_piece(std::size_t b, double& way, double speed, double acceleration, double duration, const double* u);
  void ramp_pieces(std::size_t b, double from, double to, double& way, const double* u);

  const Toolpath& path_;
  const ProfileChain& chain_;
  const std::size_t n_;
  std::vector<MotionPiece> pieces_;
  std::size_t piece_ = 0;
};

}  // namespace accdec
