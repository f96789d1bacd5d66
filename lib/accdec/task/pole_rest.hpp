#pragma once

namespace accdec {

/// The part of the step of a control's endless poles at which they are cut off.
inline constexpr double pole_rest = 1e-4;

}  // namespace accdec
