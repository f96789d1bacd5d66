#pragma once

#include <string>

#include <accdec/result.hpp>

// Internal to the room: remarks of the answer to a task of a controller. Each is empty, or begins with a blank.

namespace accdec {

/// The caps that hold the chosen setting back: lengths or numbers at the longest that can be set.
std::string caps_that_bind(const DesignResult& result);

/// Which exact stops the proof is about, where no other kind of delay waits longer.
/// @param control  null: none
std::string stops_considered(const ControllerSettings* control);

/// The limit that today's setting breaks, if none of the control's delays helps.
std::string limit_broken_today(const DesignResult& result);

}  // namespace accdec
