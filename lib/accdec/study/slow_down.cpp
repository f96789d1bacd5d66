#include <accdec/machine/blend_behind.hpp>
#include <accdec/study/slow_down.hpp>

namespace accdec::study {

SlowDown slow_down(const FilterBehind& behind, const Corner& corner, double sample_period, double error_max) {
  const double error = corner_error(behind, corner, 0, sample_period);
  SlowDown result;
  if (error > error_max) result.factor = error_max / error;
  result.lost_time = (1.0 - result.factor) * (behind.longest_order() + 1) * sample_period;
  return result;
}

}  // namespace accdec::study
