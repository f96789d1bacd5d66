#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <stdexcept>

#include <zlib.h>

#include <fmt/format.h>

#include <accdec/files/packed_text.hpp>

namespace accdec {
namespace {

constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr int gzip_header = 16 + MAX_WBITS;
constexpr std::size_t block = std::size_t{1} << 20;  // bytes given to zlib at a time

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

/// Passes `in` through zlib in blocks; `step` takes the output and returns whether to continue.
template <class Run, class Take>
int run(z_stream& stream, std::string_view in, const Run& run_zlib, const Take& take) {
  std::string out(block, '\0');
  std::size_t at = 0;
  int status = Z_OK;
  while (status == Z_OK) {
    if (stream.avail_in == 0) {
      const std::size_t part = std::min(block, in.size() - at);
      // zlib's interface is older than const.
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(in.data() + at));
      stream.avail_in = static_cast<uInt>(part);
      at += part;
    }
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    status = run_zlib(at == in.size());
    take(std::string_view(out).substr(0, out.size() - stream.avail_out));
  }
  // Data after the end of the stream.
  stream.avail_in += static_cast<uInt>(std::min<std::size_t>(in.size() - at, 1));
  return status;
}

}  // namespace

std::string pack_text(std::string_view text) {
  z_stream stream{};
  if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, gzip_header, 8, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::runtime_error("zlib cannot be started");
  std::string packed;
  const int status = run(
      stream, text, [&](bool last) { return deflate(&stream, last ? Z_FINISH : Z_NO_FLUSH); },
      [&](std::string_view out) { packed += out; });
  deflateEnd(&stream);
  if (status != Z_STREAM_END) throw std::runtime_error("zlib could not pack a text");
  return to_base64(packed);
}

std::string unpack_text(std::string_view packed, std::size_t most) {
  const std::string bytes = from_base64(packed);
  z_stream stream{};
  if (inflateInit2(&stream, gzip_header) != Z_OK) throw std::runtime_error("zlib cannot be started");
  std::string text;
  bool too_long = false;
  const int status = run(
      stream, bytes, [&](bool) { return too_long ? Z_MEM_ERROR : inflate(&stream, Z_NO_FLUSH); },
      [&](std::string_view out) {
        too_long = too_long || out.size() > most - text.size();
        if (!too_long) text += out;
      });
  const bool behind = stream.avail_in > 0;
  inflateEnd(&stream);
  if (too_long) throw std::runtime_error(fmt::format("unpacks to more than the {} MB that it may", most / 1'000'000));
  if (status != Z_STREAM_END) throw std::runtime_error("is no whole gzip text, or damaged");
  if (behind) throw std::runtime_error("has something behind the end of its gzip text");
  return text;
}

}  // namespace accdec
