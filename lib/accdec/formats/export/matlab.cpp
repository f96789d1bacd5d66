#include <algorithm>

#include <fmt/format.h>

#include <accdec/formats/export/exported_design.hpp>

namespace accdec {
namespace {

/// A character array. Files of other encodings than ASCII are read in different ways, so other texts come as bytes.
std::string matlab_string(std::string_view text) {
  if (std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c < 0x7F; })) {
    std::string quoted = "'";
    for (const char c : text) {
      if (c == '\'') quoted += c;
      quoted += c;
    }
    return quoted + "'";
  }
  std::string bytes;
  for (const char c : text) bytes += fmt::format(" {}", static_cast<unsigned>(static_cast<unsigned char>(c)));
  return fmt::format("native2unicode(uint8([{}]), 'UTF-8')", bytes.substr(1));
}

}  // namespace

std::string matlab_export(const ExportedDesign& design) {
  std::string text =
      "% Acc/Dec filter designed by accdec, for MATLAB and Octave: v_out = filter(accdec.taps, 1, v_in)\n"
      "% The command of a corner's second leg starts accdec.delays(j) samples after that of the first has ended.\n";
  for (const std::string& fact : design.facts()) text += "% " + ascii_line(fact) + "\n";
  text += "accdec = struct();\n";
  text += fmt::format("accdec.title = {};\n", matlab_string(design.result.task.title));
  text += fmt::format("accdec.status = '{}';\n", to_string(design.result.status));
  text += fmt::format("accdec.commit = {};\n", matlab_string(design.commit));
  text += fmt::format("accdec.sample_period_s = {};\naccdec.taps = [\n", real_literal(design.period));
  for (const double tap : design.filter.taps()) text += fmt::format("  {}\n", real_literal(tap));
  text += "];\naccdec.delays = [\n";
  for (const CornerResult& corner : design.result.corners) text += fmt::format("  {}\n", corner.delay);
  text += "];\naccdec.corners = {\n";
  for (const CornerResult& corner : design.result.corners) text += fmt::format("  {}\n", matlab_string(corner.name));
  text += "};\n% kind, axis, corner, bound, unit, used part of the bound (NaN: not known)\naccdec.limits = {\n";
  for (const ExportedLimit& limit : design.limits)
    text += fmt::format("  '{}', {}, {}, {}, '{}', {}\n", limit.kind, matlab_string(limit.axis),
                        matlab_string(limit.corner), real_literal(limit.bound), limit.unit,
                        limit.used ? real_literal(*limit.used) : "NaN");
  return text + "};\n";
}

}  // namespace accdec
