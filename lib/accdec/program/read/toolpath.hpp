#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <accdec/machine/machine.hpp>
#include <accdec/program/read/line_source.hpp>
#include <accdec/program/read/move.hpp>
#include <accdec/program/read/reader.hpp>

namespace accdec {

/// How the joint at the end of a block is passed.
enum class Joint : std::uint8_t {
  corner,    ///< within its tolerance, judged at the samples: the corner error of a single corner
  smooth,    ///< turns by less than `smooth_turn`: within its tolerance, judged on the path between the samples, too
  straight,  ///< no turn: as smooth, but needs no tolerance
  stop       ///< at rest
};
/// Largest turn of a smooth joint, rad: chords of arcs and of finely sampled curves turn less, corners more. At speed
/// the samples lie farther apart than usual tolerances, so that the sampled error of a path that goes almost straight
/// on says little.
inline constexpr double smooth_turn = 0.34906585039886592;  // 20 degrees

/// An arc or helix of a path, which its chords stand for: their ends lie on it.
struct PathArc {
  std::uint32_t first = 0, last = 0;      ///< its blocks
  std::size_t x = 0, y = 1;               ///< columns of its plane; positive angles turn from x to y
  double center_x = 0.0, center_y = 0.0;  ///< m
  double radius = 0.0;                    ///< m, mean of both ends, which may differ by rounding
  double angle = 0.0;                     ///< rad, signed
  double from(const double* point, double& dx, double& dy) const;  ///< the centre: the distance, m, and its direction
};

/// The straight moves of a program in the order of execution; block b leads from point b to point b + 1, and joint b is
/// the one at its end. Moves of no length are not kept. About 45 bytes a block for two axes.
struct Toolpath {
  std::vector<std::size_t> axes;    ///< which of `program_axes` move, ascending: the columns of the points
  std::vector<double> points;       ///< (blocks + 1) rows, m; see `program_axes` for rotary axes
  std::vector<double> duration;     ///< s a block, > 0
  std::vector<double> tolerance;    ///< m, of every joint; unlimited where it has none
  std::vector<Joint> joint;         ///< one a block; the last is `stop`
  std::vector<std::uint32_t> line;  ///< of every block
  std::vector<std::uint8_t> rapid;  ///< whether a block is a rapid move: its duration is what the velocity limits allow
  std::vector<std::uint8_t> inside_arc;  ///< whether the joint lies between two chords of one arc
  std::vector<PathArc> arcs;             ///< ascending
  std::vector<double> programmed;  ///< rows as points: where the program has them, where compensate_arcs moved the
                                   ///< points away; empty: nowhere
  bool widen_arcs = false;         ///< the commanded radius of arcs may be widened, see compensate_arcs
  std::vector<std::pair<std::uint32_t, double>> dwell;  ///< at the end of which block, s; ascending
  double dwell_first = 0.0;                             ///< before the first block, s
  ProgramPoint begin{};                                 ///< where the program begins, m, axes that never move included
  std::vector<std::pair<std::uint32_t, double>>
      given;  ///< delays that the program brings along: at the end of which block, s; ascending
  struct Passed {
    std::uint32_t block = 0;  ///< before which one
    std::string words;        ///< as to be written
    bool dwell = false;       ///< a dwell of the program; `dwell` above has its time
    bool with_block = false;  ///< a line number or comment that stands on the block's own line
  };
  std::vector<Passed> passed;          ///< dwells, and words that are not about motion, in their order
  std::vector<std::uint32_t> clamped;  ///< lines of feeds above an axis' velocity limit, lowered to it; ascending
  bool percent = false;                ///< the program stands between two %
  std::string label;                   ///< its number, O0001; may be empty
  std::string end;                     ///< its last word, M2 or M30; empty: the end of the file
  std::int64_t empty_moves = 0;        ///< moves of no length that were left out

  std::size_t blocks() const { return duration.size(); }
  std::size_t dimensions() const { return axes.size(); }
  const double* point(std::size_t i) const { return points.data() + i * axes.size(); }
  /// Where the motion is to pass: what errors are measured from.
  const double* asked(std::size_t i) const { return asked_points() + i * axes.size(); }
  const double* asked_points() const { return programmed.empty() ? points.data() : programmed.data(); }
  std::string axis_name(std::size_t dimension) const;
};

/// Whether a leg ends with block b.
inline bool ends_leg(const Toolpath& path, std::size_t b) {
  return path.joint[b] == Joint::corner || path.joint[b] == Joint::stop;
}

struct ToolpathOptions {
  ReadOptions read;
  std::optional<double> error_max;  ///< m, tolerance where the program gives none
  bool clamp_feeds = false;         ///< feeds above an axis' velocity limit are lowered to it, else they are an error
  bool widen_arcs = false;          ///< see Toolpath
  bool rapid_stops = false;         ///< stop wherever rapid and feed moves meet
  bool dwells_before_filter =
      false;  ///< G4 holds the command back and asks for no stop: a given delay, where the program does not stop anyway
};

/// The task's axis that moves a program axis: the one of its name in either case; a task with a single axis gives its
/// limits to every linear axis (a rotary one has limits of its own, in degrees), one without any axis limits nothing.
/// nullptr if there is none of that name.
const Axis* find_axis(const Machine& machine, std::size_t program_axis);
/// The machine with one axis a column of the path.
Machine program_machine(const Machine& machine, const Toolpath& path);

/// Reads a whole program.
/// @throws ReadError as read_program, and for an axis the machine does not have, a feed above an axis' velocity limit,
/// a rapid move of an axis without velocity limit, and a corner without tolerance.
Toolpath read_toolpath(LineSource& source, const Machine& machine, const ToolpathOptions& options);

}  // namespace accdec
