#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <toml++/toml.h>

#include <accdec/files/file_kind.hpp>
#include <accdec/files/toml_table.hpp>

// Internal to this folder: shared by the readers of studies and suites. Do not include it in other folders, as it needs
// toml++.

namespace accdec::toml_input {

/// @param expected  a file of another kind is refused with that reason
/// @throws InputError with position
toml::table parse_file(const std::string& path, std::optional<InputKind> expected = {});

/// A string or a list of strings; none if the key is missing. @throws InputError for anything else or an empty list
std::vector<std::string> strings(const Table& table, const toml::table& raw, std::string_view key);

/// A task named relative to the file that names it, parsed. @throws InputError at the key if it does not exist
toml::table parse_task_beside(const Table& table, std::string_view key, const std::string& given, std::string& path);

/// Sets every dotted task key of a [set] table. @throws InputError at the value
void apply_settings(const toml::table& settings, const std::string& file, toml::table& task);

/// Hash of a text, 16 hexadecimal digits (FNV-1a). It distinguishes files, but it gives no security.
std::string hash_of(std::string_view text);

}  // namespace accdec::toml_input
