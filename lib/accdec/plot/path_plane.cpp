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

}  // namespace accdec
