#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/filter.hpp>
#include <accdec/formats/export/exported_design.hpp>

namespace accdec {
namespace {

/// The time between the impulses, samples, if the filter is these after any leading zeros; else 0.
double impulses_apart(const Filter& filter, const ShaperInfo& shaper) {
  const int begin = filter.first_nonzero_tap(), order = filter.last_nonzero_tap() - begin;
  // The impulses are symmetric, so that the mean delay is half of their length, also where they are split.
  const double apart = 2.0 * (filter.mean_delay() - begin) / shaper.pairs, whole = std::round(apart);
  if (!(apart >= 1.0 - 1e-9)) return 0.0;
  const double delay = std::abs(apart - whole) < 1e-9 * apart ? whole : apart;
  const Filter like = with_pairs(Filter({1.0}), shaper.pairs, delay, shaper.outer);
  if (like.order() != order) return 0.0;
  for (int i = 0; i <= order; ++i) {
    if (!(std::abs(filter.tap(begin + i) - like.tap(i)) < 1e-9)) return 0.0;
  }
  return delay;
}

}  // namespace

std::string klipper_export(const ExportedDesign& design) {
  for (const ShaperInfo& shaper : shaper_list()) {
    const double apart = impulses_apart(design.filter, shaper);
    if (apart == 0.0) continue;
    std::string text = "# Input shaper designed by accdec, for Klipper's and Kalico's printer.cfg\n";
    for (const std::string& fact : design.facts()) text += "# " + ascii_line(fact) + "\n";
    for (const CornerResult& corner : design.result.corners)
      text += ascii_line(fmt::format("# delay: {} samples at corner {}; the configuration has no key for it",
                                     corner.delay, corner.name)) +
              "\n";
    const std::string frequency = fmt::format("{:.12g}", shaper.delay_periods / (apart * design.period));
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
