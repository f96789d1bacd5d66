#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <accdec/machine/limits.hpp>
#include <accdec/motion/blend.hpp>

namespace accdec {

/// The three events of every corner on which the axis limits hold; k counts from the last sample before each begins.
enum class Event {
  start,  ///< from rest along leg 1, k = 0 .. N + 1; the jerk also at N + 2, where the last tap's acceleration ends
  blend,  ///< around the corner, k = 0 .. N + d + 1; the jerk also at N + d + 2
  stop,   ///< to rest along leg 2, as the start
  none    ///< not tied to an event: vibration
};
std::string_view to_string(Event event);

/// The worst use of one limit. `utilisation` = value/bound for upper bounds and bound/value for `speed_min`, so that >
/// 1 always means violated; 0/0 counts as 0 and x/0 as infinity.
struct LimitUse {
  LimitKind kind{};
  std::string axis;    ///< empty where the limit belongs to no axis
  std::string corner;  ///< empty for vibration
  Event event = Event::none;
  double value = 0.0;  ///< SI; an absolute value, except power (signed as its limit counts it)
  double bound = 0.0;  ///< SI
  double utilisation = 0.0;
  int sample = 0;          ///< k of the worst sample within its event
  double frequency = 0.0;  ///< Hz, the worst frequency; vibration only
};

/// value/bound (or bound/value for speed_min), with the conventions of LimitUse.
double utilisation_of(LimitKind kind, double value, double bound);

/// Worst use, over start, blend and stop, of every finite axis limit. One entry per limit and axis, in axis order.
/// @param corner  as many axes as the machine
/// @throws std::invalid_argument if the numbers of axes differ or the sample period is not positive and finite.
std::vector<LimitUse> axis_utilisation(const Filter& filter, const Corner& corner, int delay, double sample_period,
                                       const Machine& machine, const std::string& corner_name = "");

/// Residual vibration of a filter at frequency f in Hz: |sum_i b_i exp(-2 pi j f i T)|, 0 .. 1.
double residual_vibration(const Filter& filter, double frequency, double sample_period);

/// The worst frequency of every mode's band: a grid finer than the response can wiggle, then bisection on its slope in
/// every cell that holds a maximum worth it. O((N + 1) * grid), grid = 8 (N + 1) T (high - low).
/// @param stop  asked at every frequency; once it says so, what was found so far counts, which may be too little
/// @throws std::invalid_argument on a band or sample period out of range.
std::vector<LimitUse> vibration_utilisation(const Filter& filter, double sample_period, const Machine& machine,
                                            const std::function<bool()>& stop = {});

}  // namespace accdec
