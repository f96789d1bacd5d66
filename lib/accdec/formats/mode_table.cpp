#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

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

std::vector<Key> mode_keys() {
  return {{.name = "frequency_Hz",
           .type = KeyType::numbers,
           .meaning = "one frequency or a band [low, high]",
           .unit = "Hz",
           .range = {0.0, 1e6, true},
           .most = 2,
           .example = "[38, 46]",
           .allowed = "allowed is one number or a band [low, high], 0 < frequency_Hz <= 1000000",
           .required = true,
           .lone = true},
          {.name = "frequency_spread",
           .meaning = "for one frequency f without damping: the band from f (1 - spread) to f (1 + spread)",
           .range = {0.0, 0.9},
           .fallback = "0",
           .example = "0.1"},
          {.name = "damping_ratio",
           .type = KeyType::numbers,
           .meaning = "damping ratio, one number or a range [low, high]; frequency_Hz then is that without damping",
           .range = {0.0, 0.9},
           .most = 2,
           .fallback = "0",
           .example = "[0.02, 0.1]",
           .allowed = "allowed is one number or a range [low, high], 0 <= damping_ratio <= 0.9",
           .lone = true},
          {.name = "residual_max",
           .meaning = "allowed residual vibration; 1 is that of an unfiltered step",
           .range = {0.0, 1.0},
           .example = "0.05",
           .allowed = "allowed is 0 <= residual_max <= 1; or `axis` and `residual_max_um`"},
          {.name = "axis",
           .type = KeyType::text,
           .meaning = "the axis that vibrates, for `residual_max_um`",
           .example = "\"x\""},
          {.name = "residual_max_um",
           .meaning = "instead of `residual_max`: allowed amplitude of that axis after starts, corners and stops; of "
                      "axes a, b and c in thousandths of a degree",
           .unit = "um",
           .range = {0.0, 1e6, true},
           .example = "5"}};
}

std::string mode_conditions() {
  return R"({"oneOf": [{"required": ["residual_max"], "properties": {"axis": false, "residual_max_um": false}}, )"
         R"({"required": ["axis", "residual_max_um"], "properties": {"residual_max": false}}]})";
}

Mode read_mode(const Table& table) {
  const std::vector<double> band = table.required_numbers("frequency_Hz");
  require_upwards(table, "frequency_Hz", band);
  const bool in_metres = table.has("residual_max_um");
  if (table.has("residual_max") == in_metres)
    table.fail(
        fmt::format("[[mode]] {} `residual_max` {} `residual_max_um`; allowed is one: the part of an unfiltered "
                    "step, or the amplitude of one axis",
                    in_metres ? "has both" : "needs", in_metres ? "and" : "or"));
  if (table.has("axis") != in_metres)
    table.fail_at(in_metres ? "residual_max_um" : "axis",
                  in_metres ? "`residual_max_um` is the amplitude of one axis; name it by `axis`"
                            : "`axis` goes with `residual_max_um`; the ratio `residual_max` is the same for all axes");
  Mode mode{band.front(), band.back(), in_metres ? 1.0 : table.required_number("residual_max")};
  if (in_metres) mode.displacement_max = *table.number("residual_max_um");
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

void find_axis_of_mode(const Table& table, const Task& task, Mode& mode) {
  const std::optional<std::string> name = table.text("axis");
  if (!name) return;
  std::vector<std::string> names;
  for (const Axis& axis : task.machine.axes) names.push_back(axis.name);
  const auto found = std::find(names.begin(), names.end(), *name);
  if (found == names.end())
    table.fail_at("axis",
                  fmt::format("`axis` = \"{}\" is no axis of the task; allowed are {}", *name, fmt::join(names, ", ")));
  mode.axis = static_cast<int>(found - names.begin());
  if (task.settings && task.settings->names(DelayKind::corner_feed))
    table.fail_at("residual_max_um",
                  "`residual_max_um` is not considered where corners are passed at a part of the feed, whose steps "
                  "swing together; leave \"corner-feed\" out of `delays`, or give a `residual_max`");
}

}  // namespace accdec
