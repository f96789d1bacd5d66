#include <algorithm>
#include <filesystem>

#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include <accdec/files.hpp>
#include <accdec/files/output_files.hpp>

namespace accdec {
namespace {

namespace fs = std::filesystem;

/// Folder and name of a file with links resolved; the file need not exist.
fs::path place_of(const std::string& path) {
  std::error_code code;
  const fs::path place = fs::weakly_canonical(fs::absolute(link_target(path), code), code);
  return code ? fs::path(path) : place;
}

bool direct(const std::string& path) {
  return is_standard_output(path) || is_special_file(path);
}

/// Whether standard output was redirected to this file, which then must not be replaced.
bool is_redirected_output(const std::string& path) {
  struct stat a {
  }, b{};
  return ::fstat(STDOUT_FILENO, &a) == 0 && S_ISREG(a.st_mode) && ::stat(path.c_str(), &b) == 0 &&
         a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

}  // namespace

bool same_file(const std::string& a, const std::string& b) {
  struct stat sa {
  }, sb{};
  const bool there_a = ::stat(a.c_str(), &sa) == 0, there_b = ::stat(b.c_str(), &sb) == 0;
  if (there_a && there_b) return sa.st_dev == sb.st_dev && sa.st_ino == sb.st_ino;
  return there_a == there_b && place_of(a) == place_of(b);
}

void write_file(const std::string& path, std::string_view content) {
  OutputFile file(path);
  file.write(content);
  file.commit();
}

void OutputFiles::add(const std::string& path, std::string content) {
  if (std::any_of(files_.begin(), files_.end(), [&](const auto& f) { return f.first == path; })) {
    throw OutputError(fmt::format("{}: is named for two outputs of one command", path));
  }
  files_.emplace_back(path, std::move(content));
}

void OutputFiles::commit() {
  // Files first, because output to a pipe cannot be undone.
  std::stable_partition(files_.begin(), files_.end(), [](const auto& f) { return !direct(f.first); });
  std::vector<OutputFile> written;
  for (const auto& [path, content] : files_) {
    if (direct(path)) break;
    written.emplace_back(path).write(content);
    written.back().close();
  }
  for (OutputFile& file : written) file.commit();
  for (const auto& [path, content] : files_) {
    if (direct(path)) write_file(path, content);
  }
  files_.clear();
}

void require_outputs(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs) {
  for (const std::string& input : inputs) {
    if (!input.empty() && is_redirected_output(input))
      throw OutputError(fmt::format("{}: is an input, and standard output goes there; write to another file", input));
  }
  std::vector<std::string> seen;
  bool standard_output = false;
  for (const std::string& path : outputs) {
    if (path.empty()) continue;
    if (is_standard_output(path)) {
      if (standard_output) throw OutputError("standard output is named for two outputs of one command");
      standard_output = true;
      continue;
    }
    for (const std::string& input : inputs) {
      if (!input.empty() && !is_special_file(path) && same_file(path, input)) {
        throw OutputError(fmt::format("{}: is an input ({}); nothing was written. Write to another file", path, input));
      }
    }
    if (is_special_file(path)) {
      if (::access(path.c_str(), W_OK) != 0) OutputFile refused(path);
      continue;
    }
    if (is_redirected_output(path))
      throw OutputError(fmt::format("{}: standard output goes there already; write to another file", path));
    for (const std::string& other : seen) {
      if (same_file(path, other)) throw OutputError(fmt::format("{}: is named for two outputs of one command", path));
    }
    seen.push_back(path);
    OutputFile probe(path);  // made and removed again
  }
}

}  // namespace accdec
