#pragma once

#include <vector>

#include <accdec/corner.hpp>
#include <accdec/filter.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/plan/feeds/arc_caps.hpp>
#include <accdec/plan/feeds/feed_march.hpp>
#include <accdec/plan/feeds/feed_window.hpp>
#include <accdec/plan/feeds/known_corners.hpp>
#include <accdec/plan/feeds/steady_passing.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// How corners and stops are passed: the speeds at which they are reached and left, and the rest of the command in
/// them.
struct CornerFeed {
  double speed = unlimited;    ///< m/s
  double leaving = unlimited;  ///< m/s
  int delay = 0;               ///< samples
};

/// The largest speeds of a path, and the needs of its joints.
class FeedCaps {
 public:
  /// References are kept.
  /// @param feed_step  DelayKind::corner_feed: corners without a delay are passed at a multiple of this part of both
  /// feeds; 0: at any speed
  FeedCaps(const Toolpath& path, const FeedPath& feeds, const FilterBehind& behind, const FeedWindow& window,
           double sample_period, double feed_step);

  /// Speed and delay of the corner or stop at the end of block b. Among a grid of speeds it is the one that costs the
  /// least time, including the ramps to the neighbours' feeds at constant acceleration. @param tolerance  m
  CornerFeed corner(std::size_t b, double tolerance);
  /// Largest constant speed with which the smooth joint at the end of block b is passed within its tolerance. The
  /// window that ends or begins there stays within the limits. Well inside an arc it is the arc's speed, see ArcCaps.
  double smooth(std::size_t b, double tolerance) const;
  /// Speed of block b: that of the program, or the part of it that it may have.
  double feed(std::size_t b) const {
    return (feeds_.part.empty() ? 1.0 : feeds_.part[b]) * feeds_.length[b] / path_.duration[b];
  }

  /// Pieces of the whole path with these speeds.
  /// @param joints  one a block
  std::vector<FeedPiece> pieces(const std::vector<CornerFeed>& joints) const;

 private:
  CornerFeed fastest_corner(std::size_t b, double tolerance) const;
  double largest(std::size_t b, double v_max, bool apart, bool together) const;
  /// Whether the corner at the end of block b, by itself, holds tolerance and limits without a delay.
  bool passes(std::size_t b, const CornerFeed& corner, double cosine, double tolerance) const;
  CornerFeed without_delay(std::size_t b, double cosine, double tolerance) const;
  /// Error of a corner without a delay over a sample's length, which is the same on both legs.
  double error_in_steps(double cosine) const;
  /// s that block b loses where it is held at speed v for some time, and then ramps to its feed.
  double time_lost(std::size_t b, double v, double held) const;
  /// The same of both blocks of the corner at the end of block b, and its delay.
  double time_lost(std::size_t b, const CornerFeed& corner) const;
  /// s on each side of a corner in which its speed is held.
  double held_for(const CornerFeed& corner) const;
  double steady_change(std::size_t b, double v) const;
  struct Zone;
  void hold(std::size_t b, double v, double left, bool ahead, std::vector<double>& cap, std::vector<Zone>& part) const;
  void add_pieces(std::size_t b, double cap, Zone first, Zone last, std::vector<FeedPiece>& pieces) const;

  const Toolpath& path_;
  const FeedPath& feeds_;
  const Filter& filter_;  // of the command
  const Filter& motion_;
  const FeedWindow& window_;
  double period_, feed_step_;
  DelayFinder finder_;
  ArcCaps arcs_;
  SteadyPassing steady_;
  std::vector<double> acceleration_;  // along every block, m/s^2
  KnownCorners<CornerFeed> known_;
};

}  // namespace accdec
