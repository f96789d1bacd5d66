#include <fmt/format.h>

#include <accdec/formats/export/exported_c.hpp>

namespace accdec {
namespace {

/// A string literal: bytes beyond printable ASCII as octal escapes, of three digits, so that what follows is no part.
std::string c_string(std::string_view text) {
  std::string literal = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\' || c == '?')  // ? as in trigraphs
      (literal += '\\') += c;
    else if (byte < 0x20 || byte >= 0x7F)
      literal += fmt::format("\\{:03o}", byte);
    else
      literal += c;
  }
  return literal + "\"";
}

}  // namespace

std::string c_head(const ExportedDesign& design, std::string_view guard, std::string_view what) {
  std::string text = fmt::format(
      "/* {}\n"
      "   The command of a corner's second leg starts accdec_delays[j] samples after that of the first has ended.\n",
      what);
  for (const std::string& fact : design.facts()) text += "   " + ascii_line(fact) + "\n";
  return text + fmt::format("*/\n#ifndef {0}\n#define {0}\n\n", guard) +
         fmt::format("#define ACCDEC_ORDER {}\n#define ACCDEC_SAMPLE_PERIOD_S {}\n\n", design.filter.order(),
                     real_literal(design.period));
}

std::string c_tail(const ExportedDesign& design) {
  std::string text;
  const auto& corners = design.result.corners;
  text += fmt::format("#define ACCDEC_CORNERS {}\n", corners.size());
  if (!corners.empty()) {
    std::string delays, names;
    for (const CornerResult& corner : corners) {
      const char* comma = &corner == &corners.back() ? "" : ",";
      delays += fmt::format("    {}{}\n", corner.delay, comma);
      names += fmt::format("    {}{}\n", c_string(corner.name), comma);
    }
    text += "static const int accdec_delays[ACCDEC_CORNERS] = {\n" + delays + "};\n";
    text += "static const char *const accdec_corner_names[ACCDEC_CORNERS] = {\n" + names + "};\n";
  }
  text += "static const char accdec_title[] = " + c_string(design.result.task.title) + ";\n";
  text += "static const char accdec_commit[] = " + c_string(design.commit) + ";\n";
  return text + "\n#endif\n";
}

std::string c_export(const ExportedDesign& design) {
  const Filter& filter = design.filter;
  std::string text = c_head(design, "ACCDEC_TAPS_H",
                            "Acc/Dec filter designed by accdec: v_out[k] = sum_i accdec_taps[i] * v_in[k - i]; the "
                            "taps sum to 1.");
  text += "static const double accdec_taps[ACCDEC_ORDER + 1] = {\n";
  for (int i = 0; i <= filter.order(); ++i)
    text += fmt::format("    {:.17e}{}\n", filter.tap(i), i == filter.order() ? "" : ",");
  double sum = 0.0;
  for (const double tap : filter.taps()) sum += tap;
  text += fmt::format("}};\n/* N + 1 = {} taps, their sum is {:.17g} */\n\n", filter.order() + 1, sum);
  return text + c_tail(design);
}

}  // namespace accdec
