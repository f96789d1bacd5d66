#include <array>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/formats/export/exported_design.hpp>

namespace accdec {
namespace {

/// A shaper of Klipper's klippy/extras/shaper_defs.py without damping: impulses equally far apart.
struct KlipperShaper {
  const char* name;
  double span;  ///< from the first impulse to the last, in periods of its frequency
  std::vector<double> impulses;
};

const std::vector<KlipperShaper>& klipper_shapers() {
  const double root = std::sqrt(2.0), mzv = 1.0 - 1.0 / root, ei = 0.25 * 1.05;
  static const std::vector<KlipperShaper> all{{"zv", 0.5, {0.5, 0.5}},
                                              {"zvd", 1.0, {0.25, 0.5, 0.25}},
                                              {"mzv", 0.75, {mzv, root - 1.0, mzv}},
                                              {"ei", 1.0, {ei, 0.5 * 0.95, ei}}};
  return all;
}

/// Whether the filter is these impulses, after any leading zeros.
bool is_shaper(const Filter& filter, const KlipperShaper& shaper) {
  const int begin = filter.first_nonzero_tap(), length = filter.last_nonzero_tap() - begin;
  const int gaps = static_cast<int>(shaper.impulses.size()) - 1;
  if (length == 0 || length % gaps != 0) return false;
  double sum = 0.0;
  for (const double impulse : shaper.impulses) sum += impulse;
  for (int i = 0; i <= length; ++i) {
    const bool impulse = i % (length / gaps) == 0;
    const double tap = impulse ? shaper.impulses[static_cast<std::size_t>(i / (length / gaps))] / sum : 0.0;
    if (!(std::abs(filter.tap(begin + i) - tap) < 1e-9)) return false;
  }
  return true;
}

}  // namespace

std::string klipper_export(const ExportedDesign& design) {
  for (const KlipperShaper& shaper : klipper_shapers()) {
    if (!is_shaper(design.filter, shaper)) continue;
    std::string text = "# Input shaper designed by accdec, for Klipper's and Kalico's printer.cfg\n";
    for (const std::string& fact : design.facts()) text += "# " + ascii_line(fact) + "\n";
    for (const CornerResult& corner : design.result.corners)
      text += ascii_line(fmt::format("# delay: {} samples at corner {}; the configuration has no key for it",
                                     corner.delay, corner.name)) +
              "\n";
    const int samples = design.filter.last_nonzero_tap() - design.filter.first_nonzero_tap();
    const std::string frequency = fmt::format("{}", shaper.span / (samples * design.period));
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
