#pragma once

#include <string>
#include <vector>

#include <accdec/comparison/comparison_run.hpp>
#include <accdec/files.hpp>

namespace accdec {

/// A suite of comparison problems, read.
struct Suite {
  std::string path;
  comparison::ComparisonSettings settings;
  std::vector<comparison::CaseSpec> cases;  ///< every problem at every size
  std::string hash;                         ///< over everything results depend on
};

/// Reads SUITE.toml; problems/suite/full.toml explains every key. Paths of tasks in it are relative to it.
/// @param solvers  instead of the suite's, if not empty
/// @throws InputError with position: unknown keys with a suggestion, unknown solvers with the known ones, tasks that do
/// not exist or do not fit their question. For an unknown name in `solvers`: std::invalid_argument
Suite read_suite(const std::string& path, const std::vector<std::string>& solvers = {});

}  // namespace accdec
