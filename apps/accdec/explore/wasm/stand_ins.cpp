// Replaces what needs libraries that Emscripten lacks.
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

#include <accdec/files/base64.hpp>
#include <accdec/files/packed_text.hpp>
#include <accdec/formats/generated/accdec_commit.hpp>
#include <accdec/formats/manifest.hpp>

namespace accdec {
namespace {

/// The checksum of gzip (RFC 1952, 8).
std::uint32_t checksum(std::string_view text) {
  std::uint32_t sum = 0xffffffff;
  for (const char c : text) {
    sum ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) sum = sum >> 1 ^ ((sum & 1) != 0 ? 0xedb88320 : 0);
  }
  return ~sum;
}

void put(std::string& bytes, std::uint32_t value, int count) {
  for (int i = 0; i < count; ++i) bytes += static_cast<char>(value >> 8 * i & 255);
}

}  // namespace

/// A gzip file whose blocks are stored as they are (RFC 1951, 3.2.4).
std::string pack_text(std::string_view text) {
  std::string bytes("\x1f\x8b\x08\0\0\0\0\0\0\xff", 10);
  constexpr std::size_t most = 65535;
  for (std::size_t at = 0; at == 0 || at < text.size(); at += most) {
    const std::string_view block = text.substr(at, most);
    const auto size = static_cast<std::uint32_t>(block.size());
    put(bytes, at + most >= text.size() ? 1 : 0, 1);
    put(bytes, size, 2);
    put(bytes, ~size, 2);
    bytes += block;
  }
  put(bytes, checksum(text), 4);
  put(bytes, static_cast<std::uint32_t>(text.size()), 4);
  return to_base64(bytes);
}

/// The page never asks for it.
std::string unpack_text(std::string_view, std::size_t) {
  throw std::runtime_error("a packed proof is read by accdec verify");
}

std::string source_commit() {
  return ACCDEC_COMMIT;
}

}  // namespace accdec
