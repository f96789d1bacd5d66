#pragma once

#include <accdec/gcode/move_sink.hpp>
#include <accdec/simulate.hpp>

// The formats of programs, in rs274.cpp, canonical.cpp and csv.cpp; `read_program` (reader.cpp) chooses one.

namespace accdec {

/// RS-274 as shared by LinuxCNC and Fanuc controls. Motion: G0 G1 G2 G3 (centre or radius form, helices, P turns) and
/// G4 P (seconds). Splines of LinuxCNC: G5 G5.1 G5.2 G5.3, flattened within the arc tolerance. Modes: G17 G18 G19, G20
/// G21, G61 G61.1 G64 P, G90 G91, G90.1 G91.1, G94. Other words: F, axes X Y Z A B C U V W, N, comments, block delete
/// (deleted), %, M0 M1 M2 M30. Passed over: S T H D, M3 to M9, M48 M49, and what leaves the shape of the path alone,
/// G40 G43 G49 G54 to G59.3 G80 G96 G97 G98 G99. The sink learns of G43 and G54 to G59.3. Inside a block, the order
/// of execution is that of LinuxCNC: F comes before G20 and G21 and counts in the unit before them. Arcs without end
/// words are full circles. Two words of one modal group, but for G80, are refused. Parameters (#), expressions ([ ]), O
/// words and every other code (cycles, offsets ..) throw NeedsInterpreter.
void read_rs274(LineSource& source, const ReadOptions& options, MoveSink& sink);

/// Calls as `rs274 -g` prints them, with or without its line numbers. These are read: STRAIGHT_TRAVERSE, STRAIGHT_FEED,
/// ARC_FEED, SET_FEED_RATE, USE_LENGTH_UNITS, SELECT_PLANE, SET_MOTION_CONTROL_MODE, DWELL, PROGRAM_STOP, PROGRAM_END.
/// Other calls of rs274 are ignored if they do not change the path (tools, spindle, coolant, comments). Calls that
/// would change it (offsets other than 0, rotation, probing, synchronised motion) and unknown calls are refused. One
/// call per line.
void read_canonical(LineSource& source, const ReadOptions& options, MoveSink& sink);

/// A table with one row per point: the header names the columns (`x_mm`, .. `w_mm`, `a_deg`, `b_deg`, `c_deg`,
/// `feed_mm_min`), axes not named stay 0. The first row is the start, and its feed is not used. The feed of a row is
/// that of the move to it. Values are separated by commas, or by blanks if the header has no comma; they may have
/// exponents. Empty lines and lines beginning with # are ignored, except a # before the header itself. So the default
/// output of numpy.savetxt is read.
void read_csv(LineSource& source, const ReadOptions& options, MoveSink& sink);

}  // namespace accdec
