#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <accdec/program/plan/feed_window.hpp>

namespace accdec {

/// A part of a block commanded at one speed, and a rest after it.
struct FeedPiece {
  std::uint32_t block = 0;
  double length = 0.0;  ///< m, > 0
  double speed = 0.0;   ///< m/s along the path, > 0
  double rest = 0.0;    ///< s at rest after it
};

/// Straight blocks as the choice of feeds sees them.
struct FeedPath {
  std::size_t dimensions = 0;
  std::vector<double> direction;  ///< unit vectors, a row a block
  std::vector<double> length;     ///< m, > 0
  std::vector<float> margin;      ///< part of the limits' changes a block may use, 0 .. 1
  std::size_t blocks() const { return length.size(); }
};

/// Which way a path is walked.
enum class Walk {
  backward,  ///< from its end; only what speeds up in this direction is held to the limits
  forward    ///< both speeding up and slowing down are
};

/// Walks along a path as fast as its caps and the window allow. At the beginning of each piece, and whenever an earlier
/// change of the command leaves the window, the speed is the largest with which everything up to the window's reach
/// ahead holds, going on at that speed or at the caps where those are lower. On a straight leg that gives steps of tau1
/// a_max every tau1. Where nothing holds, what breaks least is taken: simulation has to find it.
/// @param caps  pieces that cover the path in the order of its blocks, with the largest speeds
/// @return pieces that cover it, at most as fast as the caps
std::vector<FeedPiece> march_feeds(const FeedPath& path, const FeedWindow& window, std::span<const FeedPiece> caps,
                                   Walk walk);

}  // namespace accdec
