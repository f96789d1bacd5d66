// Programs: readers, toolpaths, plans as data, and their motion sample by sample.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <accdec/filter.hpp>
#include <accdec/machine.hpp>
#include <accdec/task.hpp>

namespace accdec {

/// The lines of a file or of a text in memory, one after another through one buffer, so memory does not grow with the
/// file. The byte order mark that some editors put before UTF-8 is not part of the first line.
class LineSource {
 public:
  /// Longest line accepted, characters. Longer ones are an error, so that a file without line ends cannot fill the
  /// memory.
  static constexpr std::size_t line_max = 65536;

  /// @throws std::invalid_argument "file: reason" if it cannot be opened.
  explicit LineSource(const std::filesystem::path& file);
  /// @param text  kept by reference
  LineSource(std::string name, std::string_view text);

  /// Next line without its end (LF or CR LF); false after the last. The view holds until the next call.
  /// @throws std::invalid_argument on a line longer than `line_max` or a failing read.
  bool next(std::string_view& line) {
    const char* end = static_cast<const char*>(find_end());
    if (end == nullptr) return next_slow(line);
    take(line, end);
    position_ = end + 1;
    return true;
  }

  /// Makes next() return the last line again.
  void again() {
    position_ = start_of_last_;
    --line_number_;
  }

  /// Whether the text began with one, as far as it has been read.
  bool byte_order_mark() const { return mark_; }
  /// From 1: the line returned last, or the one that it stands for.
  std::int64_t line_number() const { return stands_for_ > 0 ? stands_for_ : line_number_; }
  /// Lines returned from now on stand for one of another text, which messages name.
  void stands_for(std::int64_t line) { stands_for_ = line; }
  /// The column for messages: 1 where the line stands for another, whose columns are not known.
  std::size_t column(std::size_t own) const { return stands_for_ > 0 ? 1 : own; }
  const std::string& name() const { return name_; }
  /// @param column  from 1  @throws std::invalid_argument always: "file:line:column: message"
  [[noreturn]] void fail(std::size_t column, const std::string& message) const;

 private:
  struct Close {
    void operator()(std::FILE* f) const { std::fclose(f); }
  };
  const void* find_end() const;
  void take(std::string_view& line, const char* end) {
    start_of_last_ = position_;
    const char* last = end > position_ && end[-1] == '\r' ? end - 1 : end;
    line = std::string_view(position_, static_cast<std::size_t>(last - position_));
    ++line_number_;
    if (line.size() > line_max) too_long();
  }
  bool next_slow(std::string_view& line);
  void skip_byte_order_mark();
  [[noreturn]] void too_long() const;

