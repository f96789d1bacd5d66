#pragma once

#include <string>
#include <string_view>
#include <vector>

// Internal to the room: pieces of a report that stands alone.

namespace accdec {

std::string html_escaped(std::string_view text);
/// Up to and with <body> and the heading.
std::string html_head(const std::string& title);
/// An SVG as part of a page: its XML prologue names a DTD, and a report must point nowhere.
std::string html_figure(const std::string& name, const std::string& svg);
/// A table; cells that are numbers stand to the right. All texts are escaped.
std::string html_table(const std::vector<std::string>& head, const std::vector<std::vector<std::string>>& rows);

}  // namespace accdec
