#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include <accdec/files/file_kind.hpp>

namespace accdec {
namespace {

struct Kind {
  std::string_view noun, takers;
  std::vector<std::string_view> words;  ///< every such file, and no other, has a line that begins with one of them
};

const Kind& kind_of(InputKind kind) {
  static const std::array<Kind, 5> kinds{{
      {"a task", "`accdec design`, `explain` and `evaluate` take", {"sample_period_ms", "[[corner]]", "[[axis]]"}},
      {"a study", "`accdec study` takes", {"compute", "[[vary]]"}},
      {"a suite", "`accdec compare` takes", {"[[problem]]", "[[hypercube]]"}},
      {"a result", "`accdec verify`, `plot` and `export` take", {}},
      {"a program", "`accdec program` and `accdec explore` take with --task TASK.toml", {}},
  }};
  return kinds[static_cast<std::size_t>(kind)];
}

/// Whether a line begins with a letter and a number, as blocks of RS-274 do.
bool begins_a_block(std::string_view line) {
  const auto is = [&](std::size_t i, std::string_view of) { return i < line.size() && of.find(line[i]) != of.npos; };
  return line == "%" || (is(0, "GMNOSTXYZFgmnostxyzf") && is(1, "0123456789.-"));
}

/// Calls visit with every line that is not blank, without blanks around it, until it returns true.
template <class Visit>
void each_line(std::string_view text, Visit visit) {
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    while (!line.empty() && std::isspace(static_cast<unsigned char>(line.front()))) line.remove_prefix(1);
    while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back()))) line.remove_suffix(1);
    if (!line.empty() && visit(line)) return;
  }
}

bool has_words_of(std::string_view text, InputKind kind) {
  bool found = false;
  if (kind == InputKind::result) {
    // The schema stands near the beginning.
    const std::string_view head = text.substr(0, 1000);
    return head.find("\"schema\"") != head.npos && head.find("\"accdec.") != head.npos;
  }
  each_line(text, [&](std::string_view line) {
    if (kind == InputKind::program) {
      if (line.front() == '(' || line.front() == ';') return false;
      found = begins_a_block(line);
      return true;
    }
    for (const std::string_view word : kind_of(kind).words) {
      if (!line.starts_with(word)) continue;
      const std::string_view rest = line.substr(word.size());
      found = found || rest.empty() || word.front() == '[' || std::string_view(" \t=").find(rest.front()) != rest.npos;
    }
    return found;
  });
  return found;
}

}  // namespace

std::string wrong_kind(std::string_view text, InputKind expected) {
  if (has_words_of(text, expected)) return "";
  const auto say = [&](const std::string& seems) {
    return fmt::format("{} is expected, this seems to be {}", kind_of(expected).noun, seems);
  };
  for (const InputKind kind :
       {InputKind::result, InputKind::task, InputKind::study, InputKind::suite, InputKind::program}) {
    if (kind == expected || !has_words_of(text, kind)) continue;
    return say(fmt::format("{}, which {}", kind_of(kind).noun, kind_of(kind).takers));
  }
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first != text.npos && text[first] == '<') return say("a page or a figure");
  return "";
}

}  // namespace accdec
