#pragma once

#include <string>
#include <string_view>

namespace accdec {

/// Bytes in base64 (RFC 4648), with padding.
std::string to_base64(std::string_view bytes);

/// @throws std::runtime_error if the text is not base64
std::string from_base64(std::string_view text);

}  // namespace accdec
