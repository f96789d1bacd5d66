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

}  // namespace accdec::cli
