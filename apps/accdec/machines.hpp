#pragma once

#include <span>
#include <string_view>

namespace accdec::cli {

/// A task of problems/machine/, built into the program.
struct MachineFile {
  std::string_view name;  ///< the file's, without .toml
  std::string_view text;
};

/// In alphabetical order.
std::span<const MachineFile> machine_files();
/// The one to begin with.
inline constexpr std::string_view first_machine = "mill";
/// In cmd_init.cpp. @throws std::out_of_range if there is none of that name
const MachineFile& machine_file(std::string_view name);

}  // namespace accdec::cli
