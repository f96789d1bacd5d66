#include <algorithm>
#include <cmath>

#include <accdec/plan/free/shorten.hpp>
#include <accdec/simulate/sample_check.hpp>

namespace accdec {

bool keeps_path(const FreePath& free, const FreePart& part, std::size_t count, const std::vector<double>& passes,
                const std::function<const double*(std::ptrdiff_t)>& row) {
  constexpr double above_feed = 1.0 + 5e-7;  // the check grants 1e-6
  const std::size_t n = free.dimensions();
  const auto within = [&](const double* from, const double* to, const double* x, double most) {
    return holds(std::sqrt(segment_distance2(from, to, x, n)), most);
  };
  std::size_t leg = part.first_joint;
  for (std::size_t k = 0; k <= count; ++k) {
    double feed = free.feed[leg], step = 0.0;
    while (leg - part.first_joint < passes.size() && passes[leg - part.first_joint] <= static_cast<double>(k)) ++leg;
    feed = std::max(feed, free.feed[leg]);
    const double *const before = row(static_cast<std::ptrdiff_t>(k) - 1), *const x =
                                                                              row(static_cast<std::ptrdiff_t>(k));
    if (k < count && !within(free.path.point(leg), free.path.point(leg + 1), x, free.radius[leg] + free.slack))
      return false;
    for (std::size_t a = 0; a < n; ++a) step = std::hypot(step, x[a] - before[a]);
    if (step > free.period * feed * above_feed) return false;
  }
  for (std::size_t i = 0; i < passes.size() && passes[i] <= static_cast<double>(count); ++i) {
    const double floor = std::floor(passes[i]), f = passes[i] - floor;
    const double *const before = row(static_cast<std::ptrdiff_t>(floor)), *const after = row(std::min(
                                                                              static_cast<std::ptrdiff_t>(floor) + 1,
                                                                              static_cast<std::ptrdiff_t>(count)));
    ProgramPoint x{};
    for (std::size_t a = 0; a < n; ++a) x[a] = (1.0 - f) * before[a] + f * after[a];
    const std::size_t joint = part.first_joint + i;
    const double* const point = free.path.point(joint + 1);
    if (!within(point, point, x.data(), free.passes_within(joint) + free.slack)) return false;
    for (std::size_t b = joint; free.has_contour() && b <= joint + 1; ++b) {
      if (!within(free.path.point(b), free.path.point(b + 1), x.data(), free.path.contour_max + free.slack))
        return false;
    }
  }
  return true;
}

}  // namespace accdec
