#pragma once

#include <string>
#include <vector>

namespace accdec {

/// A field quoted as RFC 4180 says. A text that a spreadsheet would take for a formula gets an apostrophe in front;
/// numbers stay.
std::string csv_field(const std::string& text);
std::string csv_table(const std::vector<std::string>& head, const std::vector<std::vector<std::string>>& rows);

}  // namespace accdec
