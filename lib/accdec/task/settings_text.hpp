#pragma once

#include <string>
#include <vector>

#include <accdec/result.hpp>

namespace accdec {

/// "2 averages up to 20 ms" or "averages and one pole": what a controller can be set to.
std::string families_in_words(const ControllerSettings& settings);

/// "proved best for this control", or "for this family" where the task names no control. It says so if the control's
/// delays are not known.
std::string proved_best_in_words(const ControllerSettings& settings);

/// "Free taps", the subject of a time with delays of any number of samples. It says so if the control has only some;
/// null: no control.
std::string free_taps_in_words(const ControllerSettings* control);

/// "4.5 %" of 0.045, "0.04 %" of 0.0004. @param part  above 0
std::string percent_in_words(double part);

/// " Assumed: T1 is entered in ms.", what no source says of a control; empty if there is nothing. Null: no control.
std::string assumed_in_words(const ControllerSettings* control);

/// "averages of 18 ms and 12 ms", or with names of parameters "MD32410 = 0.018 s, MD32411 = 0.012 s".
std::string settings_in_words(const ChosenSettings& settings);

/// "in-position width 0.23 mm (0.21 to 0.25)".
std::string width_in_words(const WidthInterval& width);

/// "40 % of the feed, 2400 mm/min, from 1.2 mm before to 1.2 mm behind it": a corner with DelayKind::corner_feed.
std::string corner_feed_in_words(const DesignResult& result, std::size_t corner);

/// How each corner's delay is made, of the kinds that the task's control has: as chosen with settings, else as free
/// taps need it. Empty if the task names no kinds.
std::vector<DelayKind> chosen_delay_kinds(const DesignResult& result);

/// The answer to a task of a controller, for its user: what to set, the time and what is proved about it. It also says
/// what free taps would do and what the design saves against today's setting. A line or two; empty if the task says
/// nothing of a control (families, kinds of delays, a smoothing of its own, whole coefficients).
std::string settings_answer(const DesignResult& result);

}  // namespace accdec
