#pragma once

#include <string>
#include <string_view>

#include <toml++/toml.h>

// Internal: for the readers of files only (it needs toml++).

namespace accdec::toml_input {

/// The tree of a TOML text. Parses TOML. The library destroys its trees by recursion, and it limits the depth of
/// brackets but not of dotted keys. So names of more than 64 parts and brackets more than 64 deep are refused.
/// @param name  what errors call the text
/// @throws InputError with position
toml::table parse_toml(std::string_view text, const std::string& name);

}  // namespace accdec::toml_input
