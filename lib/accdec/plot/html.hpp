#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <accdec/plot/figure.hpp>

// Internal to the library: pieces of a page that stands alone. A page names nothing outside itself: style, script,
// drawings and their numbers are in it.

namespace accdec {

std::string html_escaped(std::string_view text);
/// Up to and with <body> and the heading, as escaped text.
std::string html_head(const std::string& title);
/// What ends a page: its script (values under the pointer, tables that sort, all unfolded for print) and </html>.
std::string html_foot();
/// A paragraph of escaped text.
std::string html_paragraph(const std::string& text);
/// HTML folded away under a line of escaped text.
std::string html_folded(const std::string& summary, const std::string& content);
/// A drawing of a figure as part of a page, with the figure's numbers for the pointer. Its XML prologue, which names a
/// DTD, is left out.
/// @param svg  of render_svg(figure)
std::string html_figure(const std::string& name, const Figure& figure, const std::string& svg);

struct HtmlTable {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
  std::string id = {};    ///< of the element; none if empty
  bool sortable = false;  ///< by a click on a heading
};
/// A table that scrolls by itself where the page is too narrow; cells that are numbers stand to the right. All texts
/// are escaped.
std::string html_table(const HtmlTable& table);

}  // namespace accdec
