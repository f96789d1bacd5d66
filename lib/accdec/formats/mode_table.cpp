#include <string_view>
#include <vector>

#include <fmt/format.h>

#include <accdec/formats/mode_table.hpp>

namespace accdec {
namespace {

using toml_input::Table;

/// @param range  one or two numbers
void require_upwards(const Table& table, std::string_view key, const std::vector<double>& range) {
  if (range.front() > range.back()) {
    table.fail_at(
        key, fmt::format("`{}` = [{}, {}] runs downwards; allowed is [low, high]", key, range.front(), range.back()));
  }
}

}  // namespace

Mode read_mode(const Table& table) {
  const std::vector<double> band = table.required_numbers("frequency_Hz");
  require_upwards(table, "frequency_Hz", band);
  Mode mode{band.front(), band.back(), table.required_number("residual_max")};
  if (table.has("frequency_spread")) {
    if (band.size() > 1) {
      table.fail_at("frequency_spread",
                    "`frequency_spread` and a band of frequencies are both given; allowed is one frequency with a "
                    "spread, or a band [low, high] alone");
    }
    const double spread = table.number("frequency_spread").value_or(0.0);
    mode.frequency_low *= 1.0 - spread, mode.frequency_high *= 1.0 + spread;
  }
  if (const std::vector<double> damping = table.numbers("damping_ratio"); !damping.empty()) {
    require_upwards(table, "damping_ratio", damping);
    mode.damping_low = damping.front(), mode.damping_high = damping.back();
  }
  return mode;
}

}  // namespace accdec
