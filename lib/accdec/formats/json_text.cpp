#include <algorithm>

#include <fmt/format.h>

#include <accdec/files/json_position.hpp>
#include <accdec/formats/json_text.hpp>

namespace accdec {
namespace {

using Json = nlohmann::ordered_json;

/// "/corners/0/name" as "corners[0].name".
std::string readable(const std::string& pointer) {
  std::string text;
  for (std::size_t at = 1; at <= pointer.size() && !pointer.empty();) {
    const std::size_t end = std::min(pointer.find('/', at), pointer.size());
    const std::string step = pointer.substr(at, end - at);
    const bool index =
        !step.empty() && std::all_of(step.begin(), step.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (index)
      text += "[" + step + "]";
    else
      text += (text.empty() ? "" : ".") + step;
    at = end + 1;
  }
  return text.empty() ? "the result" : text;
}

}  // namespace

Json parse_json_text(std::string_view text, const std::string& name) {
  // The parser takes it as the end of the file and ignores the rest.
  if (const std::size_t zero = text.find('\0'); zero != std::string_view::npos) {
    const auto [line, column] = line_and_column(text, zero);
    throw InputError(name, line, column, "a zero byte; a result is text");
  }
  Json json;
  try {
    json = Json::parse(text.begin(), text.end());
  } catch (const Json::parse_error& error) {
    const auto [line, column] = line_and_column(text, error.byte > 0 ? error.byte - 1 : 0);
    // "[json.exception.parse_error.101] parse error at line 3, column 5: syntax error while ..." without its own head.
    std::string message = error.what();
    if (const auto head = message.find(": "); head != std::string::npos) message.erase(0, head + 2);
    throw InputError(name, line, column, "not valid JSON: " + message);
  } catch (const Json::out_of_range& error) {
    throw InputError(name, 1, 1,
                     fmt::format("a number is beyond double precision ({}); all must be finite", error.what()));
  }
  if (const auto at = json_too_deep(text)) {
    const auto [line, column] = line_and_column(text, *at);
    throw InputError(name, line, column, "brackets nest more than 64 deep; no result does");
  }
  if (const auto at = duplicate_key(text)) {
    const auto [line, column] = line_and_column(text, *at);
    throw InputError(name, line, column, "this key stands twice in its object; each may stand once");
  }
  return json;
}

InputError at_its_place(const InputError& error, std::string_view text, const std::string& name) {
  const auto [line, column] = line_and_column(text, locate(text, error.pointer()));
  return {name, line, column, fmt::format("{}: {}", readable(error.pointer()), error.message()), error.pointer()};
}

}  // namespace accdec
