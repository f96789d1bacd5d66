#pragma once

#include <array>
#include <string_view>
#include <vector>

#include <accdec/files/keys.hpp>

namespace accdec {

/// Every key of a task file. Limits of axes come from the table in machine/limits.hpp, shapes of filters from
/// `shape_list`.
const FileKind& task_file();

/// The keys of [filter] and [baseline].
const std::vector<Key>& filter_keys();

namespace task_keys {

inline constexpr int order_limit = 1'000'000;
inline constexpr int delay_limit = 1'000'000;
inline constexpr std::size_t axes_limit = 9;
/// Names for axes without a name, in order.
inline constexpr std::array<std::string_view, axes_limit> axis_names{"x", "y", "z", "a", "b", "c", "u", "v", "w"};

}  // namespace task_keys
}  // namespace accdec
