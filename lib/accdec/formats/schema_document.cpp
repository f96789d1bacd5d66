#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <accdec/formats/schema_document.hpp>

namespace accdec {
namespace {

using Json = nlohmann::ordered_json;

Json members(const std::vector<Key>& keys, const std::string& conditions);

Json number(const Key& key, bool whole) {
  Json json{{"type", whole ? "integer" : "number"}};
  const auto bound = [&](double x) { return whole ? Json(std::llround(x)) : Json(x); };
  if (std::isfinite(key.range.low)) json[key.range.open_low ? "exclusiveMinimum" : "minimum"] = bound(key.range.low);
  if (std::isfinite(key.range.high)) json["maximum"] = bound(key.range.high);
  return json;
}

Json text(const Key& key) {
  Json json{{"type", "string"}};
  if (!key.empty_text) json["minLength"] = 1;
  return json;
}

/// A single value, or a list.
Json one_or_list(const Json& one, std::size_t least) {
  return {{"anyOf", {one, {{"type", "array"}, {"items", one}, {"minItems", least}}}}};
}

Json type_of(const Key& key) {
  switch (key.type) {
    case KeyType::number: return number(key, false);
    case KeyType::integer: return number(key, true);
    case KeyType::boolean: return {{"type", "boolean"}};
    case KeyType::text: return text(key);
    case KeyType::word: return {{"enum", key.words}};
    case KeyType::texts: return one_or_list({{"type", "string"}}, 1);
    case KeyType::words: return one_or_list({{"enum", key.words}}, key.least);
    case KeyType::numbers: {
      const Json one = number(key, key.whole);
      const Json pair{{"type", "array"}, {"items", one}, {"minItems", 2}, {"maxItems", 2}};
      Json list{{"type", "array"}, {"items", key.pairs ? pair : one}, {"minItems", key.least}};
      if (key.most > 0) list["maxItems"] = key.most;
      return key.lone ? Json{{"anyOf", {number(key, key.whole), list}}} : list;
    }
    case KeyType::table: return key.keys.empty() ? Json{{"type", "object"}} : members(key.keys, key.conditions);
    case KeyType::tables: return {{"type", "array"}, {"items", members(key.keys, key.conditions)}};
  }
  return Json::object();
}

/// The default if it is a value, not only words.
Json default_of(const Key& key) {
  if (const auto value = default_number(key))
    return key.type == KeyType::integer ? Json(std::lround(*value)) : Json(*value);
  if (key.type == KeyType::boolean) return key.fallback == "true";
  for (const std::string& word : key.words) {
    if (word == key.fallback) return word;
  }
  return nullptr;
}

Json property(const Key& key) {
  Json json = type_of(key);
  if (key.nullable) json = {{"anyOf", {json, {{"type", "null"}}}}};
  json["description"] = key.unit.empty() ? key.meaning : fmt::format("{}; {}", key.meaning, key.unit);
  if (const Json value = default_of(key); !value.is_null()) json["default"] = value;
  // The conditions of tables stand with their members.
  if (!key.conditions.empty() && key.keys.empty()) json.update(Json::parse(key.conditions));
  return json;
}

Json members(const std::vector<Key>& keys, const std::string& conditions) {
  Json json{{"type", "object"}, {"additionalProperties", false}};
  Json required = Json::array();
  for (const Key& key : keys) {
    json["properties"][key.name] = property(key);
    if (key.required) required.push_back(key.name);
  }
  if (!required.empty()) json["required"] = required;
  if (!conditions.empty()) json.update(Json::parse(conditions));
  return json;
}

/// "|" would end a cell.
std::string cell(const std::string& text) {
  std::string safe;
  for (const char c : text) safe += c == '|' ? "\\|" : std::string(1, c);
  return safe;
}

/// "0 < .. <= 180", "a list of 1 to 9 numbers", "`left`, `right`"
std::string allowed(const Key& key) {
  const auto range = [&] {
    const Range& r = key.range;
    if (!std::isfinite(r.low) && !std::isfinite(r.high)) return std::string("any");
    if (std::abs(r.low) >= 1e300 || std::abs(r.high) >= 1e300)
      return r.low <= -1e300 ? std::string("any") : fmt::format("{} {}", r.open_low ? ">" : ">=", r.low);
    if (!std::isfinite(r.high)) return fmt::format("{} {}", r.open_low ? ">" : ">=", r.low);
    return r.open_low ? fmt::format("{:g} < .. <= {:g}", r.low, r.high) : fmt::format("{:g} .. {:g}", r.low, r.high);
  };
  if (!key.allowed.empty()) return key.allowed.substr(key.allowed.find(' ', std::string("allowed ").size()) + 1);
  switch (key.type) {
    case KeyType::number: return range();
    case KeyType::integer: return "whole, " + range();
    case KeyType::numbers:
      if (key.pairs) return fmt::format("list of pairs of {}", range());
      return fmt::format("{}list{} of {}", key.lone ? "number or " : "", key.whole ? ", whole," : "", range());
    case KeyType::boolean: return "`true`, `false`";
    case KeyType::word: return fmt::format("`{}`", fmt::join(key.words, "`, `"));
    case KeyType::words: return fmt::format("one or a list of `{}`", fmt::join(key.words, "`, `"));
    case KeyType::texts: return "text or list";
    case KeyType::table: return key.keys.empty() ? "table" : "";
    case KeyType::tables: return "";
    default: return "text";
  }
}

void rows(std::string& out, const std::vector<Key>& keys, const std::string& table) {
  bool first = true;
  for (const Key& key : keys) {
    if (!key.keys.empty()) continue;
    const std::string holds = key.required ? "**needed**" : key.fallback;
    out += fmt::format("| {} | `{}` | {} | {} | {} | {} | {} |\n", first ? table : "", key.name, key.unit,
                       cell(allowed(key)), holds, cell(key.meaning),
                       key.example.empty() ? "" : "`" + cell(key.example) + "`");
    first = false;
  }
}

void tables(std::string& out, const std::vector<Key>& keys, const std::string& prefix) {
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const Key& key = keys[i];
    if (key.keys.empty()) continue;
    const std::string name = prefix + key.name;
    const std::string title = key.type == KeyType::table ? "`[" + name + "]`" : "`[[" + name + "]]`";
    out += fmt::format("| {} | | | | {} | {} | |\n", title, key.required ? "**needed**" : "", cell(key.meaning));
    // Tables with the same keys, as [filter] and [baseline], are described once.
    const auto same = std::find_if(keys.begin(), keys.begin() + static_cast<std::ptrdiff_t>(i),
                                   [&](const Key& other) { return names_of(other.keys) == names_of(key.keys); });
    if (key.free || same != keys.begin() + static_cast<std::ptrdiff_t>(i)) {
      out += fmt::format("| | as {} | | | | | |\n",
                         key.free ? "of `accdec schema " + key.name + "`" : fmt::format("`[{}]`", same->name));
      continue;
    }
    rows(out, key.keys, "");
    tables(out, key.keys, name + ".");
  }
}

}  // namespace

std::string json_schema(const FileKind& file) {
  Json json{{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", file.title}};
  json.update(members(file.keys, file.conditions));
  return json.dump(2) + "\n";
}

std::string key_table(const FileKind& file) {
  std::string out = "| table | key | unit | allowed | default | meaning | example |\n|---|---|---|---|---|---|---|\n";
  rows(out, file.keys, "top");
  tables(out, file.keys, "");
  return out;
}

}  // namespace accdec
