#pragma once

#include <string>
#include <vector>

#include "support/paths.hpp"
#include "support/process.hpp"
#include "support/temporary_folder.hpp"

namespace accdec {

/// The outcome of one run of the program.
struct Outcome {
  int code = -1;
  std::string out, err;
};

inline std::string quoted(const std::string& argument) {
  std::string text(1, '\'');
  for (const char c : argument) {
    if (c == '\'') text.append("'\\'");
    text.push_back(c);
  }
  text.push_back('\'');
  return text;
}

/// Runs accdec with these arguments, standard output and error kept apart.
inline Outcome run(const std::vector<std::string>& arguments) {
  const TemporaryFolder folder;
  std::string command = quoted(accdec::test_support::program());
  for (const std::string& argument : arguments) command.append(1, ' ').append(quoted(argument));
  const int code =
      test_support::wait_for(test_support::start_shell("exec " + command, folder.path("out"), folder.path("err")));
  return {code, folder.read("out"), folder.read("err")};
}

}  // namespace accdec
