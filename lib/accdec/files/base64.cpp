#include <array>
#include <cstdint>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/files/base64.hpp>

namespace accdec {
namespace {

constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

}  // namespace

std::string to_base64(std::string_view bytes) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t j = 0; j < 3; ++j)
      word = word << 8 | (i + j < bytes.size() ? static_cast<unsigned char>(bytes[i + j]) : 0u);
    for (std::size_t j = 0; j < 4; ++j) text += i + j <= bytes.size() ? letters[word >> (18 - 6 * j) & 63u] : '=';
  }
  return text;
}

std::string from_base64(std::string_view text) {
  std::array<int, 256> value{};
  value.fill(-1);
  for (std::size_t i = 0; i < letters.size(); ++i) value[static_cast<unsigned char>(letters[i])] = static_cast<int>(i);
  if (text.size() % 4 != 0) throw std::runtime_error("is no base64: its length is no multiple of 4");
  std::size_t end = text.size();
  while (end > 0 && text.size() - end < 2 && text[end - 1] == '=') --end;
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3);
  std::uint32_t word = 0;
  int bits = 0;
  for (std::size_t i = 0; i < end; ++i) {
    const int v = value[static_cast<unsigned char>(text[i])];
    if (v < 0) throw std::runtime_error(fmt::format("is no base64 at its character {}", i + 1));
    word = word << 6 | static_cast<std::uint32_t>(v);
    if ((bits += 6) < 8) continue;
    bits -= 8;
    bytes += static_cast<char>(word >> bits & 255u);
  }
  return bytes;
}

}  // namespace accdec
