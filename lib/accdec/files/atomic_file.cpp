#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include <fcntl.h>
#include <unistd.h>

#include <fmt/format.h>

#include <accdec/files/atomic_file.hpp>
#include <accdec/files/errors.hpp>

namespace accdec {
namespace {

OutputError failure(const std::string& path, const char* what, int error) {
  return OutputError(fmt::format("{}: {}: {}", path, what, std::strerror(error)));
}

std::string part_of(const std::string& path) {
  return path + ".part";
}

/// Pipes and devices (/dev/null, /dev/stdout) are written to; replacing them would be a disaster.
bool is_special(const std::string& path) {
  std::error_code code;
  const auto status = std::filesystem::status(path, code);
  return std::filesystem::exists(status) && !std::filesystem::is_regular_file(status) &&
         !std::filesystem::is_directory(status);
}

/// The file a symbolic link leads to, so that the link survives the rename.
std::string resolved(const std::string& path) {
  std::error_code code;
  if (!std::filesystem::is_symlink(path, code)) return path;
  const auto target = std::filesystem::weakly_canonical(path, code);
  return code ? path : target.string();
}

void write_special(const std::string& path, std::string_view content) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) throw failure(path, "cannot be written", errno);
  const bool written = std::fwrite(content.data(), 1, content.size(), file) == content.size();
  if ((std::fclose(file) != 0) | !written) throw failure(path, "cannot be written", errno);
}

/// Creates PATH.part with the content, on the disk. Leaves nothing behind when it throws.
void write_part(const std::string& path, std::string_view content) {
  if (path.empty()) throw OutputError("the name of the file to write is empty");
  if (std::error_code code; std::filesystem::is_directory(path, code)) {
    throw OutputError(path + ": is a directory, a file is to be written");
  }
  const std::string part = part_of(path);
  const int file = ::open(part.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0) throw failure(path, "cannot be written", errno);
  const auto give_up = [&](const char* what) {
    const int error = errno;
    ::close(file);
    ::unlink(part.c_str());
    throw failure(path, what, error);
  };
  while (!content.empty()) {
    const ssize_t written = ::write(file, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) give_up("cannot be written");
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  // File systems without fsync answer EINVAL; a full disk answers here or above.
  if (::fsync(file) != 0 && errno != EINVAL && errno != EROFS) give_up("cannot be flushed to the disk");
  if (::close(file) != 0) {
    const int error = errno;
    ::unlink(part.c_str());
    throw failure(path, "cannot be closed", error);
  }
}

void write_standard_output(std::string_view content) {
  if (std::fwrite(content.data(), 1, content.size(), stdout) != content.size() || std::fflush(stdout) != 0) {
    throw OutputError(fmt::format("standard output: cannot be written: {}", std::strerror(errno)));
  }
}

}  // namespace

void write_file(const std::string& path, std::string_view content) {
  OutputFiles files;
  files.add(path, std::string(content));
  files.commit();
}

void OutputFiles::add(const std::string& path, std::string content) {
  const std::string target = resolved(path);
  if (std::any_of(files_.begin(), files_.end(), [&](const auto& f) { return f.first == target; }))
    throw OutputError(fmt::format("{}: is named for two outputs of one command", path));
  files_.emplace_back(target, std::move(content));
}

void OutputFiles::commit() {
  std::vector<std::string> parts;
  const auto discard = [&] {
    for (const std::string& part : parts) ::unlink(part.c_str());
  };
  try {
    for (const auto& [path, content] : files_) {
      if (path == "-" || is_special(path)) continue;
      write_part(path, content);
      parts.push_back(part_of(path));
    }
    for (const auto& [path, content] : files_) {
      if (path == "-" || is_special(path)) continue;
      if (std::rename(part_of(path).c_str(), path.c_str()) != 0) throw failure(path, "cannot be replaced", errno);
      parts.erase(parts.begin());
    }
  } catch (...) {
    discard();
    throw;
  }
  for (const auto& [path, content] : files_) {
    if (path == "-")
      write_standard_output(content);
    else if (is_special(path))
      write_special(path, content);
  }
  files_.clear();
}

void require_writable(const std::string& path) {
  if (path == "-" || is_special(path)) return;
  write_part(resolved(path), "");
  ::unlink(part_of(resolved(path)).c_str());
}

}  // namespace accdec
