#pragma once

#include <string>
#include <vector>

#include <toml++/toml.h>

#include <accdec/files/toml_table.hpp>
#include <accdec/task.hpp>

// Internal to this folder, as toml_table.hpp.

namespace accdec::toml_input {

/// One problem of a [[hypercube]].
struct DrawnProblem {
  std::string name;
  toml::table task;
  double order_factor = 1.0;  ///< its order over `fastest_order`
};

/// A seeded Latin hypercube: the range of every key is cut into as many cells as there are problems, and every cell is
/// used once. Keys of `corner.*` are drawn for each corner by itself. Values are rounded to four digits.
/// @param base  the task whose keys are replaced; its one corner is repeated if the table has `corners`
/// @throws InputError at a range that is none, or whose key the task does not have
std::vector<DrawnProblem> draw_problems(const Table& table, const toml::table& base);

/// Samples for the fastest start within acceleration, force and power, for a ramp of the acceleration where jerk is
/// limited, and for half a period of the slowest mode. A filter of this order is hardly ever long enough.
/// @return `most` + 1 if a start takes more than `most` samples
int fastest_order(const Task& task, int most);

}  // namespace accdec::toml_input
