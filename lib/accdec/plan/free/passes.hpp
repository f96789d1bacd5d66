#pragma once

#include <accdec/plan/free/window.hpp>

namespace accdec {

/// Moves the passes of a window to where its samples come nearest to the joints. They stay in order and move by at most
/// their room for sliding and `more` samples.
void find_passes(const Toolpath& path, Window& window, double more);

}  // namespace accdec
