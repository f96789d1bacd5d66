#include <algorithm>
#include <cmath>
#include <cstdint>

#include <accdec/plan/free/free_motion.hpp>
#include <accdec/simulate/profile_motion.hpp>
#include <accdec/simulate/sample_check.hpp>

namespace accdec {
namespace {

/// Where on the step from a to b the point is nearest, not before `low`.
double nearest(const double* a, const double* b, const double* point, std::size_t n, double low) {
  double along = 0.0, length2 = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    along += (point[i] - a[i]) * (b[i] - a[i]);
    length2 += (b[i] - a[i]) * (b[i] - a[i]);
  }
  return std::clamp(length2 > 0.0 ? along / length2 : 0.0, low, 1.0);
}

}  // namespace

FreeSamples sampled(const Toolpath& path, const Trajectory& trajectory, double sample_period) {
  const std::size_t n = path.dimensions();
  FreeSamples motion;
  motion.position.assign(path.point(0), path.point(0) + n);
  std::vector<std::int64_t> first{0}, last{0};
  ProfileMotion profile(path, trajectory.chain, sample_period, trajectory.last);
  while (profile.next()) {
    motion.position.insert(motion.position.end(), profile.position(), profile.position() + n);
    first.push_back(profile.place_first());
    last.push_back(profile.place_last());
  }
  // Joint j is passed by a step whose samples may lie on the legs beside it.
  const std::size_t count = first.size();
  double least = 0.0;
  for (std::size_t j = 0; j + 1 < path.blocks(); ++j) {
    const auto place = static_cast<std::int64_t>(j);
    double best = unlimited, at = least;
    for (auto k = static_cast<std::size_t>(least) + 1;
         k < count && (std::min(first[k - 1], first[k]) + 1) / 2 <= place + 1; ++k) {
      if (last[k] / 2 < place) continue;
      const double* const a = motion.position.data() + (k - 1) * n;
      const double t = nearest(a, a + n, path.point(j + 1), n, std::max(0.0, least - static_cast<double>(k - 1)));
      double distance2 = 0.0;
      for (std::size_t i = 0; i < n; ++i) {
        const double d = a[i] + t * (a[n + i] - a[i]) - path.point(j + 1)[i];
        distance2 += d * d;
      }
      if (distance2 >= best) continue;
      best = distance2;
      at = static_cast<double>(k - 1) + t;
    }
    motion.passes.push_back(least = at);
  }
  return motion;
}

}  // namespace accdec
