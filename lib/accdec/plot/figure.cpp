#include <array>
#include <filesystem>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include <accdec/files/process.hpp>
#include <accdec/files/suggestion.hpp>
#include <accdec/plot/figure.hpp>
#include <accdec/plot/html.hpp>

namespace accdec {
namespace {

std::string run(const std::vector<std::string>& arguments, const std::string& input, const std::string& package) {
  ProcessOutput result = run_process(arguments, input, package);
  if (result.exit_code != 0 || result.output.empty()) {
    throw std::runtime_error(fmt::format("{} failed ({}): {}", arguments[0], result.exit_code, result.errors));
  }
  return std::move(result.output);
}

/// Bytes of the UTF-8 character at text[i], 0 if it is none (overlong forms and surrogates included).
std::size_t utf8_length(const std::string& text, std::size_t i) {
  const auto byte = [&](std::size_t k) { return k < text.size() ? static_cast<unsigned char>(text[k]) : 0u; };
  const unsigned first = byte(i);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xF5 ? 0 : first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : first >= 0xC2 ? 2 : 0;
  for (std::size_t k = 1; k < length; ++k) {
    if ((byte(i + k) & 0xC0) != 0x80) return 0;
  }
  const unsigned second = byte(i + 1);
  const bool overlong = (first == 0xE0 && second < 0xA0) || (first == 0xF0 && second < 0x90);
  const bool outside = (first == 0xED && second >= 0xA0) || (first == 0xF4 && second >= 0x90);
  // U+FFFE and U+FFFF are not allowed in XML.
  const bool forbidden = first == 0xEF && second == 0xBF && byte(i + 2) >= 0xBE;
  return overlong || outside || forbidden ? 0 : length;
}

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
}

/// gnuplot names itself in the drawing: as its title and description, which browsers show at the pointer, as titles of
/// curves that have none, and in the names of groups.
void name_drawing(std::string& svg, const std::string& title) {
  constexpr std::string_view own = "<title>Gnuplot</title>", begin = "<title>gnuplot_plot_", end = "</title>";
  replace_all(svg, own, title.empty() ? "" : "<title>" + html_escaped(clean_title(title)) + "</title>");
  for (std::size_t at = 0; (at = svg.find(begin, at)) != std::string::npos;)
    svg.erase(at, svg.find(end, at) + end.size() - at);
  constexpr std::string_view maker = "<desc>Produced by GNUPLOT", maker_end = "</desc>\n";
  if (const std::size_t at = svg.find(maker); at != std::string::npos)
    svg.erase(at, svg.find(maker_end, at) + maker_end.size() - at);
  replace_all(svg, "id=\"gnuplot_plot_", "id=\"curve_");
  replace_all(svg, "id=\"gnuplot_canvas", "id=\"drawing");
}

}  // namespace

std::string clean_title(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = utf8_length(text, i);
    if (length == 0) {
      out += '?';
      ++i;
      continue;
    }
    const auto c = static_cast<unsigned char>(text[i]);
    if (length == 1 && (c < 0x20 || c == 0x7F))
      out += ' ';
    else
      out.append(text, i, length);
    i += length;
  }
  return out;
}

std::string render_svg(const Figure& figure) {
  // -d: no start-up files, so that numbers, fonts and terminal come only from the script.
  std::string svg = run({"gnuplot", "-d", "-"}, gnuplot_script(figure), "gnuplot-nox");
  // gnuplot escapes "<" and "&" but not the ">" that XML forbids after "]]".
  replace_all(svg, "]]>", "]]&gt;");
  name_drawing(svg, figure.title);
  return svg;
}

std::string convert_svg(const std::string& svg, const std::string& format, const std::string& title) {
  if (format == "svg") return svg;
  if (format == "png") return run({"rsvg-convert", "--format=png", "--zoom=2"}, svg, "librsvg2-bin");
  if (format == "pdf") return run({"rsvg-convert", "--format=pdf"}, svg, "librsvg2-bin");
  if (format != "html")
    throw std::invalid_argument(fmt::format("unknown figure format \"{}\"; allowed: svg, png, pdf, html", format));
  const std::size_t start = svg.find("<svg");
  if (start == std::string::npos) throw std::invalid_argument("not an SVG drawing");
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{}</title>\n"
      "<style>body {{ margin: 1em; font-family: sans-serif; }} svg {{ max-width: 100%; height: auto; }}</style>\n"
      "</head>\n<body>\n{}</body>\n</html>\n",
      html_escaped(clean_title(title)), svg.substr(start));
}

void require_drawing(const std::string& format) {
  run({"gnuplot", "--version"}, "", "gnuplot-nox");
  if (format == "png" || format == "pdf") run({"rsvg-convert", "--version"}, "", "librsvg2-bin");
}

std::string figure_format(const std::string& path) {
  for (const char* format : {"svg", "png", "pdf", "html"}) {
    if (path.ends_with(std::string(".") + format)) return format;
  }
  constexpr std::array<std::string_view, 4> known{"svg", "png", "pdf", "html"};
  const std::string extension = std::filesystem::path(path).extension().string();
  const std::string near = extension.empty() ? "" : nearest(extension.substr(1), known);
  throw std::invalid_argument(fmt::format("{}: unknown extension; {}a figure is written as .svg, .png, .pdf or .html",
                                          path, near.empty() ? "" : fmt::format("did you mean .{}? ", near)));
}

}  // namespace accdec
