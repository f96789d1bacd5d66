#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <accdec/files.hpp>
#include <accdec/plan/feeds/feed_window.hpp>

namespace accdec {

/// A part of a block commanded at one speed, and a rest after it.
struct FeedPiece {
  std::uint32_t block = 0;
  double length = 0.0;  ///< m, > 0
  double speed = 0.0;   ///< m/s along the path, > 0
  double rest = 0.0;    ///< s at rest after it
};

/// Straight blocks, as used by the choice of feeds.
struct FeedPath {
  std::size_t dimensions = 0;
  std::vector<double> direction;  ///< unit vectors, one row per block
  std::vector<double> length;     ///< m, > 0
  std::vector<float> margin;      ///< part of the limits' changes a block may use, 0 .. 1
  std::vector<double> part{};     ///< of the programmed feeds that blocks may have; empty: all
  std::size_t blocks() const { return length.size(); }
};

/// Which way a path is walked.
enum class Walk {
  backward,  ///< from its end; only speeding up in this direction is held to the limits
  forward    ///< both speeding up and slowing down are
};

/// Walks along a path as fast as its caps and the window allow. The speed is chosen at the beginning of each piece, and
/// whenever an earlier change of the command leaves the window. It is the largest speed with which everything within
/// the window's reach ahead holds. Ahead, the motion continues at this speed, or at the caps where they are lower. On a
/// straight leg that gives steps of tau1 a_max every tau1. If nothing holds, the speed that breaks the limits least is
/// taken; the simulation must find this.
/// @param caps  pieces that cover the path in the order of its blocks, with the largest speeds
/// @param deadline  once it is over the caps are taken as they are: what comes back is of no use
/// @return pieces that cover it, at most as fast as the caps
std::vector<FeedPiece> march_feeds(const FeedPath& path, const FeedWindow& window, std::span<const FeedPiece> caps,
                                   Walk walk, const Deadline& deadline = {});

}  // namespace accdec
