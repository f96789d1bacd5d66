#include <cmath>

#include <accdec/machine/limit_unit.hpp>
#include <accdec/plot/path_plane.hpp>

namespace accdec {

PathPlane plane_of(const Corner& corner, const Machine& machine) {
  if (corner.axes() == 2) {
    return {Eigen::Vector2d(1, 0), Eigen::Vector2d(0, 1), machine.axes[0].name, machine.axes[1].name};
  }
  const auto unit = [](Eigen::VectorXd v) {
    const double length = v.norm();
    return length > 1e-9 ? Eigen::VectorXd(v / length) : Eigen::VectorXd(Eigen::VectorXd::Zero(v.size()));
  };
  PathPlane plane{unit(corner.direction_in + corner.direction_out), unit(corner.direction_out - corner.direction_in),
                  "along the motion", "towards the inside"};
  // A motion that turns back has no inside.
  if (plane.across.isZero()) plane.across = corner.direction_in, plane.up.setZero();
  return plane;
}

std::string plane_unit(const Eigen::VectorXd& direction, const Machine& machine, bool large) {
  bool moves = false, turns = false;
  for (Eigen::Index a = 0; a < direction.size(); ++a) {
    if (std::abs(direction[a]) > 1e-12)
      (is_rotary(machine.axes[static_cast<std::size_t>(a)].name) ? turns : moves) = true;
  }
  const std::string length = large ? "mm" : "µm", angle = large ? "deg" : "mdeg";
  return !turns ? length : !moves ? angle : length + ", " + angle;
}

}  // namespace accdec
