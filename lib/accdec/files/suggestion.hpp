#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace accdec {

/// Optimal string alignment distance: insertions, deletions, substitutions and swaps of neighbours, each 1.
int edit_distance(std::string_view a, std::string_view b);

/// The most likely intended word of `allowed`. It may be the same quantity in another unit ("error_max_mm" for
/// "error_max_um"), or the same word in other case or with other separators. Otherwise it is a few typing errors away.
/// Empty if none is near.
std::string nearest(std::string_view word, std::span<const std::string_view> allowed);

/// "did you mean `error_max_um`?" or, if none is near, "known here: a, b, c".
std::string suggest(std::string_view word, std::span<const std::string_view> allowed);

/// "unknown solver "ipotp"; did you mean "ipopt"? known are ipopt, clp".
std::string unknown_name(std::string_view noun, std::string_view name, const std::vector<std::string>& known);

}  // namespace accdec
