#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <accdec/machine.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/plan/report/samples.hpp>
#include <accdec/program.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// The motion of a planned program, for pages and figures.
struct ProgramMotion {
  std::string title;                                  ///< program, time and plan
  double sample_period = 0.0, cycle_time = 0.0;       ///< s
  std::function<void(const SampleVisitor&)> samples;  ///< calls the visitor for every sample in order,
                                                      ///< of steady motion for the first and last ones only
  std::vector<NamedBound> bounds;                     ///< of its time; may be empty
  std::string answer{};                               ///< what to set in a control; may be empty
  const Plan* plan = nullptr;                         ///< for the loads behind a servo; none: they are left out
  std::string legs{};                                 ///< how servos that differ bend legs; may be empty
};
/// The motion of a plan. The reference is kept.
ProgramMotion motion_of(const ProgramResult& result);

double speed_of(const double* velocity, std::size_t axes);   ///< m/s, of all axes
double block_feed(const Toolpath& path, std::size_t block);  ///< m/s, of all axes

/// Number of limits that may bind in a program: those of `axis_limits`, then those of `supply_limits`.
inline constexpr std::size_t binding_limits = axis_limits.size() + supply_limits.size();
/// Takes sample k, its position (m), its velocity (m/s, of every axis) and the index of the limit that binds there,
/// below `binding_limits`. This is the limit used most, if it is used to 98 % or more; -1 if there is none. Loads are
/// those of the motion behind a servo, all other limits are of the command.
using VelocityVisitor =
    std::function<void(std::int64_t k, const double* position, const double* velocity, int binding)>;
/// Every sample of a motion. @param machine  as many axes as the path, or none
void visit_velocities(const Machine& machine, const ProgramMotion& motion, const VelocityVisitor& visit);
/// Numbers of the samples that a picture of about `most` points needs: multiples of n, and the ends of long stretches
/// that are not visited.
/// @param n  0: as `samples_a_point` has it; one for several motions gives them points at the same times
std::vector<std::int64_t> drawn_samples(const ProgramMotion& motion, std::int64_t most, std::int64_t n = 0);
/// How many visited samples a point of such a picture stands for.
std::int64_t samples_a_point(const ProgramMotion& motion, std::int64_t most);
/// The name of the binding limit, with an index as in `VelocityVisitor`. If none binds, the tolerance of a corner or
/// the programmed feed limits the motion.
std::string binding_name(int binding);
/// Styles (figure_style.hpp) of the limits that may bind, in the order of `VelocityVisitor`. Those that the machine has
/// differ, up to seven. None is grey, which is for where no limit binds.
std::array<int, binding_limits> binding_styles(const Machine& machine);

/// Time lost at corners that turn by `turn_from` to `turn_to` degrees, or at stops.
struct CornerLoss {
  double turn_from = 0.0, turn_to = 0.0;
  bool stop = false;
  long count = 0;
  double time = 0.0;  ///< s: sum over samples of the part by which each is slower than the feed, counted at the nearer
                      ///< joint
};
/// @param programmed  the path as the program has it, before a plan changed its feeds
std::vector<CornerLoss> time_lost(const Toolpath& programmed, const ProgramMotion& motion);
/// "45 to 75 degrees".
std::string class_name(const CornerLoss& loss);

}  // namespace accdec
