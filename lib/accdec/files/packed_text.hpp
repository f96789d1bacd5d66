#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace accdec {

/// Text packed by gzip (RFC 1952) and written in base64 (RFC 4648), so that it can stand in a JSON string.
/// `base64 -d | gunzip` reads it.
std::string pack_text(std::string_view text);

/// Reads such text. Unpacks at most `most` bytes, whatever the text claims.
/// @throws std::runtime_error if it is not base64 or not a complete gzip member, if data follows it, if its checksum is
/// wrong, or if it would be longer than `most`
std::string unpack_text(std::string_view packed, std::size_t most);

}  // namespace accdec
