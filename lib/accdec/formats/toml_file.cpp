#include <cstdint>
#include <filesystem>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/files.hpp>
#include <accdec/files/parse_toml.hpp>
#include <accdec/files/text_file.hpp>
#include <accdec/formats/task_edit.hpp>
#include <accdec/formats/toml_file.hpp>

namespace accdec::toml_input {

toml::table parse_file(const std::string& path, std::optional<InputKind> expected) {
  const std::string text = read_text_file(path);
  if (const std::string wrong = expected ? wrong_kind(text, *expected) : ""; !wrong.empty())
    throw InputError(path, 1, 1, wrong);
  return parse_toml(text, path);
}

std::vector<std::string> strings(const Table& table, const toml::table& raw, std::string_view key) {
  std::vector<std::string> words;
  if (!raw.contains(key)) return words;
  if (const auto word = raw[key].value<std::string>()) return {*word};
  const toml::array* list = raw[key].as_array();
  if (!list || list->empty())
    table.fail_at(key, fmt::format("`{}` must be a string or a list of strings, not empty", key));
  for (std::size_t i = 0; i < list->size(); ++i) {
    const auto word = list->get(i)->value<std::string>();
    if (!word) table.fail_at(key, i, fmt::format("`{}` must be a list of strings", key));
    words.push_back(*word);
  }
  return words;
}

toml::table parse_task_beside(const Table& table, std::string_view key, const std::string& given, std::string& path) {
  path = (std::filesystem::path(table.file()).parent_path() / given).lexically_normal().string();
  if (!std::filesystem::exists(path))
    table.fail_at(key, fmt::format("{} does not exist; paths are relative to the file that names them", path));
  return parse_file(path, InputKind::task);
}

void apply_settings(const toml::table& settings, const std::string& file, toml::table& task) {
  for (const auto& [key, value] : settings) {
    try {
      TaskKey(std::string(key.str())).set(task, value);
    } catch (const std::invalid_argument& error) {
      throw InputError(file, value.source().begin.line, value.source().begin.column, error.what());
    }
  }
}

std::string hash_of(std::string_view text) {
  std::uint64_t h = 14695981039346656037ULL;
  for (const char c : text) h = (h ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  return fmt::format("{:016x}", h);
}

}  // namespace accdec::toml_input
