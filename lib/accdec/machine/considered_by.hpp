#pragma once

#include <string_view>

namespace accdec {

/// Advice on a key about the response, friction, force-speed curves, modes of axes or the supply, where it is not
/// considered.
inline constexpr std::string_view considered_by =
    "leave it out. `accdec evaluate`, `accdec design`, `accdec explain` and `accdec verify` consider it at the corners "
    "of a task. `accdec program` considers `prefilter_taps`, "
    "`in_position_latency_ms`, servos, friction, curves, the supply and modes of axes with `--plan fixed`";
/// The same, for another plan of a program.
inline constexpr std::string_view considered_by_fixed = "leave it out, or use --plan fixed, which considers it";

}  // namespace accdec
