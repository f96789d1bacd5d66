#pragma once

#include <string>

#include <accdec/files/keys.hpp>

namespace accdec {

/// A JSON Schema (draft 2020-12) of a kind of file; a TOML file is meant as the JSON of the same tree. It says all that
/// one key alone can break and, where keys exclude or need each other, most of that.
std::string json_schema(const FileKind& file);

/// A table in Markdown with a line for every key.
std::string key_table(const FileKind& file);

}  // namespace accdec
