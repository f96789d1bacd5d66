#pragma once

#include <string>
#include <string_view>

#include <accdec/files/keys.hpp>

// Internal: the keys of task files by their names in SI, as JSON and Python may write them.

namespace accdec {

/// "feed_in" of "feed_in_mm_min". The key itself if it names no unit.
std::string si_name(const Key& key);

/// A number in a key's unit as one in SI, and back, exactly if any number does. That of a rotary axis is in rad, kg m^2
/// or N m. `to_si` gives what it is inside, where a degree counts as a millimetre.
double to_named_si(const Key& key, double value);
double from_named_si(const Key& key, double si);

/// The key that has this name in SI and another in files, in a table of a task; "" is the top. Null if there is none.
/// @param turns  the table is that of a rotary axis, where "velocity_max" is that of `velocity_max_deg_s`
const Key* key_in_si(std::string_view table, std::string_view name, bool turns = false);

/// Says that only axes of the other kind have a name in SI: `mass` of axis a. Empty if that is not so.
std::string of_other_axes(std::string_view name, std::string_view axis);

/// The key's range in SI, without the last digits of the conversion.
Range range_in_si(const Key& key);

/// A message about a task with keys in the names of SI, and numbers beside them in SI: "0 < feed_in <= 166.666667" for
/// "0 < feed_in_mm_min <= 10000000". Keys that the user wrote as in files stay what they are.
/// @param written  what the user wrote, as JSON
std::string in_si_names(std::string message, std::string_view written);

}  // namespace accdec
