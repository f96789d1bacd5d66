#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <accdec/machine/machine.hpp>
#include <accdec/program/read/toolpath.hpp>
#include <accdec/program/write/profile_result.hpp>
#include <accdec/program/write/program_report.hpp>
#include <accdec/program/write/samples.hpp>

namespace accdec {

/// What pages and figures show of a planned program.
struct ProgramMotion {
  std::string title;                                  ///< program, time and plan
  double sample_period = 0.0, cycle_time = 0.0;       ///< s
  std::function<void(const SampleVisitor&)> samples;  ///< calls the visitor for every sample in order
};
/// The motion of a plan. The reference is kept.
ProgramMotion motion_of(const ProgramResult& result);
ProgramMotion motion_of(const ProfileResult& result);

double block_feed(const Toolpath& path, std::size_t block);  ///< m/s, of all axes

/// Follows a motion along its path: the block that a sample lies on, by the projection onto it.
class PathFollower {
 public:
  /// The reference is kept. @param path  blocks of any length but 0
  explicit PathFollower(const Toolpath& path) : path_(path), n_(path.dimensions()) {}

  /// Moves on to the block of a position.
  void follow(const double* x);
  std::size_t block() const { return block_; }
  /// The joint nearer to the sample: at the end of this block, or before it (-1: the start of the program).
  std::ptrdiff_t joint() const { return static_cast<std::ptrdiff_t>(block_) - (part_ < 0.5 ? 1 : 0); }

 private:
  const Toolpath& path_;
  const std::size_t n_;
  std::size_t block_ = 0;
  double part_ = 0.0;
};

/// Takes sample k, its position (m), its speed (m/s, of all axes) and the index in `axis_limits` of the limit that
/// binds there: the one most used, from 98 % on; -1 where none is.
using SpeedVisitor = std::function<void(std::int64_t k, const double* position, double speed, int binding)>;
/// Every sample of a motion. @param machine  as many axes as the path, or none
void visit_speeds(const Toolpath& path, const Machine& machine, const ProgramMotion& motion, const SpeedVisitor& visit);
/// The name of what binds, an index as `SpeedVisitor` has it. Where it is no limit of an axis, the tolerance of a
/// corner or the programmed feed holds the motion back.
std::string binding_name(int binding);

/// Time lost at corners that turn by `turn_from` to `turn_to` degrees, or at stops.
struct CornerLoss {
  double turn_from = 0.0, turn_to = 0.0;
  bool stop = false;
  long count = 0;
  double time = 0.0;  ///< s: of every sample the part by which it is slower than the feed, at the joint nearer to it
};
/// @param programmed  the path as the program has it, before a plan changed its feeds
std::vector<CornerLoss> time_lost(const Toolpath& programmed, const ProgramMotion& motion);
/// "45 to 75 degrees".
std::string class_name(const CornerLoss& loss);

}  // namespace accdec
