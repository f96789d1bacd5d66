#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace accdec {

/// The axes of a program, in this order. X Y Z U V W are linear, in m. A B C are rotary; a degree counts as a
/// millimetre, as feed words in degrees per minute and tolerances in numeric controls do, so it is 1e-3 here.
inline constexpr std::string_view program_axes = "XYZABCUVW";
inline constexpr std::size_t program_axis_count = 9;
/// Whether it is A, B or C.
constexpr bool rotary_axis(std::size_t axis) {
  return axis >= 3 && axis <= 5;
}
using ProgramPoint = std::array<double, program_axis_count>;

/// How the corner at the end of a move is to be passed.
enum class PathControl : std::uint8_t {
  blend,       ///< G64: within the tolerance
  exact_path,  ///< G61: through the corner, which needs no stop where the path goes straight on
  exact_stop   ///< G61.1, G4, M0, M1: at rest in the corner
};

/// One straight move, from where the last one ended.
struct Move {
  ProgramPoint to{};
  double duration = 0.0;    ///< s at the programmed feed; 0 for a rapid move, whose time the axis limits set
  double tolerance = -1.0;  ///< m, G64 P in force; negative: the program gives none
  PathControl control = PathControl::blend;
  bool rapid = false;
  bool inside_arc = false;  ///< a chord of an arc that the arc's next chord follows
  std::int64_t line = 0;    ///< of the word that moved
  std::uint32_t column = 0;
};

struct Arc;

/// Receives a program move by move, in order.
class MoveSink {
 public:
  virtual ~MoveSink() = default;
  /// Where the path begins, before any move; the origin if never called.
  virtual void begin(const ProgramPoint& at) = 0;
  /// Moves of no length come, too: they carry no path but count as blocks.
  virtual void move(const Move& move) = 0;
  /// The next `chords` moves stand for this arc.
  virtual void arc(const Arc& /*arc*/, int /*chords*/) {}
  /// The motion before this point must come to rest here, and stays for `dwell` s (G4) or until the operator goes on
  /// (0).
  virtual void stop(double dwell) = 0;
  /// Words at this point that are not about motion (spindle, tool, coolant, offsets, M0), as they would be written.
  /// @param with_move  a line number or comment that stands on the line of the next move
  virtual void pass(std::string_view /*words*/, bool /*with_move*/ = false) {}
  /// Whether the program stands between two %, its number (O0001; may be empty), and the word that ended it (M2, M30;
  /// empty: the end of the file).
  virtual void frame(bool /*percent*/, std::string_view /*label*/, std::string_view /*end*/) {}
};

/// Duration of a straight move: the feed is that of X Y Z if any of them moves, else of U V W, else of A B C.
/// @param feed  m/s, > 0; for A B C 1e-3 degrees a second
double feed_duration(const ProgramPoint& from, const ProgramPoint& to, double feed);
/// Whether only A B C move, whose feed is in degrees per minute whatever the length unit.
bool rotary_only(const ProgramPoint& from, const ProgramPoint& to);

}  // namespace accdec
