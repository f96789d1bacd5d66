#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/formats/export/exported_design.hpp>
#include <accdec/result.hpp>

namespace accdec {
namespace {

struct Writer {
  std::string_view format;
  std::string (*write)(const ExportedDesign& design);
};
constexpr Writer writers[] = {{"csv", csv_export},
                              {"c", c_export},
                              {"json", json_export},
                              {"npy", npy_export},
                              {"cascade", cascade_export},
                              {"m", matlab_export},
                              {"st", structured_text_export},
                              {"linuxcnc-comp", linuxcnc_export},
                              {"klipper", klipper_export},
                              {"q15", q15_export},
                              {"q31", q31_export}};
static_assert(std::ranges::equal(writers, taps_formats, {}, &Writer::format));

}  // namespace

std::string export_taps(const DesignResult& result, std::string_view format) {
  const auto* writer = std::ranges::find(writers, format, &Writer::format);
  if (writer == std::end(writers))
    throw std::invalid_argument(
        fmt::format("unknown format \"{}\"; allowed are {}", format, fmt::join(taps_formats, ", ")));
  return writer->write(exported_design(result));
}

}  // namespace accdec
