#pragma once

#include <cstddef>
#include <string>

namespace accdec {

inline constexpr std::size_t task_file_limit = std::size_t{64} << 20;   ///< bytes
inline constexpr std::size_t result_file_limit = std::size_t{1} << 30;  ///< bytes; certificates can be long

/// A whole text file, without its UTF-8 byte order mark if it has one.
/// @param limit  bytes; larger files are refused unread
/// @throws InputError when it is missing, a directory, unreadable, too large, UTF-16, or holds zero bytes (not text).
std::string read_text_file(const std::string& path, std::size_t limit = task_file_limit);

}  // namespace accdec
