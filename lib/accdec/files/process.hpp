#pragma once

#include <cstddef>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <accdec/files.hpp>

namespace accdec {

/// A program that is needed is not installed; what() names it and its package.
class MissingProgram : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Exit code and output of a child process.
struct ProcessOutput {
  int exit_code = 0;    ///< 128 + signal if one ended it
  std::string output;   ///< standard output
  std::string errors;   ///< standard error
  bool killed = false;  ///< it took longer, or wrote more, than it was allowed
};

/// Runs a program found on PATH, without a shell, feeding it `input` and collecting what it writes.
/// @param arguments  the program's name, then its arguments
/// @param package    Debian package to name if the program is missing
/// @param deadline   kills it
/// @param most       bytes of standard output, with more of which it is killed
/// @throws MissingProgram ("gnuplot is not installed (Debian package gnuplot-nox)"), std::runtime_error if it cannot be
/// started.
ProcessOutput run_process(const std::vector<std::string>& arguments, std::string_view input, const std::string& package,
                          const Deadline& deadline = {}, std::size_t most = std::numeric_limits<std::size_t>::max());

/// Kills the program that run_process waits for, if there is one. This process must end then.
void kill_running_process();

}  // namespace accdec
