#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <system_error>

#include <accdec/files/stream_file.hpp>

namespace accdec {
namespace {

[[noreturn]] void fail(const std::string& path) {
  const int reason = errno;
  throw std::runtime_error(path + ": cannot be written: " + std::strerror(reason));
}

/// A pipe or device is written directly: a file of its name would not reach who listens.
bool is_special(const std::string& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  return std::filesystem::exists(status) && !std::filesystem::is_regular_file(status);
}

}  // namespace

StreamFile::~StreamFile() {
  if (part_.empty()) return;
  file_.close();
  std::remove(part_.c_str());
}

void StreamFile::open(const std::string& path) {
  path_ = path;
  if (path_ == "-") return;
  const bool special = is_special(path_);
  if (!special) part_ = path_ + ".part";
  file_.open(special ? path_ : part_, std::ios::binary | std::ios::trunc);
  if (!file_) {
    part_.clear();
    fail(path_);
  }
}

std::ostream& StreamFile::stream() {
  return path_ == "-" ? std::cout : file_;
}

void StreamFile::close() {
  if (path_.empty()) return;
  stream().flush();
  if (!stream()) fail(path_);
  if (path_ != "-") file_.close();
}

void StreamFile::commit() {
  if (part_.empty()) return;
  if (std::rename(part_.c_str(), path_.c_str()) != 0) fail(path_);
  part_.clear();
}

}  // namespace accdec
