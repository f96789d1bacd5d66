#pragma once

#include <cstddef>

#include <accdec/simulate.hpp>

namespace accdec {

// Internal to this folder.

/// Follows a motion along its path: which block each sample lies on. A corner is passed when the motion crosses the
/// line that bisects it. If the path turns back on itself, places do not show this; then the corner is passed when the
/// motion turns back.
class PathFollower {
 public:
  /// The reference is kept. @param path  blocks of any length but 0
  explicit PathFollower(const Toolpath& path) : path_(path), n_(path.dimensions()) {}

  /// Advances to the block of the next sample. @param x  m @param v  m/s
  void follow(const double* x, const double* v);
  std::size_t block() const { return block_; }
  /// The place of the sample along its block, 0 to 1.
  double part() const { return part_; }
  /// The joint nearer to the sample: at the end of this block, or before it (-1: the start of the program).
  std::ptrdiff_t joint() const { return static_cast<std::ptrdiff_t>(block_) - (part_ < 0.5 ? 1 : 0); }

 private:
  bool left(const double* x, const double* v);
  std::size_t nearer_block(const double* x) const;
  void enter(std::size_t block) {
    block_ = block;
    forward_ = false;
  }

  const Toolpath& path_;
  const std::size_t n_;
  std::size_t block_ = 0;
  bool forward_ = false;  ///< the motion has gone along this block
  double part_ = 0.0;
};

}  // namespace accdec
