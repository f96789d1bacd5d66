#include <algorithm>
#include <deque>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <accdec/files/json_position.hpp>

namespace accdec {
namespace {

/// Walks over valid JSON; every function moves `at` past the text it read.
struct Walker {
  std::string_view text;
  std::size_t at = 0;

  char peek() {
    while (at < text.size() && std::string_view(" \t\r\n,:").find(text[at]) != std::string_view::npos) ++at;
    return at < text.size() ? text[at] : '\0';
  }
  std::string_view string() {
    const std::size_t begin = ++at;
    while (at < text.size() && text[at] != '"') at += text[at] == '\\' ? 2 : 1;
    const std::size_t end = std::min(at, text.size());
    ++at;
    return text.substr(begin, end - begin);
  }
  void skip_value() {
    int depth = 0;
    do {
      const char c = peek();
      if (c == '\0') return;
      if (c == '"') {
        string();
        continue;
      }
      if (c == '{' || c == '[') ++depth;
      if (c == '}' || c == ']') --depth;
      if (std::string_view("{}[]").find(c) != std::string_view::npos)
        ++at;
      else
        while (at < text.size() && std::string_view(" \t\r\n,:{}[]\"").find(text[at]) == std::string_view::npos) ++at;
    } while (depth > 0);
  }
  /// Moves from the start of a value to the start of its member or element; false if there is none.
  bool enter(std::string_view step) {
    const char kind = peek();
    if (kind != '{' && kind != '[') return false;
    ++at;
    for (std::size_t index = 0; peek() != '}' && peek() != ']' && peek() != '\0'; ++index) {
      const bool found = kind == '{' ? string() == step : std::to_string(index) == step;
      peek();
      if (found) return true;
      skip_value();
    }
    return false;
  }
};

using Keys = std::vector<std::pair<std::string_view, std::size_t>>;  // keys as in the file, and their offsets

/// The first key of one object, in the order of the file, that already stood in it.
std::optional<std::size_t> repeated(Keys& keys) {
  std::sort(keys.begin(), keys.end());
  std::optional<std::size_t> first;
  for (std::size_t i = 1; i < keys.size(); ++i) {
    if (keys[i].first == keys[i - 1].first) first = std::min(first.value_or(keys[i].second), keys[i].second);
  }
  return first;
}

}  // namespace

std::pair<long, long> line_and_column(std::string_view text, std::size_t offset) {
  const std::string_view before = text.substr(0, std::min(offset, text.size()));
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t newline = before.rfind('\n');
  return {line, static_cast<long>(newline == std::string_view::npos ? before.size() + 1 : before.size() - newline)};
}

std::size_t locate(std::string_view json, std::string_view pointer) {
  Walker walker{json};
  walker.peek();
  std::size_t found = walker.at;
  while (!pointer.empty()) {
    pointer.remove_prefix(1);
    const std::size_t slash = std::min(pointer.find('/'), pointer.size());
    if (!walker.enter(pointer.substr(0, slash))) break;
    found = walker.at;
    pointer.remove_prefix(slash);
  }
  return found;
}

std::optional<std::size_t> duplicate_key(std::string_view json) {
  Walker walker{json};
  std::vector<Keys> open;  // for every open bracket; lists have no keys
  std::vector<char> brackets;
  std::deque<std::string> decoded;  // keys written with escapes
  bool key = false;                 // whether the next string is one
  for (; walker.at < json.size();) {
    const char c = json[walker.at];
    if (c == '"') {
      const std::size_t at = walker.at;
      std::string_view name = walker.string();
      if (key && name.find('\\') != std::string_view::npos) {
        const auto text = nlohmann::json::parse(json.substr(at, walker.at - at), nullptr, false);
        if (text.is_string()) name = decoded.emplace_back(text.get<std::string>());
      }
      if (key) open.back().emplace_back(name, at);
      key = false;
      continue;
    }
    if (c == '{' || c == '[') {
      open.emplace_back();
      brackets.push_back(c);
    } else if ((c == '}' || c == ']') && !open.empty()) {
      if (const auto found = repeated(open.back())) return found;
      open.pop_back();
      brackets.pop_back();
    }
    if (c == '{' || c == ',') key = !brackets.empty() && brackets.back() == '{';
    ++walker.at;
  }
  return std::nullopt;
}

std::optional<std::size_t> json_too_deep(std::string_view text) {
  constexpr int deepest = 64;
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted) {
      if (c == '\\') ++i;
      quoted = c != '"';
    } else if (c == '"') {
      quoted = true;
    } else if (c == '[' || c == '{') {
      if (++depth > deepest) return i;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return std::nullopt;
}

}  // namespace accdec
