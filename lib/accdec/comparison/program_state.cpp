#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <unistd.h>

#include <accdec/comparison/external_solver.hpp>
#include <accdec/formats/toml_file.hpp>

namespace accdec::comparison {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_files = 1000;  ///< of a folder

std::string hash_of_file(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return toml_input::hash_of(std::string{std::istreambuf_iterator<char>(in), {}});
}

/// Names and contents, without those that Python itself writes.
std::string hash_of_folder(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code ignored;
  fs::recursive_directory_iterator item(folder, fs::directory_options::skip_permission_denied, ignored);
  for (; item != fs::recursive_directory_iterator(); item.increment(ignored)) {
    if (item->path().filename() == "__pycache__") item.disable_recursion_pending();
    if (item->is_regular_file(ignored)) files.push_back(item->path());
  }
  std::sort(files.begin(), files.end());
  files.resize(std::min(files.size(), most_files));
  std::string state;
  for (const fs::path& file : files)
    state += file.lexically_relative(folder).string() + " " + hash_of_file(file) + "\n";
  return toml_input::hash_of(state);
}

/// Empty if the name is not one of a program or file.
std::string hash_of_name(const std::string& name) {
  std::error_code error;
  if (name.starts_with('/')) {
    if (fs::is_regular_file(name, error)) return hash_of_file(name);
    return fs::is_regular_file(fs::path(name) / "__main__.py", error) ? hash_of_folder(name) : "";
  }
  if (name.empty() || name.find('/') != std::string::npos) return "";
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const fs::path found = fs::path(folder) / name;
    if (fs::is_regular_file(found, error) && ::access(found.c_str(), X_OK) == 0) return hash_of_file(found);
  }
  return "";
}

/// The words of a command of the shell, and what stands in them behind each "=". Quotes group, and a backslash takes
/// the next character as it is.
std::vector<std::string> shell_names(const std::string& command) {
  std::vector<std::string> names{""};
  char quote = 0;
  for (std::size_t i = 0; i < command.size(); ++i) {
    const char c = command[i];
    if (c == '\\' && quote != '\'' && i + 1 < command.size())
      names.back() += command[++i];
    else if (quote ? c == quote : c == '\'' || c == '"')
      quote = quote ? '\0' : c;
    else if (!quote && std::string_view(" \t\n;|&<>()").find(c) != std::string_view::npos)
      names.emplace_back();
    else
      names.back() += c;
  }
  for (std::size_t n = 0, words = names.size(); n < words; ++n) {
    for (std::size_t at = names[n].find('='); at != std::string::npos; at = names[n].find('=', at + 1))
      names.push_back(names[n].substr(at + 1));
  }
  return names;
}

}  // namespace

std::string program_state(const External& external) {
  std::string state;
  const auto add = [&](const std::string& name) {
    const std::string hash = hash_of_name(name);
    if (!hash.empty()) state += (state.empty() ? "" : " ") + hash;
    return !hash.empty();
  };
  for (std::string word : command_words(
           external.command, {{external.reads, ""}, {"answer", ""}, {"seconds", ""}, {"suite", external.folder}})) {
    if (add(word)) continue;
    const std::vector<std::string> names = shell_names(word);
    for (char& c : word) {
      if (std::string_view("=,;:|&<>()'\"`\t\n").find(c) != std::string_view::npos) c = ' ';
    }
    std::istringstream parts(word);
    std::set<std::string> seen;
    for (std::string part; parts >> part;) add(part), seen.insert(part);
    for (const std::string& name : names) {
      if (seen.insert(name).second) add(name);
    }
  }
  return state;
}

}  // namespace accdec::comparison
