#include "terminal.hpp"

#include <cstdlib>
#include <string_view>

#include <unistd.h>

#include <fmt/format.h>

namespace accdec::cli {

bool is_terminal(std::FILE* stream) {
  const char* term = std::getenv("TERM");
  return ::isatty(::fileno(stream)) != 0 && term != nullptr && std::string_view(term) != "dumb";
}

bool is_coloured(std::FILE* stream) {
  const char* none = std::getenv("NO_COLOR");
  return is_terminal(stream) && (none == nullptr || *none == '\0');
}

std::string with_coloured_status(std::string text) {
  struct Colour {
    std::string_view word, code;
  };
  for (const Colour& colour :
       {Colour{"optimal", "32"}, Colour{"feasible", "33"}, Colour{"infeasible", "31"}, Colour{"failed", "31"}}) {
    const std::string line = fmt::format("status      {}", colour.word);
    // At the beginning or after the title.
    const std::size_t at = text.starts_with(line) ? 0 : text.find("\n" + line);
    if (at == std::string::npos) continue;
    const std::size_t word = text.find(colour.word, at + line.size() - colour.word.size());
    return text.replace(word, colour.word.size(), fmt::format("\x1b[1;{}m{}\x1b[0m", colour.code, colour.word));
  }
  return text;
}

}  // namespace accdec::cli
