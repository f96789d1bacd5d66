#include <cstdlib>

#include <fmt/format.h>

#include <accdec/plot/html.hpp>
#include <accdec/plot/html_parts.hpp>

namespace accdec {
namespace {

bool is_number(const std::string& text) {
  if (text.empty()) return false;
  char* end = nullptr;
  std::strtod(text.c_str(), &end);
  return *end == '\0';
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
  std::string html = fmt::format("<div class=\"wide\"><table{}{}><thead><tr>",
                                 table.id.empty() ? "" : fmt::format(" id=\"{}\"", html_escaped(table.id)),
                                 table.sortable ? " class=\"sorts\"" : "");
  for (const std::string& cell : table.head) html += fmt::format("<th>{}</th>", html_escaped(cell));
  html += "</tr></thead><tbody>\n";
  for (const auto& row : table.rows) {
    html += "<tr>";
    for (const std::string& cell : row)
      html += fmt::format("<td{}>{}</td>", is_number(cell) ? " class=\"n\"" : "", html_escaped(cell));
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

}  // namespace accdec
