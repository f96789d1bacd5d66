#include <algorithm>
#include <cmath>

#include <accdec/plan/feeds/steady_passing.hpp>

namespace accdec {
namespace {

/// Samples from the command to the motion: the middle of the axes' mean delays.
double mean_of_axes(const FilterBehind& behind, std::size_t axes) {
  double least = behind.motion(0).mean_delay(), most = least;
  for (std::size_t a = 1; a < axes; ++a) {
    least = std::min(least, behind.motion(a).mean_delay());
    most = std::max(most, behind.motion(a).mean_delay());
  }
  return 0.5 * (least + most);
}

double norm2(const double* v, std::size_t n) {
  double sum = 0.0;
  for (std::size_t a = 0; a < n; ++a) sum += v[a] * v[a];
  return sum;
}

}  // namespace

SteadyPassing::SteadyPassing(const Toolpath& path, const FeedPath& feeds, const FilterBehind& behind,
                             double sample_period)
    : path_(path),
      feeds_(feeds),
      behind_(behind),
      period_(sample_period),
      passing_(mean_of_axes(behind, feeds.dimensions)) {}

/// Adds, for axes first .. last, where their filter moves them at the moment the joint at the end of block b is passed.
void SteadyPassing::add_seen(const Filter& filter, std::size_t b, double step, std::size_t first, std::size_t last,
                             Way& sum) const {
  const double* joint = path_.programmed_point(b + 1);
  // Taps before the passing see the path beyond the joint, those after it the path before.
  const int passing = static_cast<int>(std::floor(passing_));
  std::size_t block = b + 1;
  double from = 0.0;
  for (int i = std::min(passing, filter.last_nonzero_tap()); i >= filter.first_nonzero_tap(); --i) {
    const double s = (passing_ - i) * step;
    while (block + 1 < feeds_.blocks() && from + feeds_.length[block] < s && !ends_leg(path_, block))
      from += feeds_.length[block++];
    const double x = std::min(s - from, feeds_.length[block]), tap = filter.tap(i);
    const double *p = path_.point(block), *u = feeds_.direction.data() + block * feeds_.dimensions;
    for (std::size_t a = first; a <= last; ++a) sum[a] += tap * (p[a] + x * u[a] - joint[a]);
  }
  block = b;
  from = 0.0;
  for (int i = std::max(passing + 1, filter.first_nonzero_tap()); i <= filter.last_nonzero_tap(); ++i) {
    const double s = (i - passing_) * step;
    while (block > 0 && from + feeds_.length[block] < s && !ends_leg(path_, block - 1)) from += feeds_.length[block--];
    const double x = std::min(s - from, feeds_.length[block]), tap = filter.tap(i);
    const double *p = path_.point(block + 1), *u = feeds_.direction.data() + block * feeds_.dimensions;
    for (std::size_t a = first; a <= last; ++a) sum[a] += tap * (p[a] - x * u[a] - joint[a]);
  }
}

double SteadyPassing::error(std::size_t b, double v) const {
  const std::size_t n = feeds_.dimensions;
  Way sum{};
  if (!behind_.differs()) add_seen(behind_.motion(), b, v * period_, 0, n - 1, sum);
  for (std::size_t a = 0; a < n && behind_.differs(); ++a) add_seen(behind_.motion(a), b, v * period_, a, a, sum);
  // Distances along the path cost nothing.
  Way along{};
  for (std::size_t a = 0; a < n; ++a) along[a] = feeds_.direction[b * n + a] + feeds_.direction[(b + 1) * n + a];
  const double length2 = norm2(along.data(), n);
  double dot = 0.0;
  for (std::size_t a = 0; a < n; ++a) dot += sum[a] * along[a];
  for (std::size_t a = 0; a < n; ++a) sum[a] -= dot / std::max(length2, 1e-300) * along[a];
  return std::sqrt(norm2(sum.data(), n));
}

}  // namespace accdec
