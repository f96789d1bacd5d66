#pragma once

#include <string>
#include <vector>

namespace accdec {

/// RFC 4180.
std::string csv_field(const std::string& text);
std::string csv_table(const std::vector<std::string>& head, const std::vector<std::vector<std::string>>& rows);

}  // namespace accdec
