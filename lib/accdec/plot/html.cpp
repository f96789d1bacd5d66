#include <cstdlib>

#include <fmt/format.h>

#include <accdec/files/units.hpp>
#include <accdec/plot/html.hpp>
#include <accdec/plot/html_parts.hpp>

namespace accdec {
namespace {

constexpr std::size_t fewest_card_columns = 4;  ///< a phone has no room for so many beside each other
constexpr std::size_t longest_line = 60;        ///< characters of a cell; a longer text has several lines

bool is_number(const std::string& text) {
  if (text.empty()) return false;
  char* end = nullptr;
  std::strtod(text.c_str(), &end);
  return *end == '\0';
}

/// The attribute that says how a cell is set.
const char* kind_of(const std::string& cell) {
  return is_number(cell) ? " class=\"n\"" : cell.size() > longest_line ? " class=\"long\"" : "";
}

/// "mm/s^2" and "error um" with their unit as it is printed: "mm/s²" and "error µm".
std::string printed(const std::string& text) {
  const std::size_t at = text.rfind(' ') + 1;
  const Unit* const unit = find_unit(std::string_view(text).substr(at));
  return unit ? text.substr(0, at).append(unit->printed) : text;
}

}  // namespace

std::string html_escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      default: out += c;
    }
  }
  return out;
}

std::string html_head(const std::string& title) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width,initial-scale=1\"><title>{0}</title><style>{1}</style></head><body>\n<h1>{0}</"
      "h1>\n",
      html_escaped(clean_title(title)), html_style);
}

std::string html_foot() {
  return fmt::format("<script>{}</script>\n</body></html>\n", html_script);
}

std::string html_paragraph(const std::string& text) {
  return fmt::format("<p>{}</p>\n", html_escaped(text));
}

std::string html_folded(const std::string& summary, const std::string& content) {
  return fmt::format("<details><summary>{}</summary>\n{}</details>\n", html_escaped(summary), content);
}

std::string html_figure(const std::string& name, const Figure& figure, const std::string& svg) {
  const std::size_t start = svg.find("<svg");
  return fmt::format(
      "<figure id=\"{}\">\n<div class=\"wide\">{}</div>\n<script type=\"application/json\">{}</script>\n"
      "</figure>\n",
      html_escaped(name), start == std::string::npos ? "" : svg.substr(start), hover_json(figure));
}

std::string html_table(const HtmlTable& table) {
  const bool cards = !table.sortable && table.head.size() >= fewest_card_columns;
  std::string html = fmt::format("<div class=\"wide\"><table{}{}><thead><tr>",
                                 table.id.empty() ? "" : fmt::format(" id=\"{}\"", html_escaped(table.id)),
                                 table.sortable ? " class=\"sorts\""
                                 : cards        ? " class=\"cards\""
                                                : "");
  for (const std::string& cell : table.head) html += fmt::format("<th>{}</th>", html_escaped(printed(cell)));
  html += "</tr></thead><tbody>\n";
  for (const auto& row : table.rows) {
    html += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string& cell = row[i];
      html += fmt::format("<td{}{}>{}</td>", kind_of(cell),
                          cards ? fmt::format(" data-head=\"{}\"", html_escaped(printed(table.head.at(i)))) : "",
                          html_escaped(table.head.at(i) == "unit" ? printed(cell) : cell));
    }
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

}  // namespace accdec
