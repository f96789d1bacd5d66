#pragma once

#include <accdec/corner.hpp>
#include <accdec/machine/response.hpp>

namespace accdec::study {

/// A control without delays lowers the feed of both legs around a corner.
struct SlowDown {
  double factor = 1.0;     ///< of both feeds at the corner, 0 .. 1
  double lost_time = 0.0;  ///< s, against passing the corner at full feed without a delay
};

/// The largest common factor of both feeds at which a corner without delay keeps the tolerance. The error is
/// proportional to the feeds, so the factor is error_max/error. The command must run at the lower feed for at least
/// half the filter's length before and after the corner. Otherwise a part of the blend still gets full speed. This
/// costs (1 - factor)(N + 1) T; for factor 0 that is the time of an exact stop. Limits of the machine are kept, because
/// all speed changes are smaller than a full start or stop.
/// @param error_max  m, >= 0
SlowDown slow_down(const FilterBehind& behind, const Corner& corner, double sample_period, double error_max);

}  // namespace accdec::study
