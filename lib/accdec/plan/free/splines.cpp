#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <accdec/bounds/corner_bound.hpp>
#include <accdec/plan/free/splines.hpp>

namespace accdec {
namespace {

constexpr double tolerance_share = 0.1;  // that control points may lose
constexpr std::size_t seam = 100;        // samples of a window that joins a spline to the motion beside it
constexpr int seam_more = 8;             // that it may add

/// m: the most by which control points move towards their neighbours, while others are put between them until they are
/// samples.
double bend(const FreePath& fine, std::size_t spacing) {
  double acceleration = 0.0, sum = 0.0;
  for (const Axis& axis : fine.machine.axes) acceleration = std::hypot(acceleration, acceleration_most(axis));
  for (; spacing > 1; spacing /= 2)
    sum += acceleration * std::pow(static_cast<double>(spacing) * fine.period, 2.0) / 8.0;
  return sum;
}

/// Whether the joint at the end of a block grants a way off the path.
bool grants(const Toolpath& path, std::size_t block) {
  return path.joint[block] != Joint::stop && path.tolerance[block] > 0.0;
}

Toolpath narrowed(Toolpath path, double by) {
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    if (grants(path, b)) path.tolerance[b] = std::max(0.0, path.tolerance[b] - by);
  }
  path.contour_max = std::max(0.0, path.contour_max - by);
  return path;
}

/// A force is that of an acceleration and of a speed, whose means between control points are not the same.
/// @param period  s, the sum of half the spacings
Machine weakened(Machine machine, double period) {
  for (Axis& axis : machine.axes) {
    if (axis.force_max < unlimited) axis.force_max -= axis.damping * acceleration_most(axis) * period;
  }
  return machine;
}

/// Twice as many control points of the same spline: from the middle of the first two to the middle of the last two.
std::vector<double> refined(const std::vector<double>& coarse, std::size_t n) {
  std::vector<double> fine;
  fine.reserve(2 * coarse.size());
  const auto x = [&](std::size_t k, std::size_t a) { return coarse[k * n + a]; };
  for (std::size_t k = 0; k + 1 < coarse.size() / n; ++k) {
    if (k > 0) {
      for (std::size_t a = 0; a < n; ++a) fine.push_back((x(k - 1, a) + 6.0 * x(k, a) + x(k + 1, a)) / 8.0);
    }
    for (std::size_t a = 0; a < n; ++a) fine.push_back((x(k, a) + x(k + 1, a)) / 2.0);
  }
  return fine;
}

/// Samples of a part, with its joints that are passed between first - 1 and last.
FreePart cut(const FreePart& part, const std::vector<double>& passes, std::size_t first, std::size_t last) {
  FreePart piece{part.begin + first, part.begin + last, part.first_joint, part.first_joint};
  for (const double pass : passes) {
    if (pass <= static_cast<double>(first) - 1.0) {
      ++piece.first_joint;
    } else if (pass < static_cast<double>(last)) {
      piece.passes.push_back(pass - static_cast<double>(first));
    }
  }
  piece.end_joint = piece.first_joint + piece.passes.size();
  return piece;
}

}  // namespace

SplineTube::SplineTube(const FreePath& fine, std::size_t spacing)
    : fine_(fine),
      spacing_(spacing),
      loss_(bend(fine, spacing)),
      path_(narrowed(fine.path, loss_)),
      machine_(weakened(fine.machine, static_cast<double>(spacing - 1) * fine.period)),
      tube_(path_, machine_, static_cast<double>(spacing) * fine.period) {
  tube_.slack = 2.0 * loss_;
}

bool SplineTube::has_room(const FreePart& part) const {
  double least = unlimited;
  for (std::size_t j = part.first_joint; j < part.end_joint; ++j) {
    if (grants(fine_.path, j)) least = std::min({least, fine_.path.tolerance[j], fine_.path.contour_max});
  }
  return least < unlimited && loss_ <= tolerance_share * least;
}

