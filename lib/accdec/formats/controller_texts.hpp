#pragma once

#include <span>
#include <string_view>

namespace accdec {

/// A file of problems/controllers/, built into the library by accdec_embed.
struct ControllerText {
  std::string_view name;  ///< the file's, without .toml
  std::string_view text;
};

/// In alphabetical order.
std::span<const ControllerText> controller_texts();

}  // namespace accdec
