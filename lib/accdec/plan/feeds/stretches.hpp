#pragma once

#include <vector>

#include <accdec/simulate.hpp>

namespace accdec {

/// A sample of a program: four stretches of whole_max/4 blocks each, evenly spread, from rest to rest. A program of at
/// most whole_max blocks is taken whole.
std::vector<Toolpath> stretches(const Toolpath& path, std::size_t whole_max);

}  // namespace accdec
