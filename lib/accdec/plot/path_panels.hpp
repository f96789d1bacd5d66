#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <accdec/plot/figure.hpp>
#include <accdec/plot/path_plane.hpp>
#include <accdec/result.hpp>
#include <accdec/task/simulation.hpp>

// Internal to the library.

namespace accdec {

/// The motion of one corner of a result, behind the machine's response.
struct CornerMotion {
  CornerMotion(const DesignResult& result, std::size_t index);
  CornerMotion(const CornerMotion&) = delete;
  CornerMotion& operator=(const CornerMotion&) = delete;

  const DesignResult& result;
  const TaskCorner& task;
  const CornerResult& measures;
  SampledResponse sampled;      ///< also the command
  const SampledMotion& motion;  ///< in `sampled`
  std::vector<double> time;     ///< ms from the corner command, of every row of `motion`
};

/// The path where it leaves the legs, with the tolerance and the error. That of `before` in grey below it, if not null.
Panel path_panel(const CornerMotion& now, const CornerMotion* before);
/// Distance of the path from the nearer leg over time, also between samples where it is largest there; nothing where no
/// motion leaves its legs.
std::optional<Panel> distance_panel(const CornerMotion& now, const CornerMotion* before);

}  // namespace accdec
