#include <algorithm>
#include <cmath>

#include <accdec/plan/along/smooth_path.hpp>

namespace accdec {

bool has_curves(const Toolpath& path) {
  return !path.arcs.empty() || std::ranges::count(path.inside_arc, 0) < std::ssize(path.inside_arc);
}

SmoothPath::SmoothPath(const Toolpath& path, std::size_t first, std::size_t last) : path_(path) {
  auto arc = std::lower_bound(path.arcs.begin(), path.arcs.end(), first,
                              [](const PathArc& a, std::size_t block) { return a.first < block; });
  for (std::size_t b = first; b <= last;) {
    // An arc that is cut by a stop stays chords.
    if (arc != path.arcs.end() && arc->first == b && arc->last <= last && arc->angle != 0.0) {
      add_arc(*arc);
      b = arc->last + 1;
    } else {
      // Chords with a stop among them stay chords, as do those of an arc.
      const bool of_arc = arc != path.arcs.end() && arc->first == b;
      std::size_t end = b;
      while (!of_arc && end < last && path.inside_arc[end] != 0) ++end;
      if (end > b)
        add_spline(b, end);
      else
        add_line(b);
      b = end + 1;
    }
    while (arc != path.arcs.end() && arc->first < b) ++arc;
  }
}

void SmoothPath::add_line(std::size_t block) {
  Piece piece;
  piece.first = piece.last = block;
  const std::size_t n = path_.dimensions();
  const double* p = path_.point(block);
  for (std::size_t a = 0; a < n; ++a) {
    piece.from[a] = p[a];
    piece.way[a] = p[n + a] - p[a];
    piece.length = std::hypot(piece.length, piece.way[a]);
  }
  piece.begin = pieces_.empty() ? 0.0 : length();
  pieces_.push_back(piece);
}

void SmoothPath::add_arc(const PathArc& arc) {
  add_line(arc.first);
  Piece& piece = pieces_.back();
  piece.arc = &arc;
  piece.last = arc.last;
  const std::size_t n = path_.dimensions();
  const double* to = path_.point(arc.last + 1);
  double dx = 0.0, dy = 0.0;
  piece.radius = arc.from(path_.point(arc.first), dx, dy);
  piece.angle = std::atan2(dy, dx);
  piece.wider = arc.from(to, dx, dy) - piece.radius;
  piece.length = std::hypot((piece.radius + 0.5 * piece.wider) * arc.angle, piece.wider);
  for (std::size_t a = 0; a < n; ++a) {
    if (a == arc.x || a == arc.y) continue;
    piece.way[a] = to[a] - piece.from[a];
    piece.length = std::hypot(piece.length, piece.way[a]);
  }
  const PathPlace end = at(piece, piece.begin + piece.length);
  for (std::size_t a = 0; a < n; ++a) piece.correction[a] = to[a] - end.position[a];
  bends_ = true;
}

void SmoothPath::add_spline(std::size_t first, std::size_t last) {
  add_line(first);
  Piece& piece = pieces_.back();
  piece.last = last;
  piece.spline = std::ssize(splines_);
  splines_.emplace_back(path_, first, last);
  piece.length = splines_.back().length();
  bends_ = true;
}

double SmoothPath::off_chords(const Piece& piece) const {
  if (piece.spline >= 0) return splines_[static_cast<std::size_t>(piece.spline)].off_chords();
  if (piece.arc == nullptr) return 0.0;
  const double chords = static_cast<double>(piece.last - piece.first + 1);
  const double quarter = std::sin(0.25 * piece.arc->angle / chords);
  return 2.0 * (piece.radius + std::max(0.0, piece.wider)) * quarter * quarter;
}

PathPlace SmoothPath::at(const Piece& piece, double u) const {
  if (piece.spline >= 0) return splines_[static_cast<std::size_t>(piece.spline)].at(u - piece.begin);
  PathPlace place;
  const double rate = 1.0 / piece.length, t = (u - piece.begin) * rate;
  for (std::size_t a = 0; a < path_.dimensions(); ++a) {
    const double way = piece.way[a] + piece.correction[a];
    place.position[a] = piece.from[a] + t * way;
    place.first[a] = rate * way;
  }
  if (piece.arc == nullptr) return place;
  const PathArc& arc = *piece.arc;
  const double turn = arc.angle, angle = piece.angle + t * turn, r = piece.radius + t * piece.wider;
  const double cosine = std::cos(angle), sine = std::sin(angle);
  const auto set = [&](std::size_t a, double center, double along, double across) {
    place.position[a] = center + r * along + t * piece.correction[a];
    place.first[a] = rate * (piece.wider * along + r * turn * across + piece.correction[a]);
    place.second[a] = rate * rate * turn * (2.0 * piece.wider * across - r * turn * along);
  };
  set(arc.x, arc.center_x, cosine, -sine);
  set(arc.y, arc.center_y, sine, cosine);
  return place;
}

std::size_t SmoothPath::piece_at(double u) const {
  const auto after =
      std::upper_bound(pieces_.begin(), pieces_.end(), u, [](double x, const Piece& p) { return x < p.begin; });
  return after == pieces_.begin() ? 0 : static_cast<std::size_t>(after - pieces_.begin()) - 1;
}

double SmoothPath::end_of(const Piece& piece, std::size_t block) const {
  if (piece.spline >= 0) return piece.begin + splines_[static_cast<std::size_t>(piece.spline)].end(block - piece.first);
  const auto blocks = static_cast<double>(piece.last - piece.first + 1);
  return piece.begin + piece.length * static_cast<double>(block - piece.first + 1) / blocks;
}

}  // namespace accdec
