#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include <accdec/batch/portable_random.hpp>
#include <accdec/comparison/suite_hypercube.hpp>
#include <accdec/files.hpp>
#include <accdec/formats/task_edit.hpp>
#include <accdec/task/order_bound.hpp>

namespace accdec::toml_input {
namespace {

struct Bounds {
  double low = 0.0, high = 0.0;
};

constexpr Bounds default_order_factor{1.2, 2.0};

/// A range of `ranges`. @throws InputError
Bounds bounds_of(const Table& table, const std::string& key, const toml::node& value) {
  const toml::array* pair = value.as_array();
  const auto number = [&](std::size_t i) { return (*pair)[i].value<double>().value_or(NAN); };
  if (pair && pair->size() == 2 && std::isfinite(number(0)) && std::isfinite(number(1)) && number(0) <= number(1))
    return {number(0), number(1)};
  throw InputError(table.file(), value.source().begin.line, value.source().begin.column,
                   fmt::format("range `{}` must be two numbers, the lower first", key));
}

/// A pair of numbers of a key, the same twice if one was given.
Bounds pair_of(const Table& table, std::string_view key, Bounds otherwise = {}) {
  const std::vector<double> given = table.numbers(key);
  if (given.empty()) return otherwise;
  if (given.size() > 2 || given.front() > given.back())
    table.fail_at(key, fmt::format("`{}` needs one number, or two with the lower first", key));
  return {given.front(), given.back()};
}

/// The only corner of the base as `count` corners c1, c2, ..
void repeat_corner(toml::table& task, int count) {
  const toml::table corner = *task["corner"][0].as_table();
  toml::array corners;
  for (int j = 1; j <= count; ++j) {
    corners.push_back(corner);
    corners.back().as_table()->insert_or_assign("name", fmt::format("c{}", j));
  }
  task.insert_or_assign("corner", std::move(corners));
}

std::size_t corners_in(const toml::table& task) {
  const toml::array* corners = task["corner"].as_array();
  return corners ? corners->size() : 0;
}

/// The task with every corner passed in both directions, so that every leg is started from rest.
Task with_both_legs(Task task) {
  for (std::size_t j = 0, n = task.corners.size(); j < n; ++j) {
    const Corner corner = task.corners[j].geometry();
    const auto list = [](const auto& v) { return std::vector<double>(v.data(), v.data() + v.size()); };
    task.corners.emplace_back(task.corners[j].name, DirectedLegs{list(corner.direction_out), list(corner.direction_in)},
                              corner.feed_out, corner.feed_in);
  }
  return task;
}

double rounded(double value) {
  return std::strtod(fmt::format("{:.4g}", value).c_str(), nullptr);
}

}  // namespace

std::vector<DrawnProblem> draw_problems(const Table& table, const toml::table& base) {
  const std::string name = *table.text("name");
  const auto count = static_cast<std::size_t>(table.required_integer("count"));
  std::mt19937_64 random(static_cast<std::uint64_t>(table.required_integer("seed")));
  const auto column = [&](double low, double high) {
    std::vector<double> values = batch::latin_column(count, random);
    for (double& value : values) value = low + (high - low) * value;
    return values;
  };
  std::vector<DrawnProblem> problems;
  std::size_t most_corners = corners_in(base);
  const Bounds factors = pair_of(table, "order_factor", default_order_factor);
  for (const double factor : column(factors.low, factors.high))
    problems.push_back({fmt::format("{} {:03}", name, problems.size() + 1), base, factor});
  if (table.has("corners")) {
    if (most_corners != 1) table.fail_at("corners", "`corners` repeats the only corner of a task; this one has others");
    const Bounds counts = pair_of(table, "corners");
    most_corners = static_cast<std::size_t>(counts.high);
    const std::vector<double> drawn = column(counts.low, counts.high + 1.0);
    for (std::size_t i = 0; i < problems.size(); ++i) repeat_corner(problems[i].task, static_cast<int>(drawn[i]));
  }
  for (const auto& [node, value] : *table.raw()["ranges"].as_table()) {
    const std::string key(node.str());
    const Bounds range = bounds_of(table, key, value);
    const bool each = key.starts_with("corner.*.");
    for (std::size_t j = 0; j < (each ? most_corners : 1); ++j) {
      const std::vector<double> drawn = column(range.low, range.high);
      try {
        const TaskKey place(each ? fmt::format("corner.{}.{}", j, key.substr(9)) : key);
        for (std::size_t i = 0; i < problems.size(); ++i) {
          if (!each || j < corners_in(problems[i].task)) place.set(problems[i].task, rounded(drawn[i]));
        }
      } catch (const std::invalid_argument& error) {
        throw InputError(table.file(), value.source().begin.line, value.source().begin.column, error.what());
      }
    }
  }
  return problems;
}

int fastest_order(const Task& task, int most) {
  const int start = order_lower_bound(with_both_legs(task), most);
  if (start > most) return start;
  double ramp = 0.0, period = 0.0;
  for (const Axis& axis : task.machine.axes) {
    const double by_force = axis.mass > 0.0 ? axis.force_max / axis.mass : unlimited;
    const double most_acceleration = std::min(axis.acceleration_max, by_force);
    if (axis.jerk_max < unlimited && most_acceleration < unlimited)
      ramp = std::max(ramp, most_acceleration / axis.jerk_max);
  }
  for (const Mode& mode : task.machine.modes) period = std::max(period, 0.5 / mode.frequency_low);
  return start + static_cast<int>(std::ceil((ramp + period) / task.sample_period));
}

}  // namespace accdec::toml_input
