#pragma once

#include <numbers>

#include <accdec/filter.hpp>

/// The conditions of the paper (Shih, Chen, Lee, "Path Planning for CNC Contouring around a Corner"). Conditions that
/// it does not print were recovered by recomputing its tables: with them every entry agrees. 1 BLU = 1 um.
namespace accdec::paper {

inline constexpr double sample_period = 1e-3;                          ///< T, s; printed with Table 1
inline constexpr double angle_deg = 95.0;                              ///< interior corner angle; recovered
inline constexpr double angle = angle_deg / 180.0 * std::numbers::pi;  ///< rad
inline constexpr int order = 40;           ///< N; printed for Fig. 11 and 12, recovered for Table 2
inline constexpr double cutoff = 0.049;    ///< of the Nyquist frequency; recovered
inline constexpr int ramp_samples = 41;    ///< tau_A/T; printed with Table 1
inline constexpr double blu = 1e-6;        ///< m
inline constexpr double feed_ratio = 3.0;  ///< c of both tables; printed

/// "Blackman FIR": a Blackman-windowed sinc low-pass of order 40, not the bare window.
inline Filter fir() {
  return blackman_sinc(order, cutoff);
}
/// Linear Acc/Dec: 41 equal taps, tau_A = 41 T.
inline Filter linear() {
  return boxcar(ramp_samples - 1);
}
/// Quintic S-curve, Eq. (30)-(32).
inline Filter quintic() {
  return s_curve(order);
}

}  // namespace accdec::paper
