#include <utility>

#include <accdec/task.hpp>

namespace accdec {
namespace {

Corner geometry_of(const CornerLegs& legs, double feed_in, double feed_out, int axes) {
  if (const auto* planar = std::get_if<PlanarLegs>(&legs))
    return planar_corner(planar->angle, planar->heading, planar->turn, feed_in, feed_out, axes);
  const auto vector = [](const std::vector<double>& v) {
    return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
  };
  const auto& directed = std::get<DirectedLegs>(legs);
  return make_corner(vector(directed.in), vector(directed.out), feed_in, feed_out);
}

}  // namespace

TaskCorner::TaskCorner(std::string corner_name, CornerLegs legs, double feed_in, double feed_out, int axes)
    : name(std::move(corner_name)), legs_(std::move(legs)), geometry_(geometry_of(legs_, feed_in, feed_out, axes)) {}

void TaskCorner::set_feeds(double feed_in, double feed_out) {
  geometry_ = geometry_of(legs_, feed_in, feed_out, static_cast<int>(geometry_.axes()));
}

}  // namespace accdec
