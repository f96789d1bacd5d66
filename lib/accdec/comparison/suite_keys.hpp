#pragma once

#include <string>
#include <vector>

#include <accdec/files/keys.hpp>

namespace accdec {

/// Every key of a suite file.
const FileKind& suite_file();

inline constexpr int most_taps = 100'000;  ///< for a problem's filter at any size

/// Names of the registry, and with them "exact", and "NAME/sparse", "NAME/reduced" for those that take both forms.
std::vector<std::string> solver_names();
std::vector<std::string> solver_names_with_forms();

}  // namespace accdec
