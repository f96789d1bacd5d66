#pragma once

#include <string>

#include <accdec/result.hpp>

// Internal to the room: remarks of the answer to a task of a controller. Each is empty, or begins with a blank.

namespace accdec {

/// Lengths and numbers at the longest that can be set, unless longer ones surely gain nothing.
std::string caps_reached(const DesignResult& result);

/// Which exact stops the proof is about, where no other kind of delay waits longer.
/// @param control  null: none
std::string stops_considered(const ControllerSettings* control);

/// The limit that today's setting breaks, if none of the control's delays helps.
std::string limit_broken_today(const DesignResult& result);

}  // namespace accdec
