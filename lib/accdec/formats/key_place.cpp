#include <optional>

#include <accdec/files/parse_toml.hpp>
#include <accdec/files/text_file.hpp>
#include <accdec/formats/key_place.hpp>

namespace accdec {
namespace {

void find_key(const toml::node& node, const std::string& key, std::optional<toml::source_position>& first) {
  if (const toml::array* const array = node.as_array()) {
    for (const toml::node& element : *array) find_key(element, key, first);
  }
  const toml::table* const table = node.as_table();
  if (table == nullptr) return;
  for (const auto& [name, value] : *table) {
    // A table's name begins before its contents, and an array of tables has the place of its first.
    const toml::source_position at = name.source().begin;
    if (name.str() == key && (!first || at.line < first->line)) first = at;
    find_key(value, key, first);
  }
}

}  // namespace

InputError error_at_key(const std::string& task, const RefusedKey& refused) {
  const toml::table tree = toml_input::parse_toml(read_text_file(task), task);
  for (const std::string& key : refused.keys()) {
    std::optional<toml::source_position> first;
    find_key(tree, key, first);
    if (first) return {task, static_cast<long>(first->line), static_cast<long>(first->column), refused.what()};
  }
  return {task, 0, 0, refused.what()};
}

}  // namespace accdec