  std::string name_;
  std::unique_ptr<std::FILE, Close> file_;
  std::vector<char> buffer_;
  const char* position_ = nullptr;
  const char* end_ = nullptr;
  const char* start_of_last_ = nullptr;
  std::int64_t line_number_ = 0, stands_for_ = 0;
  bool mark_ = false;
  bool started_ = false;  // reading the file
};

/// The axes of a program, in this order. X Y Z U V W are linear, in m. A B C are rotary; a degree counts as a
/// millimetre, as feed words in degrees per minute and tolerances in numeric controls do, so it is 1e-3 here.
inline constexpr std::string_view program_axes = "XYZABCUVW";
inline constexpr std::size_t program_axis_count = 9;
/// Whether it is A, B or C.
constexpr bool rotary_axis(std::size_t axis) {
  return axis >= 3 && axis <= 5;
}
using ProgramPoint = std::array<double, program_axis_count>;

/// How the corner at the end of a move must be passed.
enum class PathControl : std::uint8_t {
  blend,       ///< G64: within the tolerance
  exact_path,  ///< G61: through the corner, which needs no stop where the path goes straight on
  exact_stop   ///< G61.1, G4, M0, M1: at rest in the corner
};

/// That of arcs: G17, G18, G19.
enum class Plane : std::uint8_t { xy, zx, yz };

inline constexpr double longest_chords = 2e-6;  ///< m, from their arcs at most, unless asked for
struct ReadOptions {
  double arc_tolerance = longest_chords;  ///< m, > 0: largest distance of a chord from the arc it stands for
  bool numbered = false;                  ///< N words of canonical calls are lines of the program
  bool tools = false;                     ///< lengths of tools are given: G43 needs an interpreter
};

/// How the joint at the end of a block is passed.
enum class Joint : std::uint8_t {
  corner,    ///< within its tolerance at the samples: the corner error of a single corner
  smooth,    ///< turns by less than `smooth_turn`: within its tolerance, also on the path between the samples
  straight,  ///< no turn: as smooth, but needs no tolerance
  stop       ///< at rest
};
/// Largest turn of a smooth joint, rad. Chords of arcs and of curves turn less, corners more. At speed, samples lie
/// farther apart than tolerances, so that the sampled error of an almost straight path says little.
inline constexpr double smooth_turn = 0.34906585039886592;  // 20 degrees

/// An arc or helix of a path that its chords represent: their ends lie on it.
struct PathArc {
  std::uint32_t first = 0, last = 0;      ///< its blocks
  std::size_t x = 0, y = 1;               ///< columns of its plane; positive angles turn from x to y
  double center_x = 0.0, center_y = 0.0;  ///< m
  double radius = 0.0;                    ///< m, mean of both ends, which may differ by rounding
  double angle = 0.0;                     ///< rad, signed
  double from(const double* point, double& dx, double& dy) const;  ///< the centre: the distance, m, and its direction
};

/// The members of a toolpath that do not change when its blocks are split.
struct ToolpathFrame {
  std::vector<std::size_t> axes;       ///< which of `program_axes` move, ascending: the columns of the points
  double narrowed = 0.0;               ///< m: beside arcs and splines this much of it at most is left for their chords
  bool widen_arcs = false;             ///< the commanded radius of arcs may be widened
  double contour_max = unlimited;      ///< m, largest distance of the motion from the blocks that it passes
  ControlDelays control;               ///< the delays that its corners can be given
  double dwell_first = 0.0;            ///< before the first block, s
  ProgramPoint begin{};                ///< where the program begins, m, axes that never move included
  std::vector<std::uint32_t> clamped;  ///< lines of feeds above an axis' velocity limit, lowered to it; ascending
  Plane plane = Plane::xy;             ///< in force for most of the way of feed moves
  bool percent = false;                ///< the program stands between two %
  std::string label;                   ///< its number, O0001; may be empty
  std::string end;                     ///< its last word, M2 or M30; empty: the end of the file
  /// A word that acts on the machine and is not in the coordinates.
  struct Selected {
    std::string word;
    std::int64_t line = 0;  ///< 0: in force from the start
  };
  std::vector<Selected> systems;          ///< G54 to G59.3 with moves in them, each once, by their first line
  std::optional<std::int64_t> length_at;  ///< line of the first G43 that takes a length, which counts as 0
  std::int64_t empty_moves = 0;           ///< moves of no length that were left out
};

/// The straight moves of a program in the order of execution; block b leads from point b to point b + 1, and joint b is
/// the one at its end. Moves of no length are not kept. About 45 bytes a block for two axes.
struct Toolpath : ToolpathFrame {
  std::vector<double> points;       ///< (blocks + 1) rows, m; see `program_axes` for rotary axes
  std::vector<double> duration;     ///< s per block, > 0
  std::vector<double> tolerance;    ///< m, of every joint; unlimited if it has none
  std::vector<Joint> joint;         ///< one per block; the last is `stop`
  std::vector<std::uint32_t> line;  ///< of every block
  std::vector<std::uint8_t> rapid;  ///< whether a block is a rapid move: its duration is what the velocity limits allow
  std::vector<std::uint8_t> inside_arc;  ///< whether the joint lies between two chords of one arc
  std::vector<PathArc> arcs;             ///< ascending
  std::vector<double> programmed;        ///< rows as points, the program's; empty: compensate_arcs moved none
  std::vector<std::pair<std::uint32_t, double>> dwell;  ///< at the end of which block, s; ascending
  /// Delays that the program brings along: at the end of which block, s; ascending.
  std::vector<std::pair<std::uint32_t, double>> given_delays;
  struct KeptWords {
    std::uint32_t block = 0;  ///< before which one
    std::string words;        ///< as to be written
    /// A dwell of the program (`dwell` above has its time); a line number or comment on the block's own line.
    bool dwell = false, with_block = false;
  };
  std::vector<KeptWords> kept_words;  ///< dwells, and words that are not about motion, in their order
  struct Mode {
    std::uint32_t block = 0;  ///< from which one on
    PathControl control = PathControl::blend;
    double tolerance = -1.0, merge = -1.0;  ///< m, G64 P and Q in force; negative: the program gives none
  };
  std::vector<Mode> modes;  ///< path modes as the program gives them, for estimates of other controls; ascending
  std::size_t blocks() const { return duration.size(); }
  std::size_t dimensions() const { return axes.size(); }
  const double* point(std::size_t i) const { return points.data() + i * axes.size(); }
  /// The point that the motion must pass; errors are measured from it.
  const double* programmed_point(std::size_t i) const { return programmed_points() + i * axes.size(); }
  const double* programmed_points() const { return programmed.empty() ? points.data() : programmed.data(); }
  double length(std::size_t b) const;  ///< m, of a block
  std::string axis_name(std::size_t dimension) const;
  double dwells() const;                                                             ///< of the whole program, s
  std::span<const std::pair<std::uint32_t, double>> dwells_at(std::size_t b) const;  ///< at the end of block b
};

/// Whether a leg ends with block b.
inline bool ends_leg(const Toolpath& path, std::size_t b) {
  return path.joint[b] == Joint::corner || path.joint[b] == Joint::stop;
}

struct ToolpathOptions {
  ReadOptions read;
  std::optional<double> error_max;    ///< m, tolerance where the program gives none
  double contour_max = unlimited;     ///< m, see Toolpath
  bool clamp_feeds = false;           ///< feeds above an axis' velocity limit are lowered to it, else they are an error
  bool widen_arcs = false;            ///< see Toolpath
  bool rapid_stops = false;           ///< stop wherever rapid and feed moves meet
  bool room_for_chords = true;        ///< see Toolpath::narrowed; older results left none
  bool dwells_before_filter = false;  ///< G4 is a given delay, without a stop where the program does not stop anyway
};

/// The task's axis that moves a program axis, by its name in any case; nullptr if there is none of that name. The
/// single axis of a task gives its limits to every linear axis; a rotary axis has its own limits, in degrees.
const Axis* find_axis(const Machine& machine, std::size_t program_axis);
/// The machine with one axis per column of the path, without the control's own smoothing: filters of plans have it.
Machine program_machine(const Machine& machine, const Toolpath& path);
/// Reads a whole program.
/// @throws std::invalid_argument at the first line that is not understood. Also for an axis that the machine lacks, a
/// corner without tolerance, a feed above an axis' velocity limit, and a rapid move of an axis without one.
Toolpath read_toolpath(LineSource& source, const Machine& machine, const ToolpathOptions& options);

/// Lengths and diameters of tools, for G43, G41 and G42.
struct ProgramTools {
  std::string table;             ///< file, LinuxCNC's; may be empty
  bool table_in_inch = false;    ///< its lengths and diameters; else mm
  std::optional<double> length;  ///< m, of every tool, in place of a table
  bool given() const { return !table.empty() || length.value_or(0.0) != 0.0; }  ///< for ReadOptions::tools
};

/// A program as the look-ahead sees it: legs (one per block) between corners (one per point, including the ends).
/// A corner is passed at one speed v, by a boxcar of `stretch * v` seconds. It takes `stretch v^2/2` of each leg, plus
/// the length of a steady stretch of `coast` seconds on either side. A leg ramps between the speeds of its corners and
/// up to its feed where there is room. Its acceleration is constant within each of `levels` equal parts of its feed.
struct ProfileChain {
  int levels = 1;
  double peak_coast = 0.0;           ///< s at least between speeding up and braking
  std::vector<double> length, feed;  ///< of every leg, m and m/s
  std::vector<double> ramp;          ///< legs rows of `levels`, m/s^2
  std::vector<double> speed_max;     ///< of every corner, m/s; 0 where the motion comes to rest, see `stops`
  std::vector<double> stretch;       ///< of every corner, s^2/m
  std::vector<double> coast;         ///< of every corner, s
  std::vector<double> speed;         ///< result, of every corner, m/s
  std::vector<double> peak;          ///< result, of every leg, m/s

