#pragma once

#include <string>
#include <string_view>

#include <accdec/formats/export/exported_design.hpp>

namespace accdec {

/// A header in C up to its taps: comment, include guard, order and sample period. @param what  the comment's first line
std::string c_head(const ExportedDesign& design, std::string_view guard, std::string_view what);
/// Delays, names of corners, title, commit, and the end of the guard.
std::string c_tail(const ExportedDesign& design);

}  // namespace accdec
