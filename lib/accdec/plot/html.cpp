#include <cstdlib>

#include <fmt/format.h>

#include <accdec/plot/html.hpp>

namespace accdec {
namespace {

constexpr std::string_view style =
    "body{font:16px/1.45 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 "
    "1rem;color:#1a1a1a;background:#fff}"
    "table{border-collapse:collapse;margin:1rem 0}td,th{border:1px solid #bbb;padding:.25rem .6rem;text-align:left}"
    "td.n{text-align:right}figure{margin:2rem 0}svg{max-width:100%;height:auto}";

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
      "<!DOCTYPE html>\n<html lang=en><head><meta "
      "charset=utf-8><title>{0}</title><style>{1}</style></head><body>\n<h1>{0}</h1>\n",
      html_escaped(title), style);
}

std::string html_figure(const std::string& name, const std::string& svg) {
  const std::size_t start = svg.find("<svg");
  return fmt::format("<figure id=\"{}\">\n{}\n</figure>\n", name, start == std::string::npos ? "" : svg.substr(start));
}

std::string html_table(const std::vector<std::string>& head, const std::vector<std::vector<std::string>>& rows) {
  std::string html = "<table><tr>";
  for (const std::string& cell : head) html += fmt::format("<th>{}</th>", html_escaped(cell));
  html += "</tr>\n";
  for (const auto& row : rows) {
    html += "<tr>";
    for (const std::string& cell : row)
      html += fmt::format("<td{}>{}</td>", is_number(cell) ? " class=n" : "", html_escaped(cell));
    html += "</tr>\n";
  }
  return html + "</table>\n";
}

}  // namespace accdec
