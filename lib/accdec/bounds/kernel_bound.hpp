#pragma once

#include <cstddef>
#include <functional>

#include <accdec/machine.hpp>
#include <accdec/simulate.hpp>

namespace accdec {

/// A time that no motion of blocks first .. last, between two stops, undercuts, s; 0 if none is found. It is for
/// corners so close that acceleration and jerk limit the motion all the time: curves that fill a plane, carved
/// surfaces.
///
/// Let the motion x pass some of the joints at times t_0, t_1, .., h_i apart. Every axis gets a function K(t), linear
/// between these times, with a value k_i of the grid -1 .. 1 in each. With K over the axis' largest acceleration A as
/// weight, the integral of K x''/A over all axes is
///     the sum over i of (k_i - k_i+1) . (x(t_i+1) - x(t_i))/(A h_i),
/// because the motion rests at both ends. The integral is at most the sum of c_i h_i, where c_i is the mean of |K| over
/// all axes. As K crosses 0, x'' would have to jump. Within the jerk limit that takes off
///     |slope of K| r^2/12, r = 2A/J, if both parts of K there are longer than r/2.
/// If the shorter part is u r/2 long, it is that of two such parts, which is at least u^2 of the above.
/// A joint may be off by its tolerance e. In the sum this costs (e_i + e_i+1) |(k_i - k_i+1)/A|/h_i at most.
///
/// So the sum over i of phi_i(h_i) is at most 0, where phi_i(h) is what one difference of joints gives, G/h - c h + the
/// part of jerk. Then for every m >= 0 the motion takes the sum of the least h + m phi_i(h) at least. Here h is not
/// below the distance over the feed. The largest sum over all joints and values is found by dynamic programming.
/// @param wider  m, added to all tolerances
/// @param work_left  steps of the search, some 3 ns each: grids are as fine as this allows. Lowered by those taken
/// @param more  whether there is time left; asked at every joint
double kernel_bound(const Toolpath& path, const Machine& machine, double wider, std::size_t first, std::size_t last,
                    double& work_left, const std::function<bool()>& more);

}  // namespace accdec
