#include <bit>
#include <cstdint>
#include <span>

#include <fmt/format.h>

#include <accdec/formats/export/exported_json.hpp>

namespace accdec {
namespace {

/// One array of a .npy file. @param shape  as Python writes it
std::string npy_array(std::string_view type, const std::string& shape, const std::string& data) {
  std::string header = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': {}, }}", type, shape);
  // Magic, version, length and header together fill a multiple of 64 bytes, and the header ends in a line feed.
  header.append(63 - (10 + header.size()) % 64, ' ');
  header += '\n';
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes += static_cast<char>(header.size() & 0xff);
  bytes += static_cast<char>(header.size() >> 8);
  return bytes + header + data;
}

void append_little_endian(std::string& bytes, std::uint64_t word) {
  for (int byte = 0; byte < 8; ++byte, word >>= 8) bytes += static_cast<char>(word & 0xff);
}

}  // namespace

// An array has no place for more than numbers. But a file may hold several, one after another: numpy.load of a path
// reads the first, numpy.load of an open file the next.
std::string npy_export(const ExportedDesign& design) {
  std::string taps, delays;
  for (const double tap : design.filter.taps()) append_little_endian(taps, std::bit_cast<std::uint64_t>(tap));
  for (const CornerResult& corner : design.result.corners)
    append_little_endian(delays, static_cast<std::uint64_t>(corner.delay));
  nlohmann::ordered_json about{{"sample_period_s", design.period}};
  add_about(about, design);
  const std::string text = exported_text(about, -1);
  return npy_array("<f8", fmt::format("({},)", design.filter.taps().size()), taps) +
         npy_array("<i8", fmt::format("({},)", design.result.corners.size()), delays) +
         npy_array(fmt::format("|S{}", text.size()), "()", text);
}

}  // namespace accdec
