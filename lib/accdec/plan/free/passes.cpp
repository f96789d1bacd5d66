#include <algorithm>
#include <cmath>

#include <accdec/plan/free/passes.hpp>

namespace accdec {
namespace {

/// The place on the step from a to b that is nearest to a point, 0 .. 1, and the distance squared.
double nearest(const double* a, const double* b, const double* point, std::size_t n, double low, double high,
               double& distance2) {
  double along = 0.0, length2 = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double d = b[i] - a[i];
    along += (point[i] - a[i]) * d;
    length2 += d * d;
  }
  const double t = std::clamp(length2 > 0.0 ? along / length2 : 0.0, low, high);
  distance2 = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double d = a[i] + t * (b[i] - a[i]) - point[i];
    distance2 += d * d;
  }
  return t;
}

}  // namespace

void find_passes(const Toolpath& path, Window& window, double more) {
  const std::size_t n = path.dimensions();
  const auto size = static_cast<std::ptrdiff_t>(window.size);
  const auto sample = [&](std::ptrdiff_t k) {
    if (k < 0) return window.before.data() + window.before.size() - n;
    return k < size ? window.guess.data() + static_cast<std::size_t>(k) * n : window.after.data();
  };
  double least = -1.0;
  for (WindowPass& pass : window.passes) {
    const double reach = window.slide * pass.room + more;
    const double low = std::max(least, pass.at - reach);
    const double high = std::max(low, std::min(pass.at + reach, static_cast<double>(size) - 1e-6));
    double best = unlimited, at = low;
    for (auto k = static_cast<std::ptrdiff_t>(std::floor(low)); k <= static_cast<std::ptrdiff_t>(std::floor(high));
         ++k) {
      const auto whole = static_cast<double>(k);
      double distance2 = 0.0;
      const double t = nearest(sample(k), sample(k + 1), path.point(pass.joint + 1), n, std::max(0.0, low - whole),
                               std::min(1.0, high - whole), distance2);
      if (distance2 >= best) continue;
      best = distance2;
      at = whole + t;
    }
    pass.at = least = at;
  }
}

}  // namespace accdec
