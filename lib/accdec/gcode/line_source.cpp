#include <cerrno>
#include <cstring>

#include <accdec/gcode/read_error.hpp>
#include <accdec/simulate.hpp>

namespace accdec {
namespace {
constexpr std::size_t buffer_size = std::size_t{1} << 20;
}

LineSource::LineSource(const std::filesystem::path& file) : name_(file.string()), buffer_(buffer_size) {
  if (std::filesystem::is_directory(file)) throw std::invalid_argument(name_ + ": is a directory, not a program");
  file_.reset(std::fopen(file.c_str(), "rb"));
  if (!file_) throw std::invalid_argument(name_ + ": cannot be opened: " + std::strerror(errno));
  std::setvbuf(file_.get(), nullptr, _IONBF, 0);
  position_ = end_ = start_of_last_ = buffer_.data();
}

LineSource::LineSource(std::string name, std::string_view text)
    : name_(std::move(name)), position_(text.data()), end_(text.data() + text.size()), start_of_last_(position_) {
  skip_byte_order_mark();
}

void LineSource::skip_byte_order_mark() {
  constexpr std::string_view mark = "\xef\xbb\xbf";
  mark_ = std::string_view(position_, static_cast<std::size_t>(end_ - position_)).starts_with(mark);
  if (mark_) position_ += mark.size();
}

const void* LineSource::find_end() const {
  return position_ == end_ ? nullptr : std::memchr(position_, '\n', static_cast<std::size_t>(end_ - position_));
}

bool LineSource::next_slow(std::string_view& line) {
  while (file_) {
    const auto rest = static_cast<std::size_t>(end_ - position_);
    if (rest > line_max + 1) {
      ++line_number_;
      too_long();
    }
    std::memmove(buffer_.data(), position_, rest);
    const std::size_t got = std::fread(buffer_.data() + rest, 1, buffer_.size() - rest, file_.get());
    position_ = buffer_.data();
    end_ = position_ + rest + got;
    if (!started_) skip_byte_order_mark();
    started_ = true;
    if (got == 0) {
      if (std::ferror(file_.get()) != 0) fail(1, "cannot be read: " + std::string(std::strerror(errno)));
      file_.reset();
    } else if (const void* end = find_end()) {
      take(line, static_cast<const char*>(end));
      position_ = static_cast<const char*>(end) + 1;
      return true;
    }
  }
  if (position_ == end_) return false;
  take(line, end_);
  position_ = end_;
  return true;
}

void LineSource::too_long() const {
  fail(line_max + 1, "line longer than " + std::to_string(line_max) + " characters");
}

void LineSource::fail(std::size_t column, const std::string& message) const {
  throw ReadError(name_, line_number(), this->column(column), message);
}

}  // namespace accdec
