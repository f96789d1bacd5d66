#pragma once

#include <string>

#include <accdec/files/keys.hpp>

namespace accdec {

/// A JSON Schema (draft 2020-12) of a kind of file. A TOML file counts as the JSON of the same tree. It covers all
/// conditions on single keys, and most conditions between keys that exclude or need each other.
std::string json_schema(const FileKind& file);

/// A table in Markdown with a line for every key.
std::string key_table(const FileKind& file);

}  // namespace accdec
