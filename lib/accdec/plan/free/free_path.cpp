#include <algorithm>
#include <stdexcept>

#include <accdec/machine/limits.hpp>
#include <accdec/plan/feeds/contour_feeds.hpp>
#include <accdec/plan/free/free_path.hpp>
#include <accdec/simulate/command_stream.hpp>
#include <accdec/simulate/tube_check.hpp>

namespace accdec {

FreePath::FreePath(const Toolpath& toolpath, const Machine& limits, double sample_period)
    : path(within_contour(toolpath)),
      machine(limits),
      period(sample_period),
      radius(allowed_off(path)),
      feed(feed_limits(toolpath)),
      jerk(limits_jerk(limits)) {}

std::size_t FreePath::rests_at(std::size_t block) const {
  double time = 0.0;
  for (const auto& [b, dwell] : path.dwells_at(block)) time += dwell;
  return static_cast<std::size_t>(whole_samples(time / period));
}

std::vector<std::size_t> legs_of(const Toolpath& path, const FreeSamples& motion) {
  std::vector<std::size_t> legs(motion.count(path.dimensions()));
  std::size_t leg = 0;
  for (std::size_t k = 0; k < legs.size(); ++k) {
    while (leg < motion.passes.size() && motion.passes[leg] <= static_cast<double>(k)) ++leg;
    legs[k] = leg;
  }
  return legs;
}

}  // namespace accdec
