#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include <accdec/families/grid_family.hpp>

namespace accdec {
namespace {

constexpr std::array<GridFamily, 3> grid_families{{{SettingFamily::exponential, "time constant", "ms", 1e3, 1},
                                                   {SettingFamily::gaussian, "alpha", "", 1.0, 1},
                                                   {SettingFamily::windowed_sinc, "cut-off", "Hz", 1.0, 2}}};

/// A multiple at the end of its range counts in spite of rounding.
constexpr double at_end = 1.0 + 1e-9;

}  // namespace

const GridFamily* find_grid_family(SettingFamily family) {
  const auto* found =
      std::find_if(grid_families.begin(), grid_families.end(), [=](const GridFamily& g) { return g.family == family; });
  return found == grid_families.end() ? nullptr : found;
}

double grid_step(const Task& task, SettingFamily family) {
  const ControllerSettings& settings = *task.settings;
  if (family == SettingFamily::gaussian) return settings.alpha_step;
  if (family == SettingFamily::windowed_sinc) return settings.cutoff_step;
  return settings.time_constant_step > 0.0 ? settings.time_constant_step : task.sample_period;
}

int largest_multiple(const Task& task, SettingFamily family, int order) {
  double largest = (task.design.order_max + 1.0) * task.sample_period;
  if (family == SettingFamily::gaussian) largest = gaussian_alpha_max;
  if (family == SettingFamily::windowed_sinc) largest = 1.0 / (order * task.sample_period);
  return static_cast<int>(std::min(largest / grid_step(task, family) * at_end, 1e9));
}

FilterSpec grid_member(const Task& task, SettingFamily family, int order, int multiple) {
  const double number = multiple * grid_step(task, family);
  if (family == SettingFamily::gaussian)
    return {.kind = Shape::gaussian, .order = order, .alpha = std::min(number, gaussian_alpha_max)};
  if (family == SettingFamily::windowed_sinc) {
    const double cutoff = 2.0 * number * task.sample_period;
    return {.kind = Shape::blackman_sinc, .order = order, .cutoff = std::min(cutoff, 2.0 / order)};
  }
  return {.kind = Shape::exponential, .order = order, .ratio = std::exp(-task.sample_period / number)};
}

Setting grid_setting(const Task& task, SettingFamily family, int multiple) {
  const GridFamily& grid = *find_grid_family(family);
  const double number = multiple * grid_step(task, family) * grid.in_unit;
  // The number entered has no digits that rounding made, and still makes the same taps to 12 digits.
  return {std::string(grid.number), std::stod(fmt::format("{:.14g}", number)), std::string(grid.unit)};
}

}  // namespace accdec