  std::size_t legs() const { return length.size(); }
  /// Whether the motion stops at corner c, on a sample, until the last boxcar is empty. With a coast it waits twice it.
  bool stops(std::size_t c) const { return !(speed_max[c] > 0.0) && !(coast[c] > 0.0); }
  /// Length that corner c takes of each of its legs at a speed, m.
  double taken(std::size_t c, double v) const { return (0.5 * stretch[c] * v + coast[c]) * v; }
  /// Way from rest to a speed along leg b, m.
  double way(std::size_t b, double v) const {
    if (levels == 1) return 0.5 * v * v / ramp[b];
    const double width = feed[b] / levels;
    double sum = 0.0;
    for (int k = 0; k < levels; ++k) {
      const double low = k * width, high = k + 1 == levels ? v : (k + 1) * width;
      if (v <= low) break;
      const double top = v < high ? v : high;
      sum += 0.5 * (top - low) * (top + low) / ramp[b * static_cast<std::size_t>(levels) + static_cast<std::size_t>(k)];
    }
    return sum;
  }
};

/// Straight moves at their feeds, with a delay after each, through one filter: what a control with a filter runs.
struct FilteredCommand {
  Filter filter{{1.0}};     ///< all that acts on the command: what is set, and behind it the control's own smoothing
  std::vector<int> delays;  ///< samples, one a block, of the joint at its end
  std::optional<Filter> own{};  ///< what is set, where the machine has `prefilter_taps`; none: `filter` is set
  std::vector<Filter> moved{};  ///< `filter` behind the servo: one, or one an axis; empty: no servo
  const Filter& set() const { return own ? *own : filter; }
  std::span<const Filter> motion() const { return moved.empty() ? std::span(&filter, 1) : std::span(moved); }
};

/// A motion given by its samples, from the first after the start to the last before it rests.
struct FreeMotion {
  std::vector<double> position;      ///< rows of the path's dimensions, m
  std::vector<std::uint32_t> block;  ///< along which every sample runs, ascending
};

/// For controllers that take a position every cycle. Every corner has its own filter and speed, every leg its own
/// ramps. All samples pass a last filter. A free motion has only samples.
struct Trajectory {
  ProfileChain chain;
  Filter last{{1.0}};  ///< a single tap: none
  FreeMotion free{};   ///< empty: the motion is that of the chain
  bool is_free() const { return !free.block.empty(); }
};

/// How a program is run.
struct Plan {
  Toolpath path;  ///< with the feeds that are commanded; of a trajectory their upper bounds
  std::variant<FilteredCommand, Trajectory> motion;

