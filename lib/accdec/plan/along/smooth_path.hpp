#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <accdec/simulate.hpp>

namespace accdec {

/// Place of a path and its first two derivatives by the parameter u, one value a dimension.
struct PathPlace {
  std::array<double, program_axis_count> position{}, first{}, second{};
};

/// Blocks of a path as a curve: its arcs themselves instead of their chords, and lines. The parameter u is the length,
/// nearly so on spirals.
class SmoothPath {
 public:
  struct Piece {
    double begin = 0.0, length = 0.0;                      ///< of u, m
    std::size_t first = 0, last = 0;                       ///< blocks
    const PathArc* arc = nullptr;                          ///< nullptr: a line
    double angle = 0.0, radius = 0.0, wider = 0.0;         ///< at the beginning; the radius grows by `wider`
    std::array<double, program_axis_count> from{}, way{};  ///< m, of the piece as a line
    std::array<double, program_axis_count> correction{};   ///< m, of the arc's end to the programmed one
  };

  /// Blocks first .. last. References are kept.
  SmoothPath(const Toolpath& path, std::size_t first, std::size_t last);
  double length() const { return pieces_.back().begin + pieces_.back().length; }
  const std::vector<Piece>& pieces() const { return pieces_; }
  bool has_arcs() const { return arcs_; }
  /// @param piece  in which u lies
  PathPlace at(const Piece& piece, double u) const;
  /// The piece after the border nearest to u.
  std::size_t piece_at(double u) const;
  /// The block in which u lies.
  std::size_t block_at(const Piece& piece, double u) const;
  /// u at the end of a block of a piece.
  double end_of(const Piece& piece, std::size_t block) const;

 private:
  void add_line(std::size_t block);
  void add_arc(const PathArc& arc);

  const Toolpath& path_;
  std::vector<Piece> pieces_;
  bool arcs_ = false;
};

}  // namespace accdec
