#pragma once

#include <string_view>

namespace accdec {

/// A canonical call found in a line; the name is empty if there is none.
struct CanonicalCall {
  std::string_view name;
  std::size_t column = 0;     ///< of the name, from 0
  std::size_t arguments = 0;  ///< index behind its '('
};
CanonicalCall find_call(std::string_view line);

}  // namespace accdec
