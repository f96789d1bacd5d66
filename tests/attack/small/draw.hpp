#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include <accdec/task.hpp>

namespace accdec::attack {

inline constexpr std::array<std::string_view, 17> kinds{
    "plain",    "axes",         "force", "velocity", "vibration", "ties",     "symmetric", "given",      "fixed-delay",
    "weighted", "regeneration", "power", "speed",    "several",   "smoothed", "servo",     "in-position"};

/// A random task of a kind whose filter takes few samples; the same for the same seed and number.
Task draw(std::string_view kind, std::uint64_t seed, std::uint64_t number);

}  // namespace accdec::attack
