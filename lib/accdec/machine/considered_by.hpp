#pragma once

#include <string_view>

namespace accdec {

/// Advice on a key about the response, friction, force-speed curves, modes of axes or the supply, where it is not
/// considered. No command considers it for whole coefficients.
inline constexpr std::string_view considered_by =
    "leave it out. `accdec evaluate` and `accdec verify` consider it at the corners of a task, `accdec design` and "
    "`accdec explain` do unless there are `coefficient_bits`. `accdec program` considers `prefilter_taps`, "
    "servos, friction, curves, the supply and modes of axes with `--plan fixed`";

}  // namespace accdec
