#pragma once

#include <accdec/motion/filter.hpp>

namespace accdec {

/// Standard Acc/Dec shapes as filters of order N (N + 1 taps). All throw std::invalid_argument when an argument is out
/// of the range given here. Order 0 is the filter that passes the command through unchanged.

/// Equal taps: linear Acc/Dec. order >= 0.
Filter boxcar(int order);

/// Equal steps up, a plateau, equal steps down: b_i ~ min(i + 1, ramp + 1, N + 1 - i). Constant jerk, then constant
/// acceleration. @param ramp taps in each ramp below the plateau, 0 <= ramp <= N/2; 0 is the boxcar, floor(N/2) the
/// triangle.
Filter trapezoid(int order, int ramp);

/// Derivative of the quintic S-curve 10 t^3 - 15 t^4 + 6 t^5 at t = i/N, both zero end taps included (Eq. 30-32). order
/// >= 2.
Filter s_curve(int order);

/// Hann window 0.5 - 0.5 cos(2 pi i/N), end taps zero. order >= 2.
Filter hann(int order);

/// Blackman window 0.42 - 0.5 cos(2 pi i/N) + 0.08 cos(4 pi i/N), end taps zero. order >= 2.
Filter blackman(int order);

/// Blackman-windowed sinc low-pass, blackman(i) sinc(cutoff (i - N/2)), sinc(x) = sin(pi x)/(pi x): the paper's FIR
/// Acc/Dec.
/// @param cutoff  fraction of the Nyquist frequency, > 0; at most 2/N, where the sinc would turn negative inside the
/// window.
Filter blackman_sinc(int order, double cutoff);

}  // namespace accdec
