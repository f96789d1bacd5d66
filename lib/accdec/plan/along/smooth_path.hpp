#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <accdec/plan/along/chord_curve.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// Whether arcs or chords of splines are among the blocks of a path.
bool has_curves(const Toolpath& path);

/// Blocks of a path as a curve: its arcs themselves instead of their chords, a smooth curve through the chords of
/// splines, and lines. The parameter u is the length, nearly so on spirals and splines.
class SmoothPath {
 public:
  struct Piece {
    double begin = 0.0, length = 0.0;                      ///< of u, m
    std::size_t first = 0, last = 0;                       ///< blocks
    const PathArc* arc = nullptr;                          ///< nullptr: a line, or a spline
    std::ptrdiff_t spline = -1;                            ///< which; -1: none
    double angle = 0.0, radius = 0.0, wider = 0.0;         ///< at the beginning; the radius grows by `wider`
    std::array<double, program_axis_count> from{}, way{};  ///< m, of the piece as a line
    std::array<double, program_axis_count> correction{};   ///< m, of the arc's end to the programmed one
    bool bends() const { return arc != nullptr || spline >= 0; }
  };

  /// Blocks first .. last. References are kept.
  SmoothPath(const Toolpath& path, std::size_t first, std::size_t last);
  double length() const { return pieces_.back().begin + pieces_.back().length; }
  const std::vector<Piece>& pieces() const { return pieces_; }
  /// Whether some piece bends.
  bool bends() const { return bends_; }
  /// m, of a piece from its chords, at most.
  double off_chords(const Piece& piece) const;
  /// @param piece  in which u lies
  PathPlace at(const Piece& piece, double u) const;
  /// The piece after the border nearest to u.
  std::size_t piece_at(double u) const;
  /// u at the end of a block of a piece.
  double end_of(const Piece& piece, std::size_t block) const;

 private:
  void add_line(std::size_t block);
  void add_arc(const PathArc& arc);
  void add_spline(std::size_t first, std::size_t last);

  const Toolpath& path_;
  std::vector<Piece> pieces_;
  std::vector<ChordCurve> splines_;
  bool bends_ = false;
};

}  // namespace accdec
