#include <algorithm>
#include <cstdint>
#include <vector>

#include <accdec/plan/result/arc_error.hpp>
#include <accdec/simulate/arc_points.hpp>
#include <accdec/simulate/command_stream.hpp>
#include <accdec/simulate/profile_motion.hpp>

namespace accdec {
namespace {

/// The first and the last sample in which a filtered command may be at every joint.
struct JointSamples {
  std::int64_t begin = 0, order = 0;
  std::vector<std::int64_t> first{}, last{};
  template <class Row>
  void command(const Row& /*u0*/, const Row& /*u*/, std::int64_t /*count*/, const Row& /*end*/) {}
  void joint(std::size_t /*block*/, double time, std::int64_t rest) {
    first.push_back(begin + static_cast<std::int64_t>(time));
    last.push_back(first.back() + rest + order + 2);
  }
};

void look_at_command(const Plan& plan, double period, ArcPoints& arcs) {
  const FilteredCommand& command = *plan.command();
  const CommandTiming timing(plan.path, period, command.delays);
  int longest = 0;
  for (const Filter& motion : command.motion()) longest = std::max(longest, motion.order());
  JointSamples joints{timing.dwell_samples(plan.path.dwell_first), longest};
  emit_commands(timing, 0, plan.path.blocks() - 1, joints);
  Motion motion(plan, period, !command.moved.empty());
  Sample before, now;
  motion.next(before);
  for (std::size_t first = 0, last = 0; motion.next(now); before = now) {
    while (first < joints.last.size() && joints.last[first] <= before.number) ++first;
    while (last < joints.first.size() && joints.first[last] < now.number) ++last;
    arcs.look(before.position.data(), now.position.data(), first, last);
    motion.pass_steady();
  }
}

/// Samples of a trajectory with the first and the last block that they may be on, and one more on either side.
class TrajectoryLook {
 public:
  TrajectoryLook(const Plan& plan, ArcPoints& arcs)
      : arcs_(arcs), n_(plan.path.dimensions()), before_(plan.path.point(0), plan.path.point(0) + n_) {}
  void look(const double* position, std::size_t first, std::size_t last) {
    const std::size_t from = std::min(first_, first);
    arcs_.look(before_.data(), position, from > 0 ? from - 1 : 0, last + 1);
    std::copy_n(position, n_, before_.begin());
    first_ = first;
  }

 private:
  ArcPoints& arcs_;
  const std::size_t n_;
  std::vector<double> before_;
  std::size_t first_ = 0;
};

void look_at_trajectory(const Plan& plan, double period, ArcPoints& arcs) {
  const Trajectory& trajectory = *plan.trajectory();
  TrajectoryLook look(plan, arcs);
  if (trajectory.is_free()) {
    const double* position = trajectory.free.position.data();
    for (const std::uint32_t block : trajectory.free.block) {
      look.look(position, block, block);
      position += plan.path.dimensions();
    }
    return;
  }
  ProfileMotion motion(plan.path, trajectory.chain, period, trajectory.last);
  while (motion.next()) {
    motion.pass_steady();
    look.look(motion.position(), static_cast<std::size_t>(motion.place_first() / 2),
              static_cast<std::size_t>(motion.place_last() / 2));
  }
}

}  // namespace

std::optional<ArcError> arc_error(const Plan& plan, double sample_period) {
  ArcPoints arcs(plan.path);
  if (arcs.empty()) return {};
  if (plan.command() != nullptr)
    look_at_command(plan, sample_period, arcs);
  else
    look_at_trajectory(plan, sample_period, arcs);
  return arcs.worst();
}

}  // namespace accdec
