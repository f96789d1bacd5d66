#pragma once

#include <string>

#include <accdec/task/result.hpp>

#include "command.hpp"

namespace accdec::cli {

/// The option --json FILE of commands that write a result.
inline void add_json_option(CLI::App& command, std::string& path) {
  command.add_option("--json", path, "Write the result to FILE, - for standard output (then no table is printed)")
      ->type_name("FILE");
}

/// Writes the result to `json_path` unless that is empty, prints the table unless quiet or standard output carries
/// JSON, and gives the exit code its status calls for.
int deliver(const DesignResult& result, const std::string& json_path, const Context& context);

}  // namespace accdec::cli
