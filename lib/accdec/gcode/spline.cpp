#include <algorithm>
#include <cmath>

#include <accdec/gcode/spline.hpp>

namespace accdec {
namespace {

constexpr std::size_t spline_chords_max = 10'000'000;
constexpr int spline_halvings_max = 60;  // of a piece; chords are far below rounding then

struct Homogeneous {
  double x, y, w;
};
using BezierPiece = std::vector<Homogeneous>;

Homogeneous interpolated(const Homogeneous& a, const Homogeneous& b, double t) {
  return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.w + t * (b.w - a.w)};
}

class Flattener {
 public:
  Flattener(const std::vector<ControlPoint>& control, int order, double tolerance)
      : degree_(static_cast<std::size_t>(order) - 1), tolerance_(tolerance) {
    for (const ControlPoint& p : control) control_.push_back({p.x * p.weight, p.y * p.weight, p.weight});
  }

  std::vector<std::array<double, 2>> run() {
    for (std::size_t span = degree_; span < control_.size(); ++span) {
      if (!flatten(bezier(span), 0)) return {};
    }
    return std::move(points_);
  }

 private:
  double knot(std::size_t i) const {
    const std::size_t inside = control_.size() - degree_;  // knot spans
    return i <= degree_ ? 0.0 : static_cast<double>(std::min(i - degree_, inside));
  }

  /// The polar form of a knot span: `low` arguments are its begin, the others its end.
  Homogeneous blossom(std::size_t span, std::size_t low) const {
    const auto first = static_cast<std::ptrdiff_t>(span - degree_);
    BezierPiece d(control_.begin() + first, control_.begin() + first + static_cast<std::ptrdiff_t>(degree_) + 1);
    for (std::size_t r = 1; r <= degree_; ++r) {
      const double t = knot(r <= low ? span : span + 1);
      for (std::size_t i = degree_; i >= r; --i) {
        const double begin = knot(i + span - degree_), end = knot(i + 1 + span - r);
        d[i] = interpolated(d[i - 1], d[i], (t - begin) / (end - begin));
      }
    }
    return d[degree_];
  }

  BezierPiece bezier(std::size_t span) const {
    BezierPiece piece;
    for (std::size_t i = 0; i <= degree_; ++i) piece.push_back(blossom(span, degree_ - i));
    return piece;
  }

  /// Control points from the chord between the ends.
  bool flat(const BezierPiece& piece) const {
    const double x0 = piece.front().x / piece.front().w, y0 = piece.front().y / piece.front().w;
    const double dx = piece.back().x / piece.back().w - x0, dy = piece.back().y / piece.back().w - y0;
    const double length2 = dx * dx + dy * dy;
    return std::all_of(piece.begin() + 1, piece.end() - 1, [&](const Homogeneous& p) {
      const double x = p.x / p.w - x0, y = p.y / p.w - y0;
      const double t = length2 > 0.0 ? std::clamp((x * dx + y * dy) / length2, 0.0, 1.0) : 0.0;
      return std::hypot(x - t * dx, y - t * dy) <= tolerance_;
    });
  }

  bool flatten(const BezierPiece& piece, int depth) {
    if (depth == spline_halvings_max || flat(piece)) {
      points_.push_back({piece.back().x / piece.back().w, piece.back().y / piece.back().w});
      return points_.size() <= spline_chords_max;
    }
    // De Casteljau: the first points of every row are the one half, the last ones the other.
    BezierPiece row = piece, first, second(piece.size());
    for (std::size_t left = piece.size(); left > 0; --left) {
      first.push_back(row.front());
      second[left - 1] = row[left - 1];
      for (std::size_t i = 0; i + 1 < left; ++i) row[i] = interpolated(row[i], row[i + 1], 0.5);
    }
    return flatten(first, depth + 1) && flatten(second, depth + 1);
  }

  std::size_t degree_;
  double tolerance_;
  BezierPiece control_;
  std::vector<std::array<double, 2>> points_;
};

}  // namespace

std::vector<std::array<double, 2>> flatten_spline(const std::vector<ControlPoint>& control, int order,
                                                  double tolerance) {
  return Flattener(control, order, tolerance).run();
}

}  // namespace accdec