ShortenedPart SplineTube::shorten(const std::vector<double>& position, const FreePart& part, std::size_t size,
                                  const std::function<bool()>& stop) const {
  const std::size_t n = fine_.dimensions(), count = (part.end - part.begin) / spacing_, halo = tube_.border() + 2;
  // Control points are every so many samples, also of the motion around the part.
  const auto rows = static_cast<std::ptrdiff_t>(position.size() / n), step = static_cast<std::ptrdiff_t>(spacing_);
  std::vector<double> points;
  for (std::ptrdiff_t k = 0; k < static_cast<std::ptrdiff_t>(count + 2 * halo); ++k) {
    const std::ptrdiff_t sample =
        static_cast<std::ptrdiff_t>(part.begin) + step * (k - static_cast<std::ptrdiff_t>(halo));
    const double* const row =
        position.data() + static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(sample, 0, rows - 1)) * n;
    points.insert(points.end(), row, row + n);
  }
  FreePart coarse = cut(part, part.passes, 0, count * spacing_);
  coarse.begin = halo;
  coarse.end = halo + count;
  for (double& pass : coarse.passes) pass /= static_cast<double>(spacing_);
  ShortenedPart result = accdec::shorten(tube_, points, coarse, size, stop);
  if (result.saved == 0) return result;
  // Behind those that were moved are the old ones.
  const std::size_t taken = (result.moved + result.saved) * spacing_;
  result.position.resize(result.moved * n);
  const auto at = [&](std::size_t k) { return points.begin() + static_cast<std::ptrdiff_t>(k * n); };
  std::vector<double> spline(at(0), at(halo));
  spline.insert(spline.end(), result.position.begin(), result.position.end());
  spline.insert(spline.end(), at(halo + result.moved + result.saved), points.end());
  std::size_t before = halo;  // rows before the part
  for (std::size_t s = spacing_; s > 1; s /= 2) {
    spline = refined(spline, n);
    before = 2 * before - 1;
  }
  const std::size_t made = result.moved * spacing_;
  spline.erase(spline.begin(), spline.begin() + static_cast<std::ptrdiff_t>(before * n));
  spline.resize(made * n);
  for (double& pass : result.passes) pass *= static_cast<double>(spacing_);
  for (std::size_t i = coarse.passes.size(); i < part.passes.size(); ++i)
    result.passes.push_back(part.passes[i] - static_cast<double>(spacing_ * result.saved));
  return joined(position, part, spline, taken, std::move(result));
}

/// @param taken   samples of the part in whose place the spline is
/// @param result  with the passes of part and spline
ShortenedPart SplineTube::joined(const std::vector<double>& position, const FreePart& part,
                                 const std::vector<double>& spline, std::size_t taken, ShortenedPart result) const {
  const std::size_t n = fine_.dimensions(), made = spline.size() / n;
  const std::size_t total = part.end - part.begin - taken + made;
  const ShortenedPart stays{{}, {}, 0, 0, result.programmes, result.iterations};
  if (made < 3 * seam) return stays;
  // The motion around, with the spline in it: it breaks limits at both ends of the spline.
  const std::size_t around = fine_.border() + 2, from = part.begin - std::min(part.begin, around);
  const auto old = [&](std::size_t k) {
    return position.begin() + static_cast<std::ptrdiff_t>(std::min(k * n, position.size()));
  };
  std::vector<double> motion(old(from), old(part.begin));
  motion.insert(motion.end(), spline.begin(), spline.end());
  motion.insert(motion.end(), old(part.begin + taken), old(part.end + around));
  FreePart whole{part.begin - from, part.begin - from + total, part.first_joint, part.end_joint, result.passes};
  const FreePart first = cut(whole, whole.passes, 0, seam);
  const FreePart last = cut(whole, whole.passes, made - seam, std::min(total, made + seam));
  const auto left = shorten_at_once(fine_, motion, first, seam_more);
  const auto right = left ? shorten_at_once(fine_, motion, last, seam_more) : std::nullopt;
  if (!right) return stays;
  const double later = static_cast<double>(left->position.size() / n) - static_cast<double>(seam);
  const double ahead = static_cast<double>(made - seam) + later;
  result.position = left->position;
  result.position.insert(result.position.end(), spline.begin() + static_cast<std::ptrdiff_t>(seam * n),
                         spline.end() - static_cast<std::ptrdiff_t>(seam * n));
  result.position.insert(result.position.end(), right->position.begin(), right->position.end());
  result.position.insert(result.position.end(), motion.begin() + static_cast<std::ptrdiff_t>(last.end * n),
                         motion.begin() + static_cast<std::ptrdiff_t>(whole.end * n));
  const double behind =
      later + static_cast<double>(right->position.size() / n) - static_cast<double>(last.end - last.begin);
  for (std::size_t i = 0; i < result.passes.size(); ++i) {
    const std::size_t joint = part.first_joint + i;
    if (joint < first.end_joint)
      result.passes[i] = left->passes[i];
    else if (joint < last.first_joint)
      result.passes[i] += later;
    else if (joint < last.end_joint)
      result.passes[i] = right->passes[joint - last.first_joint] + ahead;
    else
      result.passes[i] += behind;
  }
  result.programmes += left->programmes + right->programmes;
  const std::size_t samples = result.position.size() / n;
  if (samples >= part.end - part.begin) return stays;
  result.saved = part.end - part.begin - samples;
  const bool kept = keeps_path(fine_, part, samples, result.passes, [&](std::ptrdiff_t k) -> const double* {
    const auto count = static_cast<std::ptrdiff_t>(samples);
    if (k >= 0 && k < count) return result.position.data() + static_cast<std::size_t>(k) * n;
    return position.data() + (k < 0 ? part.begin - 1 : part.end) * n;
  });
  return kept ? result : stays;
}

}  // namespace accdec
