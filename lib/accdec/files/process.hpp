#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace accdec {

/// What a child process left behind.
struct ProcessOutput {
  int exit_code = 0;   ///< 128 + signal if one ended it
  std::string output;  ///< standard output
  std::string errors;  ///< standard error
};

/// Runs a program found on PATH, without a shell, feeding it `input` and collecting what it writes.
/// @param arguments  the program's name, then its arguments
/// @param package    Debian package to name if the program is missing
/// @throws std::runtime_error if the program is missing ("gnuplot is not installed (Debian package gnuplot-nox)") or
/// cannot be started.
ProcessOutput run_process(const std::vector<std::string>& arguments, std::string_view input,
                          const std::string& package);

}  // namespace accdec
