#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace accdec {

/// The lines of a file or of a text in memory, one after the other through one buffer: memory does not grow with the
/// file. The byte order mark that some editors put before UTF-8 is not part of the first line.
class LineSource {
 public:
  /// Longest line accepted, characters. Longer ones are an error, so that a file without line ends cannot fill the
  /// memory.
  static constexpr std::size_t line_max = 65536;

  /// @throws std::invalid_argument "file: reason" if it cannot be opened.
  explicit LineSource(const std::filesystem::path& file);
  /// @param text  kept by reference
  LineSource(std::string name, std::string_view text);

  /// Next line without its end (LF or CR LF); false after the last. The view holds until the next call.
  /// @throws ReadError on a line longer than `line_max` or a failing read.
  bool next(std::string_view& line) {
    const char* end = static_cast<const char*>(find_end());
    if (end == nullptr) return next_slow(line);
    take(line, end);
    position_ = end + 1;
    return true;
  }

  /// Makes next() return the line it returned last once more.
  void again() {
    position_ = start_of_last_;
    --line_number_;
  }

  /// Whether the text began with one, as far as it has been read.
  bool byte_order_mark() const { return mark_; }
  std::int64_t line_number() const { return line_number_; }
  const std::string& name() const { return name_; }
  /// @param column  from 1  @throws ReadError always
  [[noreturn]] void fail(std::size_t column, const std::string& message) const;

 private:
  struct Close {
    void operator()(std::FILE* f) const { std::fclose(f); }
  };

  const void* find_end() const;
  void take(std::string_view& line, const char* end) {
    start_of_last_ = position_;
    const char* last = end > position_ && end[-1] == '\r' ? end - 1 : end;
    line = std::string_view(position_, static_cast<std::size_t>(last - position_));
    ++line_number_;
    if (line.size() > line_max) too_long();
  }
  bool next_slow(std::string_view& line);
  void skip_byte_order_mark();
  [[noreturn]] void too_long() const;

  std::string name_;
  std::unique_ptr<std::FILE, Close> file_;
  std::vector<char> buffer_;
  const char* position_ = nullptr;
  const char* end_ = nullptr;
  const char* start_of_last_ = nullptr;
  std::int64_t line_number_ = 0;
  bool mark_ = false;
  bool started_ = false;  // reading the file
};

}  // namespace accdec
