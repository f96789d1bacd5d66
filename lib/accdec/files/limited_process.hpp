#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace accdec {

/// Limits of a program that nobody here wrote.
struct ProcessLimits {
  double seconds = 60.0;                        ///< from its start until it and everything it started is killed
  std::size_t most_output = 1'000'000;          ///< bytes of standard output and error together
  std::size_t most_file_bytes = 1'000'000'000;  ///< of every file it writes
  std::size_t most_memory = 0;                  ///< bytes of addresses of every process; further ones fail; 0: no limit
  bool folder_goes = false;                     ///< its folder is removed if the caller ends before it, or it is killed
};

struct LimitedOutput {
  int exit_code = 0;     ///< 128 + signal if one ended it
  std::string output;    ///< standard output
  std::string messages;  ///< standard error
  std::string stopped;   ///< the limit that it broke; empty if it ended itself
  double seconds = 0.0;
};

/// Runs a program found on PATH in a folder, without a shell and without input. Whatever it started is killed when it
/// ends or breaks a limit, or when this process ends, also processes that left its group. Must not be called while
/// other threads of this process start programs.
/// @throws std::runtime_error if it cannot be started
LimitedOutput run_limited(const std::vector<std::string>& arguments, const std::string& folder,
                          const ProcessLimits& limits);

}  // namespace accdec
