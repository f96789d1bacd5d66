#pragma once

#include <vector>

#include <accdec/program/read/toolpath.hpp>

namespace accdec {

/// What a program is like without all of it: four stretches of whole_max/4 blocks each, evenly spread, from rest to
/// rest; of a program of at most whole_max blocks the whole of it.
std::vector<Toolpath> stretches(const Toolpath& path, std::size_t whole_max);

}  // namespace accdec
