#pragma once

#include <cstddef>

#include <accdec/plan/trajectory/available.hpp>

namespace accdec {

/// A corner between two legs passed at one speed v. Its step of the command, (u2 - u1) v, goes through a boxcar of tau
/// = stretch v seconds. The acceleration there is (u2 - u1)/stretch. The path is a parabola that takes v tau/2 of each
/// leg.
struct CornerPass {
  double speed_max = 0.0;  ///< m/s; 0: the motion has to come to rest
  double stretch = 0.0;    ///< s^2/m
  double coast = 0.0;      ///< s of steady motion before and after, so that the acceleration does not change too fast
};

struct ProfileLegs {
  const double* in = nullptr;  ///< unit vectors
  const double* out = nullptr;
  double ramp_in = 0.0, ramp_out = 0.0;  ///< m/s^2, largest acceleration along each leg near the corner
  double feed = 0.0;                     ///< m/s, the lower of both legs
  double room = 0.0;                     ///< m, the shorter of both legs
  double tolerance = 0.0;                ///< m, >= 0
  double scale = 1.0;                    ///< part of the available acceleration to use, in (0, 1]
};

/// The fastest pass within the tolerance and the axes' acceleration.
///
/// Distance of the path from the corner where the mean of the last filter is: with n = |u2 - u1|
///   n v/2 E|U + G - M| (see LastFilter).
/// There are two boxcars, of the corner (tau) and of the whole motion (w). With p = max(tau, w) and q = min(tau, w),
/// the distance is n v (p/8 + q^2/(24 p)). Without a last filter it is the parabola's n v tau/8. Ramps at both ends
/// have the acceleration a along the leg and begin h = tau/2 + coast from the corner. They add n a/2 E max(|G - M| - h,
/// 0)^2 of one side. The polyline through the samples must hold the tolerance; it is up to |A| T^2/8 inside the path.
CornerPass corner_pass(const AvailableAcceleration& available, std::size_t dimensions, const ProfileLegs& legs);

/// The distance above, m.
double corner_distance(double n, double v, double tau, const LastFilter& last, double ramp, double coast);

}  // namespace accdec
