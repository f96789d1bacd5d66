#include <algorithm>
#include <cmath>
#include <cstdint>

#include <accdec/plan/verify/own_trajectory.hpp>
#include <accdec/plan/verify/used_limits.hpp>
#include <accdec/plan/verify/verify_path.hpp>
#include <accdec/simulate/profile_motion.hpp>

namespace accdec {
namespace {

/// Follows positions, from rest on.
class Follower {
 public:
  Follower(const Toolpath& path, double period, const Machine& machine)
      : path_(path), machine_(machine), period_(period), squares_(machine.axes.size(), 0.0L) {
    std::copy_n(path.point(0), path.dimensions(), before_.begin());
  }

  /// @param first, last  blocks that the sample may be on
  void look(const double* position, std::size_t first, std::size_t last) {
    ProgramPoint at{};
    std::copy_n(position, path_.dimensions(), at.begin());
    if (path_.contour_max < unlimited)
      own_.contour = std::max(own_.contour, off_blocks(path_, std::min(oldest_, first), last, before_, at));
    oldest_ = first;
    for (std::size_t a = 0; a < squares_.size(); ++a) {
      const double velocity = (at[a] - before_[a]) / period_;
      const long double force = force_of(machine_.axes[a], velocity, (velocity - velocity_[a]) / period_, period_);
      squares_[a] += force * force;
      velocity_[a] = velocity;
    }
    before_ = at;
    ++samples_;
  }
  /// So many more samples, at rest or straight on as before. @param position  of the last of them
  void pass(std::int64_t count, const double* position) {
    for (std::size_t a = 0; a < squares_.size(); ++a) {
      const long double force = force_of(machine_.axes[a], velocity_[a], 0.0, period_);
      squares_[a] += static_cast<long double>(count) * force * force;
    }
    if (count > 0) std::copy_n(position, path_.dimensions(), before_.begin());
    samples_ += count;
  }
  /// The motion rests one sample later.
  OwnTrajectory finish() {
    const ProgramPoint end = before_;
    look(end.data(), oldest_, oldest_);
    for (const long double sum : squares_)
      own_.rms.push_back(static_cast<double>(std::sqrt(sum / static_cast<long double>(samples_))));
    return std::move(own_);
  }

 private:
  const Toolpath& path_;
  const Machine& machine_;
  const double period_;
  std::vector<long double> squares_;  // N^2
  ProgramPoint before_{}, velocity_{};
  std::size_t oldest_ = 0;
  std::int64_t samples_ = 0;
  OwnTrajectory own_;
};

}  // namespace

OwnTrajectory own_trajectory(const Plan& plan, double sample_period, const Machine& machine) {
  const Toolpath& path = plan.path;
  const Trajectory& trajectory = *plan.trajectory();
  Follower follower(path, sample_period, machine);
  if (trajectory.is_free()) {
    for (std::size_t k = 0; k < trajectory.free.block.size(); ++k) {
      const std::size_t block = trajectory.free.block[k];
      follower.look(trajectory.free.position.data() + k * path.dimensions(), block, block);
    }
    return follower.finish();
  }
  ProfileMotion motion(path, trajectory.chain, sample_period, trajectory.last);
  for (; motion.next(); follower.pass(motion.pass_steady(), motion.position())) {
    // An odd place is the corner between two blocks.
    const auto first = static_cast<std::size_t>(motion.place_first() / 2);
    const auto last = static_cast<std::size_t>((motion.place_last() + 1) / 2);
    follower.look(motion.position(), first, std::min(last, path.blocks() - 1));
  }
  return follower.finish();
}

}  // namespace accdec
