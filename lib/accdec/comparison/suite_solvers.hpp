#pragma once

#include <string>
#include <vector>

#include <accdec/comparison/comparison_run.hpp>
#include <accdec/files/toml_table.hpp>

// Internal to this folder, as toml_table.hpp.

namespace accdec::toml_input {

/// Reads `solvers`, `reduced`, every [[variant]] and every [[external]] of a suite into its settings.
/// @param folder   of the suite
/// @param instead  names to take instead of the suite's solvers and variants, if not empty
/// @throws InputError for unknown solvers, forms and options, with the known ones, and for repeated names;
/// std::invalid_argument for unknown or repeated names in `instead`
void read_competitors(const Table& top, const std::string& folder, const std::vector<std::string>& instead,
                      comparison::ComparisonSettings& settings);

}  // namespace accdec::toml_input
