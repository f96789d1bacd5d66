#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <accdec/program.hpp>

namespace accdec {

/// The error of the joint at the end of block b, m. Errors below what positions can tell are none; neither are those of
/// the stops of a trajectory, which waits there.
double error_of(const ProgramResult& result, std::size_t b);

/// Whether the motion comes to rest at the end of a block.
bool rests_after(const Plan& plan, std::size_t block);

/// The abilities that a control needs for this plan, one part of a sentence each: "step its feed ..".
std::vector<std::string> control_needs(const ProgramResult& result);

/// Blocks of a path as it was read; the chords of an arc are one.
std::size_t blocks_of(const Toolpath& programmed);

/// Smooth turns of a path, such as those between the chords of arcs. Behind them the motion does not go on evenly, so
/// an amplitude that a mode of an axis keeps is judged at the ends of such turns, not inside them.
std::size_t smooth_turns(const Toolpath& path);

/// Sentences on the vibration that limits of modes of axes do not count: inside smooth turns, and that of corners
/// before a leg on which the motion goes on evenly. Empty: no such limit, or nothing is left out.
std::vector<std::string> left_out_by_residuals(const ProgramResult& result);

/// Largest distance by which points of arcs were moved out, m, so that filtered arcs have their programmed radius.
double largest_widening(const Toolpath& path);

/// A joint and the part of its tolerance that it uses.
struct CornerUse {
  std::uint32_t line = 0;    ///< of the block that ends in it
  double error = 0.0;        ///< m
  double tolerance = 0.0;    ///< m
  double utilisation = 0.0;  ///< of the tolerance
  int delay = 0;             ///< samples; 0 of a trajectory
};
/// The joints with the largest errors against their tolerances, worst first, at most `count`; in the order of the
/// program where equal. Joints that follow each other on one line of the program, such as chords of an arc, appear
/// once, with the worst error.
std::vector<CornerUse> worst_corners(const ProgramResult& result, std::size_t count);

}  // namespace accdec
