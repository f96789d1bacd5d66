#pragma once

#include <accdec/program/read/line_source.hpp>
#include <accdec/program/read/move.hpp>

namespace accdec {

struct ReadOptions {
  double arc_tolerance = 2e-6;  ///< m, > 0: largest distance of a chord from the arc it stands for
};

enum class ProgramFormat { rs274, canonical, csv };

/// Reads a program from its first line to its end and hands every move to the sink, in memory that does not grow with
/// it. A name ending in ".csv" is read as CSV; else the first line with words decides between RS-274 and canonical
/// calls, by the names of the calls.
/// @throws ReadError at the first line that is not understood; nothing is guessed.
ProgramFormat read_program(LineSource& source, const ReadOptions& options, MoveSink& sink);

/// RS-274 as LinuxCNC and Fanuc controls share it: G0 G1 G2 G3 (centre or radius form, helices, P turns), G4 P
/// (seconds), LinuxCNC's splines G5 G5.1 G5.2 G5.3 (flattened within the arc tolerance), G17 G18 G19, G20 G21, G61
/// G61.1 G64 P, G90 G91, G90.1 G91.1, G94, F, axes X Y Z A B C U V W, N, comments, block delete (deleted), %, M0 M1 M2
/// M30. Passed over: S T H D, M3 to M9, M48 M49, and what leaves the shape of the path alone (G40 G43 G49 G54 to G59.3
/// G80 G96 G97 G98 G99). In a block the order of execution is that of LinuxCNC: F comes before G20 and G21 and counts
/// in the unit before them. Arcs without end words are full circles. Two words of one modal group, but for G80, are
/// refused, as is everything else: parameters (#), expressions ([ ]), O words, cycles, offsets, probing.
void read_rs274(LineSource& source, const ReadOptions& options, MoveSink& sink);

/// Calls as `rs274 -g` prints them, with or without its line numbers: STRAIGHT_TRAVERSE, STRAIGHT_FEED, ARC_FEED,
/// SET_FEED_RATE, USE_LENGTH_UNITS, SELECT_PLANE, SET_MOTION_CONTROL_MODE, DWELL, PROGRAM_STOP, PROGRAM_END; the other
/// calls that rs274 prints are passed over if they leave the path alone (tools, spindle, coolant, comments); those that
/// would change it (offsets other than 0, rotation, probing, synchronised motion) and unknown ones are refused. One
/// call a line.
void read_canonical(LineSource& source, const ReadOptions& options, MoveSink& sink);

/// A table with one row a point: the header names the columns (`x_mm`, .. `w_mm`, `a_deg`, `b_deg`, `c_deg`,
/// `feed_mm_min`), axes not named stay 0. The first row is the start, its feed is not used; the feed of a row is that
/// of the move to it. Values stand between commas, or between blanks if the header has no comma; they may have
/// exponents. Empty lines and those beginning with # are passed over, but for a # before the header itself: what
/// numpy.savetxt writes by default is read.
void read_csv(LineSource& source, const ReadOptions& options, MoveSink& sink);

}  // namespace accdec
