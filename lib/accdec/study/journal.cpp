#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <optional>
#include <sstream>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <fmt/format.h>

#include <accdec/study/journal.hpp>

namespace accdec::study {
namespace {

constexpr std::string_view magic = "accdec.study.journal/1 ";
constexpr std::string_view mark = "anew";  ///< the line with which a run begins anew

/// "INDEX SECONDS ROW"; a row is JSON and so has no line feed. Nothing if the line is not of this form.
std::optional<std::pair<std::size_t, Entry>> parse_line(std::string_view line) {
  std::size_t index = 0;
  Entry entry;
  const char* const end = line.data() + line.size();
  auto [after, failed] = std::from_chars(line.data(), end, index);
  if (failed != std::errc() || after == end || *after != ' ') return std::nullopt;
  const auto seconds = std::from_chars(after + 1, end, entry.seconds);
  if (seconds.ec != std::errc() || seconds.ptr == end || *seconds.ptr != ' ') return std::nullopt;
  entry.row.assign(seconds.ptr + 1, end);
  if (entry.row.empty() || entry.row.front() != '{' || entry.row.back() != '}') return std::nullopt;
  return std::pair(index, std::move(entry));
}

struct Content {
  std::map<std::size_t, Entry> entries;
  bool anew = false;
  std::size_t whole = 0;  ///< bytes up to the end of the last whole line
};

Content parse(const std::string& path, const std::string& text, const std::string& study) {
  Content content;
  const std::string header = fmt::format("{}{}\n", magic, study);
  // A header torn by a kill is the beginning of ours and of nothing else.
  if (text.size() < header.size() && header.starts_with(text)) return content;
  if (!text.starts_with(magic)) throw JournalError(fmt::format("{}: not a study's journal; it is left as it is", path));
  if (!text.starts_with(header))
    throw JournalError(fmt::format(
        "{}: the journal of another study, or of an earlier form of this one; choose another folder or delete this one",
        path));
  content.whole = header.size();
  while (true) {
    const std::size_t end = text.find('\n', content.whole);
    if (end == std::string::npos) return content;
    const std::string_view line = std::string_view(text).substr(content.whole, end - content.whole);
    if (line == mark) {
      content.entries.clear();
      content.anew = true;
    } else if (auto entry = parse_line(line)) {
      content.entries.insert_or_assign(entry->first, std::move(entry->second));
    } else {
      throw JournalError(fmt::format("{}: damaged at byte {}; it is left as it is", path, content.whole));
    }
    content.whole = end + 1;
  }
}

std::string read_all(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw JournalError(fmt::format("{}: cannot be read", path));
  std::ostringstream text;
  text << in.rdbuf();
  return std::move(text).str();
}

/// The children of a run that was killed hold its lock until they have died too, which is a moment later.
bool lock(int file) {
  for (int tries = 0; tries < 100; ++tries) {
    if (::flock(file, LOCK_EX | LOCK_NB) == 0) return true;
    if (errno != EWOULDBLOCK && errno != EINTR) return false;
    ::usleep(10000);
  }
  return false;
}

void write_all(int file, const std::string& path, std::string_view text) {
  while (!text.empty()) {
    const ssize_t n = ::write(file, text.data(), text.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) throw JournalError(fmt::format("{}: {}", path, std::strerror(errno)));
    text.remove_prefix(static_cast<std::size_t>(n));
  }
}

}  // namespace

Journal::Journal(std::string path, const std::string& study) : path_(std::move(path)) {
  file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_NOFOLLOW | O_CLOEXEC, 0644);
  if (file_ < 0) throw JournalError(fmt::format("{}: {}", path_, std::strerror(errno)));
  try {
    if (!lock(file_)) throw JournalError(fmt::format("{}: in use by another accdec study", path_));
    Content content = parse(path_, read_all(path_), study);
    if (::ftruncate(file_, static_cast<off_t>(content.whole)) != 0)
      throw JournalError(fmt::format("{}: {}", path_, std::strerror(errno)));
    if (content.whole == 0) write_all(file_, path_, fmt::format("{}{}\n", magic, study));
    entries_ = std::move(content.entries);
    anew_ = content.anew;
  } catch (...) {
    ::close(file_);
    throw;
  }
}

Journal::~Journal() {
  ::close(file_);
}

void Journal::append(std::size_t index, const Entry& entry) {
  write_all(file_, path_, fmt::format("{} {} {}\n", index, entry.seconds, entry.row));
}

void Journal::begin_anew() {
  write_all(file_, path_, fmt::format("{}\n", mark));
  entries_.clear();
  anew_ = true;
}

std::map<std::size_t, Entry> read_journal(const std::string& path, const std::string& study) {
  return parse(path, read_all(path), study).entries;
}

}  // namespace accdec::study
