#pragma once

#include <optional>
#include <string>

#include <accdec/formats/circle_json.hpp>
#include <accdec/result.hpp>

#include "command.hpp"

namespace accdec::cli {

/// An option that names a file to write; an empty name is bad usage rather than no output.
inline CLI::Option* add_output_option(CLI::App& command, const std::string& name, std::string& path,
                                      const std::string& description) {
  return command.add_option(name, path, description)->type_name("FILE")->check([](const std::string& text) {
    return text.empty() ? std::string("needs the name of a file, got an empty one") : std::string();
  });
}

/// The option --json FILE of commands that write a result.
inline void add_json_option(CLI::App& command, std::string& path) {
  add_output_option(command, "--json", path,
                    "Write the result to FILE, - for standard output (then no table is printed)");
}

/// "1%", "1 %" or "0.01" as a fraction; none if it is neither, or not from 0 to less than 1.
std::optional<double> fraction(const std::string& text);

inline constexpr double certificate_max_default = 50.0;  ///< MB

/// Warns of values in a task that are allowed but may be a slip.
void warn(const Task& task, const std::string& path, const Context& context);

/// Writes the result to `json_path` unless that is empty, prints the table unless quiet or standard output carries
/// JSON, and gives the exit code its status calls for.
/// @param certificate_max  MB: with a larger proof the file is written without it, and a line says so
/// @param circle  also written, if there is one
int deliver(const DesignResult& result, const std::string& json_path, const Context& context,
            double certificate_max = certificate_max_default, const std::optional<CircleRecord>& circle = {});

}  // namespace accdec::cli
