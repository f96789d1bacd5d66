#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <streambuf>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include <accdec/files.hpp>
#include <accdec/files/output_file.hpp>
#include <accdec/files/temporaries.hpp>

namespace accdec {
namespace {

/// A buffered stream to a file descriptor that remembers why a write failed, which a file stream does not.
class DescriptorBuffer : public std::streambuf {
 public:
  DescriptorBuffer() { setp(buffer_.data(), buffer_.data() + buffer_.size()); }
  void attach(int file) { file_ = file; }
  int error() const { return error_; }

 protected:
  int sync() override {
    const char* from = pbase();
    while (from < pptr() && error_ == 0) {
      const ssize_t written = ::write(file_, from, static_cast<std::size_t>(pptr() - from));
      if (written >= 0)
        from += written;
      else if (errno != EINTR)
        error_ = errno;
    }
    setp(buffer_.data(), buffer_.data() + buffer_.size());
    return error_ == 0 ? 0 : -1;
  }
  int_type overflow(int_type c) override {
    if (sync() != 0) return traits_type::eof();
    if (!traits_type::eq_int_type(c, traits_type::eof())) sputc(traits_type::to_char_type(c));
    return traits_type::not_eof(c);
  }

 private:
  std::array<char, 1 << 16> buffer_;
  int file_ = -1, error_ = 0;
};

/// A rename is on the disk once its folder is synced. Some file systems cannot do this and return an error, which is no
/// failure.
void sync_folder_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  const std::string folder = slash == std::string::npos ? "." : path.substr(0, slash + 1);
  const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return;
  ::fsync(file);
  ::close(file);
}

}  // namespace

struct OutputFile::State {
  std::string path, target, temporary;
  int file = -1;
  DescriptorBuffer buffer;
  std::ostream stream{&buffer};

  [[noreturn]] void fail(const char* what, int error) const {
    throw OutputError(fmt::format("{}: {}: {}", path == "-" ? "standard output" : path, what, std::strerror(error)));
  }
  ~State() {
    if (file >= 0 && file != STDOUT_FILENO) ::close(file);
    if (!temporary.empty()) remove_temporary(temporary);
  }
};

bool is_standard_output(const std::string& path) {
  return path == "-" || path == "/dev/stdout" || path == "/dev/fd/1" || path == "/proc/self/fd/1";
}

bool is_special_file(const std::string& path) {
  struct stat s {};
  return ::stat(path.c_str(), &s) == 0 && !S_ISREG(s.st_mode) && !S_ISDIR(s.st_mode);
}

std::string link_target(const std::string& path) {
  std::filesystem::path place = path;
  std::error_code code;
  // The system follows at most as many links in a row; more are a circle.
  for (int links = 0; links < 40 && std::filesystem::is_symlink(place, code); ++links) {
    place = place.parent_path() / std::filesystem::read_symlink(place, code);
  }
  return place.string();
}

OutputFile::OutputFile(const std::string& path) : state_(std::make_unique<State>()) {
  State& s = *state_;
  if (path.empty()) throw OutputError("the name of the file to write is empty");
  s.path = path;
  if (std::error_code code; std::filesystem::is_directory(path, code)) {
    throw OutputError(path + ": is a directory; give the path of a file");
  }
  if (is_standard_output(path)) {
    if (std::fflush(stdout) != 0) s.fail("cannot be written", errno);
    s.path = "-";
    s.file = STDOUT_FILENO;
  } else if (is_special_file(path)) {
    s.file = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  } else {
    s.target = link_target(path);
    if (std::error_code code; std::filesystem::is_symlink(s.target, code)) s.fail("cannot be written", ELOOP);
    s.file = open_temporary(s.target, s.temporary);
    if (s.file < 0) s.temporary.clear();
  }
  if (s.file < 0) s.fail("cannot be written", errno);
  s.buffer.attach(s.file);
}

OutputFile::OutputFile(OutputFile&&) noexcept = default;
OutputFile::~OutputFile() = default;

std::ostream& OutputFile::stream() {
  return state_->stream;
}

void OutputFile::write(std::string_view text) {
  state_->stream.write(text.data(), static_cast<std::streamsize>(text.size()));
}

void OutputFile::close() {
  State& s = *state_;
  if (s.file < 0) return;
  s.stream.flush();
  if (!s.stream) s.fail("cannot be written", s.buffer.error() != 0 ? s.buffer.error() : EIO);
  const int file = std::exchange(s.file, -1);
  if (file == STDOUT_FILENO) return;
  // File systems, pipes and devices without fsync return EINVAL. A full disk is reported here or above.
  if (::fsync(file) != 0 && errno != EINVAL && errno != EROFS) {
    const int error = errno;
    ::close(file);
    s.fail("cannot be flushed to the disk", error);
  }
  if (::close(file) != 0) s.fail("cannot be closed", errno);
}

void OutputFile::commit() {
  close();
  State& s = *state_;
  if (s.temporary.empty()) return;
  if (!rename_temporary(s.temporary, s.target)) s.fail("cannot be replaced", errno);
  s.temporary.clear();
  sync_folder_of(s.target);
}

}  // namespace accdec
