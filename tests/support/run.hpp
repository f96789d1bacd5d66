#pragma once

#include <cstdlib>
#include <string>
#include <vector>

#include <sys/wait.h>

#include "support/paths.hpp"
#include "support/temporary_folder.hpp"

namespace accdec {

/// What one run of the program gave.
struct Outcome {
  int code = -1;
  std::string out, err;
};

inline std::string quoted(const std::string& argument) {
  std::string text(1, '\'');
  for (const char c : argument) {
    if (c == '\'') text.append("'\\'");
    text.push_back(c);
    if (c == '\'') text.push_back('\'');
  }
  text.push_back('\'');
  return text;
}

/// Runs accdec with these arguments, standard output and error kept apart.
inline Outcome run(const std::vector<std::string>& arguments) {
  const TemporaryFolder folder;
  std::string command = quoted(accdec::test_support::program());
  for (const std::string& argument : arguments) command.append(1, ' ').append(quoted(argument));
  command.append(" >")
      .append(quoted(folder.path("out")))
      .append(" 2>")
      .append(quoted(folder.path("err")))
      .append(" </dev/null");
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), folder.read("out"), folder.read("err")};
}

}  // namespace accdec
