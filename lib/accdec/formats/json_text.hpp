#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include <accdec/files.hpp>

namespace accdec {

/// The tree of a result's text. Zero bytes, numbers beyond double precision, brackets that nest too deep and a key
/// twice in one object are refused. @throws InputError with line and column
nlohmann::ordered_json parse_json_text(std::string_view text, const std::string& name);

/// An error of a tree's value, at its place in the text, with the value's path in words: "corners[0].name: ...".
InputError at_its_place(const InputError& error, std::string_view text, const std::string& name);

}  // namespace accdec
