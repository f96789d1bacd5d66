#pragma once

namespace accdec {

/// Windows of at most 1, at i of 0 .. N = order.

/// 0.42 - 0.5 cos(2 pi i/N) + 0.08 cos(4 pi i/N). It may miss the exact zeros of its ends by rounding.
double blackman_window(int i, int order);

/// exp(-(alpha x)^2/2), x = (i - N/2)/(N/2); symmetric to the last bit.
double gaussian_window(int i, int order, double alpha);

}  // namespace accdec
