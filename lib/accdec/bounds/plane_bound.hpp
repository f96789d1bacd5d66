#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include <accdec/bounds/plane_window.hpp>

namespace accdec {

/// A straight leg between two corners.
struct PlaneLeg {
  TubeLeg tube;
  double way = 0.0;        ///< s, at its pace
  double tolerance = 0.0;  ///< m, of the corner at its end
};

/// Times that no motion over legs undercuts, as a sum over corners.
///
/// Every motion crosses a plane that separates the tolerances at both ends of a leg. So the time from rest to rest is
/// at least the sum of the least times from plane to plane (plane_time). Any planes are valid. They lie where a simple
/// motion is fastest, because velocities are free in them. They are tilted towards the difference of the accelerations
/// at both corners. This keeps the motions of both sides from crossing them at opposite edges of the tube. Legs too
/// short for a plane count at the pace only, together with their corners.
class PlaneBound {
 public:
  /// @param more  whether another linear program may be solved
  PlaneBound(const Machine& machine, std::size_t dimensions, std::function<bool()> more)
      : machine_(machine), n_(dimensions), more_(std::move(more)) {}

  /// s, from rest to rest; less than zero if there is no bound, or if a part of the windows says that it is far below
  /// what is known.
  double time(const std::vector<PlaneLeg>& legs, double known = 0.0);

 private:
  struct Plane {
    bool exists = false;
    AxisVector normal{};               // with the part 1 along the leg
    double first = 0.0, second = 0.0;  // m, from the leg's first and second end along the normal
    bool tilted = false;
  };
  void make_planes(const std::vector<PlaneLeg>& legs);
  double expected(const std::vector<PlaneLeg>& legs);
  double acceleration_along(const AxisVector& direction) const;
  double corner_speed(const PlaneLeg& in, const PlaneLeg& out) const;
  double window(const PlaneLeg& in, const Plane& from, const PlaneLeg& out, const Plane& to);
  double rest(const PlaneLeg& leg, const AxisVector& normal, double way);
  double found(const PlaneWindow& window);

  const Machine& machine_;
  const std::size_t n_;
  const std::function<bool()> more_;
  std::vector<Plane> planes_;
  std::map<std::vector<std::int64_t>, double> known_;
};

}  // namespace accdec
