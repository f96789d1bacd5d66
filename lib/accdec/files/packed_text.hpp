#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace accdec {

/// Text as gzip makes it (RFC 1952), in the letters of base64 (RFC 4648), so that it can stand in a JSON string.
/// `base64 -d | gunzip` reads it.
std::string pack_text(std::string_view text);

/// Reads that back. Unpacks no further than to `most` bytes, whatever the text claims.
/// @throws std::runtime_error when it is no base64, no whole gzip member, has something behind it, does not have the
/// checksum it should, or would be longer than `most`
std::string unpack_text(std::string_view packed, std::size_t most);

}  // namespace accdec
