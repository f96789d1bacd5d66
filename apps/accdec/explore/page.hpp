#pragma once

#include <span>
#include <string_view>

namespace accdec::explore {

/// A file of page/, built into the program.
struct PageFile {
  std::string_view name;  ///< "index.html"
  std::string_view type;  ///< as HTTP has it
  std::string_view text;
};

std::span<const PageFile> page_files();

}  // namespace accdec::explore
