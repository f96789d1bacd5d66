#include <cmath>
#include <cstdio>
#include <numbers>

#include <accdec/corner.hpp>
#include <accdec/filter.hpp>

// Table 2 of the paper, feed 1/3, no delay: 488 um.
int main() {
  const accdec::Filter filter = accdec::blackman_sinc(40, 0.049);
  const accdec::Corner corner =
      accdec::planar_corner(95.0 * std::numbers::pi / 180.0, 0.0, accdec::Turn::left, 0.1, 0.3);
  const double error = accdec::corner_error(accdec::Blend(filter, corner, 0, 1e-3));
  std::printf("corner error %.1f um\n", error * 1e6);
  return std::abs(error - 488e-6) < 0.5e-6 ? 0 : 1;
}
