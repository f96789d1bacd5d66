#include <algorithm>
#include <array>
#include <cctype>

#include <fmt/format.h>

#include <accdec/gcode/dialects.hpp>

namespace accdec {
namespace {

struct ForeignCode {
  std::string_view word, beside;  ///< `beside`: only with this word on the line
  std::string_view whose, meaning;
};

constexpr std::string_view by_post_processor = "let the post-processor write moves without it";

constexpr std::array codes{
    ForeignCode{"G5.1", "Q", "FANUC", "switches look-ahead (AI contour control): leave it out"},
    ForeignCode{"G5", "P10000", "FANUC", "switches high-speed machining: leave it out"},
    ForeignCode{"G8", "P", "FANUC", "switches look-ahead: leave it out (LinuxCNC's G8 takes X as a radius)"},
    ForeignCode{"G4", "X", "FANUC", "dwells by X: write P, in seconds"},
    ForeignCode{"G9", "", "FANUC", "stops exactly in one block: write G61.1 before it and G64 behind it"},
    ForeignCode{"G12", "", "Mach and Haas", "mills a circular pocket: write its arcs"},
    ForeignCode{"G13", "", "Mach and Haas", "mills a circular pocket: write its arcs"},
    ForeignCode{"G12.1", "", "FANUC", "interpolates in polar coordinates"},
    ForeignCode{"G7.1", "", "FANUC", "interpolates on a cylinder"},
    ForeignCode{"G15", "", "FANUC and Mach", "ends polar coordinates"},
    ForeignCode{"G16", "", "FANUC and Mach", "starts polar coordinates; LinuxCNC writes them @ and ^"},
    ForeignCode{"G30", "G17", "HEIDENHAIN ISO", "describes the blank: leave it out"},
    ForeignCode{"G31", "G90", "HEIDENHAIN ISO", "describes the blank: leave it out"},
    ForeignCode{"G31", "", "FANUC and Mach", "moves until a probe touches: such moves cannot be planned by time"},
    ForeignCode{"G50", "", "FANUC and Mach", "ends scaling, or sets a lathe's coordinates or highest speed"},
    ForeignCode{"G51", "", "FANUC and Mach", "scales or mirrors"},
    ForeignCode{"G60", "", "FANUC", "approaches from one side"},
    ForeignCode{"G62", "", "FANUC", "lowers the feed in inner corners: leave it out"},
    ForeignCode{"G65", "", "FANUC", "calls a macro; LinuxCNC writes O100 call [..]"},
    ForeignCode{"G66", "", "FANUC", "calls a macro in every block; LinuxCNC writes O100 call [..]"},
    ForeignCode{"G67", "", "FANUC", "ends calls of a macro"},
    ForeignCode{"G68", "", "FANUC, HEIDENHAIN and Mach",
                "turns the coordinates; LinuxCNC writes G10 L2 P1 R and the angle"},
    ForeignCode{"G68.2", "", "FANUC", "tilts the plane"},
    ForeignCode{"G69", "", "FANUC, HEIDENHAIN and Mach", "ends the turning of coordinates"},
    ForeignCode{"G43.4", "", "FANUC", "leads the tool's tip over five axes"},
    ForeignCode{"G73", "K", "FANUC", "repeats the cycle K times: write L"},
    ForeignCode{"G81", "K", "FANUC", "repeats the cycle K times: write L"},
    ForeignCode{"G82", "K", "FANUC", "repeats the cycle K times: write L"},
    ForeignCode{"G83", "K", "FANUC", "repeats the cycle K times: write L"},
    ForeignCode{"G85", "K", "FANUC", "repeats the cycle K times: write L"},
    ForeignCode{"G79", "", "HEIDENHAIN ISO", "calls a cycle"},
    ForeignCode{"G150", "", "Haas", "mills a pocket"},
    ForeignCode{"M97", "", "Haas", "calls lines of the program; LinuxCNC writes O100 call"},
    ForeignCode{"M82", "", "Marlin and Klipper", "takes E as absolute: printers' programs have an axis E"},
    ForeignCode{"M83", "", "Marlin and Klipper", "takes E as relative: printers' programs have an axis E"},
    ForeignCode{"M84", "", "Marlin and Klipper", "switches motors off: leave it out"},
    ForeignCode{"M104", "", "Marlin and Klipper", "sets a temperature: leave it out"},
    ForeignCode{"M106", "", "Marlin and Klipper", "switches a fan: leave it out"},
    ForeignCode{"M107", "", "Marlin and Klipper", "switches a fan: leave it out"},
    ForeignCode{"M109", "", "Marlin and Klipper", "waits for a temperature: leave it out"},
    ForeignCode{"M140", "", "Marlin and Klipper", "sets a temperature: leave it out"},
    ForeignCode{"M190", "", "Marlin and Klipper", "waits for a temperature: leave it out"},
};

constexpr std::array statements{
    ForeignCode{"IF[", "", "FANUC", "branches; LinuxCNC writes O100 if [..] and O100 endif"},
    ForeignCode{"WHILE[", "", "FANUC", "repeats; LinuxCNC writes O100 while [..] and O100 endwhile"},
    ForeignCode{"GOTO", "", "FANUC", "jumps; LinuxCNC has no jumps"},
    ForeignCode{"SETVN", "", "FANUC", "names parameters; LinuxCNC writes #<name>"},
    ForeignCode{",R", "", "FANUC", "rounds a corner: write the arc"},
    ForeignCode{",C", "", "FANUC", "chamfers a corner: write the line"},
    ForeignCode{"G98L", "", "HEIDENHAIN ISO", "begins a subroutine; LinuxCNC writes O100 sub and O100 endsub"},
    ForeignCode{"Q200=", "", "HEIDENHAIN ISO", "defines a cycle"},
    ForeignCode{"D00Q", "", "HEIDENHAIN ISO", "sets a parameter; LinuxCNC writes #1 = 5"},
    ForeignCode{"BEGINPGM", "", "HEIDENHAIN's own language", "begins a program: have it written in ISO"},
    ForeignCode{"TOOLCALL", "", "HEIDENHAIN's own language", "calls a tool: have it written in ISO"},
    ForeignCode{"DR+", "", "HEIDENHAIN's own language", "turns along an arc: have it written in ISO"},
    ForeignCode{"DR-", "", "HEIDENHAIN's own language", "turns along an arc: have it written in ISO"},
    ForeignCode{"$", "", "GRBL", "sets or asks the control: leave the line out"},
};

/// In capitals, without blanks, comments and leading zeros of codes: G05 is G5.
std::string bare(std::string_view line) {
  std::string words;
  bool comment = false;
  for (const char c : line) {
    if (c == ';' && !comment) break;
    comment = comment || c == '(';
    if (!comment && std::isspace(static_cast<unsigned char>(c)) == 0) {
      const bool digit = std::isdigit(static_cast<unsigned char>(c)) != 0;
      if (digit && (words.ends_with("G0") || words.ends_with("M0"))) words.pop_back();
      words += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    }
    comment = comment && c != ')';
  }
  return words;
}

/// The place of a code as a whole word; npos if nowhere.
std::size_t find_word(std::string_view line, std::string_view word) {
  for (std::size_t at = line.find(word); at != line.npos; at = line.find(word, at + 1)) {
    const std::string_view next = line.substr(at + word.size(), 1);
    const bool open = std::isdigit(static_cast<unsigned char>(word.back())) != 0;
    if (!open || next.empty() || next.find_first_of("0123456789.") == next.npos) return at;
  }
  return line.npos;
}

std::string told(const ForeignCode& code) {
  const std::string_view advice =
      code.meaning.find_first_of(":;") == std::string_view::npos ? by_post_processor : std::string_view();
  return fmt::format("in the dialect of {} {} {}{}{}", code.whose, code.word, code.meaning, advice.empty() ? "" : ": ",
                     advice);
}

/// L X+10 in a line without its number. Other controls want a number behind L.
bool is_line_of_heidenhain(std::string_view words) {
  return words.starts_with('L') && words.find_first_of("XYZABCUVWI", 1) == 1;
}

}  // namespace

std::string foreign_words(std::string_view line) {
  const std::string words = bare(line);
  // Neither a name in brackets, #<if>, nor what follows an O word is a statement.
  const std::size_t first = std::min(words.find_first_not_of("N0123456789"), words.size());
  if (words.find('<') == words.npos && !words.substr(first).starts_with('O')) {
    for (const ForeignCode& statement : statements) {
      if (words.find(statement.word) != words.npos) return told(statement);
    }
  }
  if (is_line_of_heidenhain(std::string_view(words).substr(first)))
    return told({"L", "", "HEIDENHAIN's own language", "moves along a line: have it written in ISO"});
  for (const ForeignCode& code : codes) {
    const std::size_t at = find_word(words, code.word);
    if (at != words.npos && (code.beside.empty() || find_word(words, code.beside) != words.npos)) return told(code);
  }
  if (words.starts_with('%') && (words.find("G70") != words.npos || words.find("G71") != words.npos))
    return "in the dialect of HEIDENHAIN ISO % names the program: leave these lines, and the * at the ends of lines, "
           "out";
  return "";
}

}  // namespace accdec
