#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/filter.hpp>
#include <accdec/formats/export/exported_design.hpp>

namespace accdec {
namespace {

/// Whether the filter is these impulses, after any leading zeros.
bool is_shaper(const Filter& filter, const ShaperInfo& shaper) {
  const int begin = filter.first_nonzero_tap(), length = filter.last_nonzero_tap() - begin;
  if (length == 0 || length % shaper.pairs != 0) return false;
  const double end = shaper.pairs == 1 ? 0.5 : shaper.outer;
  for (int i = 0; i <= length; ++i) {
    double tap = i == 0 || i == length ? end : 0.0;
    if (shaper.pairs == 2 && 2 * i == length) tap = 1.0 - 2.0 * end;
    if (!(std::abs(filter.tap(begin + i) - tap) < 1e-9)) return false;
  }
  return true;
}

}  // namespace

std::string klipper_export(const ExportedDesign& design) {
  for (const ShaperInfo& shaper : shaper_list()) {
    if (!is_shaper(design.filter, shaper)) continue;
    std::string text = "# Input shaper designed by accdec, for Klipper's and Kalico's printer.cfg\n";
    for (const std::string& fact : design.facts()) text += "# " + ascii_line(fact) + "\n";
    for (const CornerResult& corner : design.result.corners)
      text += ascii_line(fmt::format("# delay: {} samples at corner {}; the configuration has no key for it",
                                     corner.delay, corner.name)) +
              "\n";
    const int samples = design.filter.last_nonzero_tap() - design.filter.first_nonzero_tap();
    const std::string frequency = fmt::format("{}", shaper.pairs * shaper.delay_periods / (samples * design.period));
    text += "[input_shaper]\n";
    for (const char axis : {'x', 'y'})
      text += fmt::format("shaper_type_{0}: {1}\nshaper_freq_{0}: {2}\ndamping_ratio_{0}: 0\n", axis, shaper.name,
                          frequency);
    return text;
  }
  throw std::invalid_argument(
      "these taps are no input shaper of Klipper (impulses of zv, zvd, mzv or ei, without damping); export as csv, c, "
      "json or npy");
}

}  // namespace accdec
