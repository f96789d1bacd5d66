#include <accdec/study/slow_down.hpp>

namespace accdec::study {

SlowDown slow_down(const Filter& filter, const Corner& corner, double sample_period, double error_max) {
  const double error = corner_error(Blend(filter, corner, 0, sample_period));
  SlowDown result;
  if (error > error_max) result.factor = error_max / error;
  result.lost_time = (1.0 - result.factor) * (filter.order() + 1) * sample_period;
  return result;
}

}  // namespace accdec::study
