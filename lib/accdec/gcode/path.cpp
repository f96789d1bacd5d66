#include <algorithm>
#include <cmath>

#include <accdec/simulate.hpp>

// A path and its machine as data; toolpath.cpp reads them.

namespace accdec {

double PathArc::from(const double* point, double& dx, double& dy) const {
  dx = point[x] - center_x;
  dy = point[y] - center_y;
  const double r = std::hypot(dx, dy);
  dx /= r;
  dy /= r;
  return r;
}

double Toolpath::length(std::size_t b) const {
  double length = 0.0;
  for (std::size_t a = 0; a < dimensions(); ++a) length = std::hypot(length, point(b + 1)[a] - point(b)[a]);
  return length;
}

std::string Toolpath::axis_name(std::size_t dimension) const {
  return std::string(1, static_cast<char>(program_axes[axes[dimension]] | 0x20));
}

double Toolpath::dwells() const {
  double time = dwell_first;
  for (const auto& [block, seconds] : dwell) time += seconds;
  return time;
}

std::span<const std::pair<std::uint32_t, double>> Toolpath::dwells_at(std::size_t b) const {
  const auto before = [](const auto& one, std::size_t block) { return one.first < block; };
  const auto first = std::lower_bound(dwell.begin(), dwell.end(), b, before),
             last = std::lower_bound(first, dwell.end(), b + 1, before);
  return std::span(dwell).subspan(static_cast<std::size_t>(first - dwell.begin()),
                                  static_cast<std::size_t>(last - first));
}

const Axis* find_axis(const Machine& machine, std::size_t program_axis) {
  const auto turns = [](const std::string& name) {
    return name.size() == 1 && std::string_view("ABCabc").find(name[0]) != std::string_view::npos;
  };
  if (machine.axes.size() == 1 && !rotary_axis(program_axis) && !turns(machine.axes.front().name))
    return &machine.axes.front();
  for (const Axis& axis : machine.axes) {
    if (axis.name.size() == 1 && (axis.name[0] & ~0x20) == program_axes[program_axis]) return &axis;
  }
  return nullptr;
}

Machine program_machine(const Machine& machine, const Toolpath& path) {
  Machine result;
  result.power_total_max = machine.power_total_max;
  result.regeneration_total_max = machine.regeneration_total_max;
  for (std::size_t i = 0; i < path.dimensions(); ++i) {
    const Axis* axis = find_axis(machine, path.axes[i]);
    result.axes.push_back(axis != nullptr ? *axis : Axis{});
    result.axes.back().name = path.axis_name(i);
    // A single axis may stand for several columns, each with its modes.
    for (Mode mode : machine.modes) {
      if (mode.of_axis() && axis != &machine.axes[static_cast<std::size_t>(mode.axis)]) continue;
      if (!mode.of_axis() && i > 0) continue;
      if (mode.of_axis()) mode.axis = static_cast<int>(i);
      result.modes.push_back(mode);
    }
  }
  return result;
}

}  // namespace accdec
