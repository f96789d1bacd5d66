#pragma once

#include <string>

#include <accdec/result.hpp>

// Internal to the room: remarks of the answer to a task of a controller. Each is empty, or begins with a blank.

namespace accdec {

/// Lengths and numbers at the longest that can be set, unless longer ones surely gain nothing.
std::string caps_reached(const DesignResult& result);

/// How long an exact stop lasts, where no other kind of delay waits longer. @param control  null: none
std::string exact_stop_rule(const ControllerSettings* control);
/// The same as a sentence of an answer: which exact stops the proof is about.
std::string stops_considered(const ControllerSettings* control);

/// The limit that today's setting breaks, if none of the control's delays helps.
std::string limit_broken_today(const DesignResult& result);

}  // namespace accdec
