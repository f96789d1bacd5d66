#pragma once

#include <string_view>

namespace accdec {

/// How a program's result writes joints, in the order of Joint: corner, smooth, straight, stop.
inline constexpr std::string_view joint_letters = "csl.";

}  // namespace accdec
