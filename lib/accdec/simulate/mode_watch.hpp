#pragma once

#include <cstddef>

#include <accdec/filter.hpp>
#include <accdec/machine.hpp>
#include <accdec/simulate/command_stream.hpp>
#include <accdec/simulate/simulate.hpp>

namespace accdec {

/// Adds the use of every mode of an axis by blocks first .. last, and where it is broken.
///
/// Changes of the command's velocity count together, with their phase, until the motion goes on evenly: behind a corner
/// those of both legs, however long the command rests between them. If moves overlap, it is all their changes. The
/// vibration left is judged at the filter's last tap for the last change of the axis. Before every corner it is judged
/// in the same way for the changes so far, as if the motion went on evenly. A stop ends what came before it.
/// @param filter  of the command
/// @throws std::invalid_argument if moves overlap for so long that this is too much work
void watch_modes(const CommandTiming& timing, const Filter& filter, std::size_t first, std::size_t last,
                 const Machine& machine, Simulation& result);

}  // namespace accdec
