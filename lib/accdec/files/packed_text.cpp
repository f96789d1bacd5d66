#include <algorithm>
#include <limits>
#include <stdexcept>

#include <zlib.h>

#include <fmt/format.h>

#include <accdec/files/base64.hpp>
#include <accdec/files/packed_text.hpp>

namespace accdec {
namespace {

constexpr int gzip_header = 16 + MAX_WBITS;
constexpr std::size_t block = std::size_t{1} << 20;  // bytes given to zlib at a time

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
