#pragma once

#include <string>

#include <Eigen/Core>

#include <accdec/corner.hpp>
#include <accdec/machine.hpp>

// Internal to the library.

namespace accdec {

/// Axes of the drawing: the machine's first two if it has no more, else the plane of the corner, along the motion and
/// halving the angle.
struct PathPlane {
  Eigen::VectorXd across, up;
  std::string across_name, up_name;
};
PathPlane plane_of(const Corner& corner, const Machine& machine);

/// The unit of a direction of the drawing, whose axes move or turn: "µm" or "mdeg", or both.
/// @param large  "mm" or "deg"
std::string plane_unit(const Eigen::VectorXd& direction, const Machine& machine, bool large);

}  // namespace accdec
