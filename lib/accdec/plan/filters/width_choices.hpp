#pragma once

#include <vector>

#include <accdec/filter.hpp>
#include <accdec/simulate.hpp>

// Internal to the room: which in-position widths differ for a filter.

namespace accdec {

/// A joint at which a control holds the command back, by itself.
struct HeldJoint {
  double step = 0.0;  ///< m, of a full-speed sample before it: the way that the control watches
  int delay = 0;      ///< samples that its limits need
};

/// One of the widths that give all joints the same delays.
struct WidthChoice {
  double width = 0.0;    ///< m, in the middle of them
  double samples = 0.0;  ///< of all delays; unlimited where a joint has none that is long enough
};

/// Every width that gives some joint another delay, the widest first. Between two of them lies a step p(d) of a joint,
/// with p the filter's remaining moment. O(J N log(J N)) for J joints of different steps.
/// @param kinds   of the control; its width is not looked at
/// @param filter  of the command
std::vector<WidthChoice> width_choices(ControlDelays kinds, const Filter& filter, std::vector<HeldJoint> joints);

}  // namespace accdec
