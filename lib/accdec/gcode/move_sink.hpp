#pragma once

#include <cstdint>
#include <string_view>

#include <accdec/simulate.hpp>

namespace accdec {

/// One straight move, from where the last one ended.
struct Move {
  ProgramPoint to{};
  double duration = 0.0;    ///< s at the programmed feed; 0 for a rapid move, whose time the axis limits set
  double tolerance = -1.0;  ///< m, G64 P in force; negative: the program gives none
  double merge = -1.0;      ///< m, G64 Q in force; negative: the program gives none
  PathControl control = PathControl::blend;
  Plane plane = Plane::xy;  ///< in force
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
  /// The path begins here, before any move; at the origin if never called.
  virtual void begin(const ProgramPoint& at) = 0;
  /// Moves of no length are passed too: they have no path but count as blocks.
  virtual void move(const Move& move) = 0;
  /// The next `chords` moves stand for this arc.
  virtual void arc(const Arc& /*arc*/, int /*chords*/) {}
  /// The motion before this point must stop here. It stays for `dwell` s (G4), or until the operator continues (0).
  virtual void stop(double dwell) = 0;
  /// Words at this point that do not concern motion (spindle, tool, coolant, offsets, M0), as they would be written.
  /// `with_move`: a line number or comment that stands on the line of the next move.
  virtual void pass(std::string_view /*words*/, bool /*with_move*/ = false) {}
  /// An offset that acts from here on, by a word of its own: G43 of a tool whose length is not known, G54 to G59.3.
  virtual void select(std::string_view /*word*/) {}
  /// Whether the program stands between two %, its number (O0001; may be empty), and the word that ended it (M2, M30;
  /// empty: the end of the file).
  virtual void frame(bool /*percent*/, std::string_view /*label*/, std::string_view /*end*/) {}
};

/// Duration of a straight move: the feed is that of X Y Z if any of them moves, else of U V W, else of A B C.
/// @param feed  m/s, > 0; for A B C 1e-3 degrees a second
double feed_duration(const ProgramPoint& from, const ProgramPoint& to, double feed);
/// Whether only A B C move, whose feed is in degrees per minute whatever the length unit.
bool rotary_only(const ProgramPoint& from, const ProgramPoint& to);

enum class ProgramFormat { rs274, canonical, csv };

/// Reads a program and hands every move to the sink, in memory that does not grow with it. A name ending in ".csv" is
/// read as CSV; else the first line with words decides between RS-274 and canonical calls.
/// @throws std::invalid_argument at the first line that is not understood; nothing is guessed.
ProgramFormat read_program(LineSource& source, const ReadOptions& options, MoveSink& sink);

}  // namespace accdec