  const FilteredCommand* command() const { return std::get_if<FilteredCommand>(&motion); }
  const Trajectory* trajectory() const { return std::get_if<Trajectory>(&motion); }
  /// The one filter of the plan: that of the command, or the last.
  const Filter& filter() const { return command() != nullptr ? command()->filter : trajectory()->last; }
  /// As `filter`, without the control's own smoothing: the taps that are set.
  const Filter& set() const { return command() != nullptr ? command()->set() : trajectory()->last; }
  /// Samples, at the end of a block; a trajectory has no delays.
  int delay(std::size_t block) const { return command() != nullptr ? command()->delays[block] : 0; }
  /// As on the command line: "fixed", "profiles" or "free".
  const char* name() const { return command() != nullptr ? "fixed" : trajectory()->is_free() ? "free" : "profiles"; }
  bool empty() const { return path.blocks() == 0; }
};

/// One sample of a motion.
struct Sample {
  std::int64_t number = 0;                                        ///< 0 is the start, at rest
  std::array<double, program_axis_count> position{}, velocity{};  ///< m and m/s, one value a dimension of the path
};

/// The motion of a plan, from rest at its start to the first sample at rest at its end: what controllers are sent, and
/// what tables, figures and pages show.
/// It holds only one run of a command and some thousand samples, or one leg of a trajectory.
class Motion {
 public:
  /// References are kept. @param plan  not empty  @param servo  what the servo makes of it, until that rests, too
  Motion(const Plan& plan, double sample_period, bool servo = false);
  ~Motion();
  Motion(const Motion&) = delete;
  Motion& operator=(const Motion&) = delete;

  /// The next sample, the start first; false after the last.
  bool next(Sample& sample);
  /// After next(): the first and the last block that the sample may be on.
  std::pair<std::size_t, std::size_t> blocks() const;
  /// After next(): passes over samples in which the motion rests or goes straight on evenly, except the last of them.
  void pass_steady();

 private:
  class Source;
  class FilteredSource;
  class TrajectorySource;
  class SampledSource;
  std::unique_ptr<Source> source_;
};

}  // namespace accdec
