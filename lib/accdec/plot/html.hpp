#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <accdec/plot/figure.hpp>

// Internal to the library: pieces of a self-contained page. A page has no links to other files: it contains style,
// script, drawings and their numbers.

namespace accdec {

std::string html_escaped(std::string_view text);
/// The page up to <body> and the heading, as escaped text.
std::string html_head(const std::string& title);
/// The end of a page: its script (values under the pointer, sortable tables, all unfolded for print) and </html>.
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
/// A table with a line a row. On a phone the cells of a row stand below each other, each with its heading; a sortable
/// table scrolls by itself. Cells with numbers are right-aligned. All texts are escaped.
std::string html_table(const HtmlTable& table);

}  // namespace accdec
