#include <fmt/format.h>

#include <accdec/formats/export/exported_design.hpp>

namespace accdec {
namespace {

constexpr std::string_view body =
    "IF Load OR NOT Filled THEN\n"
    "  FOR I := 0 TO Order DO History[I] := Command; END_FOR;\n"
    "  Filled := TRUE;\n"
    "END_IF;\n"
    "Newest := Newest + 1;\n"
    "IF Newest > Order THEN Newest := 0; END_IF;\n"
    "History[Newest] := Command;\n"
    "Sum := 0.0;\n"
    "FOR I := 0 TO Order DO\n"
    "  At := Newest - I;\n"
    "  IF At < 0 THEN At := At + Order + 1; END_IF;\n"
    "  (* Differences: at rest the output is exactly the command. *)\n"
    "  Sum := Sum + Taps[I] * (History[At] - Command);\n"
    "END_FOR;\n"
    "Filtered := Command + Sum;\n"
    "END_FUNCTION_BLOCK\n";

/// A single-byte string: bytes beyond printable ASCII, quotes, $ and the star of comments as $hh.
std::string st_string(std::string_view text) {
  std::string literal = "'";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte >= 0x7F || c == '\'' || c == '"' || c == '$' || c == '*')
      literal += fmt::format("${:02X}", byte);
    else
      literal += c;
  }
  return literal + "'";
}

template <class Value>
std::string st_list(std::size_t count, Value value) {
  std::string list;
  for (std::size_t i = 0; i < count; ++i) list += fmt::format("    {}{}\n", value(i), i + 1 == count ? "" : ",");
  return list;
}

}  // namespace

std::string structured_text_export(const ExportedDesign& design) {
  const auto taps = design.filter.taps();
  const auto& corners = design.result.corners;
  std::string text =
      "(* Acc/Dec filter designed by accdec, IEC 61131-3 Structured Text. Not run on a control by accdec's tests.\n"
      "   Call it once a sample with the commanded position or velocity of an axis, one instance an axis.\n"
      "   The command of a corner's second leg starts Delays[j] samples after that of the first has ended.\n";
  for (const std::string& fact : design.facts()) text += "   " + ascii_line(fact) + "\n";
  text += fmt::format(
      "*)\nFUNCTION_BLOCK AccDecFilter\n"
      "VAR_INPUT\n  Command : LREAL;\n  Load : BOOL; (* TRUE: the output follows the command at once *)\nEND_VAR\n"
      "VAR_OUTPUT\n  Filtered : LREAL;\nEND_VAR\n"
      "VAR CONSTANT\n  Order : DINT := {0};\n  SamplePeriod : LREAL := {1}; (* s *)\n"
      "  Title : STRING({2}) := {3};\n  Commit : STRING({4}) := {5};\n  Taps : ARRAY[0..{0}] OF LREAL := [\n",
      design.filter.order(), real_literal(design.period), std::max<std::size_t>(1, design.result.task.title.size()),
      st_string(design.result.task.title), design.commit.size(), st_string(design.commit));
  text += st_list(taps.size(), [&](std::size_t i) { return real_literal(taps[i]); }) + "  ];\n";
  if (!corners.empty()) {
    std::size_t longest = 1;
    for (const CornerResult& corner : corners) longest = std::max(longest, corner.name.size());
    text += fmt::format("  Delays : ARRAY[1..{}] OF DINT := [\n", corners.size());
    text += st_list(corners.size(), [&](std::size_t j) { return corners[j].delay; });
    text += fmt::format("  ];\n  Corners : ARRAY[1..{}] OF STRING({}) := [\n", corners.size(), longest);
    text += st_list(corners.size(), [&](std::size_t j) { return st_string(corners[j].name); }) + "  ];\n";
  }
  text += fmt::format(
      "END_VAR\nVAR\n  History : ARRAY[0..{}] OF LREAL;\n  Newest, At, I : DINT;\n  Filled : BOOL;\n"
      "  Sum : LREAL;\nEND_VAR\n",
      design.filter.order());
  return text + std::string(body);
}

}  // namespace accdec
