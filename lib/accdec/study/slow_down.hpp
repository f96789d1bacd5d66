#pragma once

#include <accdec/motion/blend.hpp>
#include <accdec/motion/corner.hpp>
#include <accdec/motion/filter.hpp>

namespace accdec::study {

/// What a control without delays does at a corner: it lowers the feed of both legs around it.
struct SlowDown {
  double factor = 1.0;     ///< of both feeds at the corner, 0 .. 1
  double lost_time = 0.0;  ///< s, against passing the corner at full feed without a delay
};

/// The largest common factor of both feeds at which a corner without delay keeps the tolerance. The error is
/// proportional to the feeds, so the factor is error_max/error. The command must run at the lower feed for at least
/// half the filter's length before and behind the corner, or part of the blend is still fed at full speed; that costs
/// (1 - factor)(N + 1) T, which for factor 0 is what an exact stop costs. Limits of the machine are kept, for all its
/// speed changes are smaller than a full start or stop.
/// @param error_max  m, >= 0
SlowDown slow_down(const Filter& filter, const Corner& corner, double sample_period, double error_max);

}  // namespace accdec::study
