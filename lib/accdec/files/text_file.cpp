#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string_view>

#include <fmt/format.h>

#include <accdec/files.hpp>
#include <accdec/files/text_file.hpp>

namespace accdec {

std::string read_text_file(const std::string& path, std::size_t limit) {
  const auto fail = [&](const std::string& message) -> InputError { return {path, 0, 0, message}; };
  if (path.empty()) throw InputError("(no name)", 0, 0, "the file name is empty; give the path of a file");
  std::error_code code;
  const auto status = std::filesystem::status(path, code);
  if (status.type() == std::filesystem::file_type::not_found)
    throw fail("no such file; give the path of an existing file");
  if (std::filesystem::is_directory(status)) throw fail("is a directory; give the path of a file");
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!file) throw fail(fmt::format("cannot be opened for reading: {}", std::strerror(errno)));

  // Read in blocks. The file's size only saves copies, as pipes have none.
  std::string text;
  std::error_code no_size;
  if (const auto size = std::filesystem::file_size(path, no_size); !no_size)
    text.reserve(static_cast<std::size_t>(std::min<std::uintmax_t>(size, limit)) + 1);
  char block[1 << 16];
  while (const std::size_t got = std::fread(block, 1, sizeof block, file.get())) {
    if (text.size() + got > limit)
      throw fail(fmt::format("is larger than the {} MB allowed for such a file", limit >> 20));
    text.append(block, got);
  }
  if (std::ferror(file.get())) throw fail(fmt::format("cannot be read: {}", std::strerror(errno)));

  const std::string_view head = std::string_view(text).substr(0, 2);
  if (head == "\xFF\xFE" || head == "\xFE\xFF") throw fail("is UTF-16 text; save it as UTF-8");
  if (const std::size_t zero = text.find('\0'); zero != std::string::npos) {
    throw fail(fmt::format("is not a text file (zero byte at offset {}); UTF-8 text is expected", zero));
  }
  if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
  return text;
}

}  // namespace accdec
