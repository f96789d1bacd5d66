#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <optional>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include <accdec/batch/journal.hpp>

namespace accdec::batch {
namespace {

constexpr std::string_view magic = "accdec.study.journal/1 ";
constexpr std::string_view mark = "anew";  ///< the line that marks a fresh run

/// "INDEX SECONDS ROW"; a row is JSON and so has no line feed. Empty if the line does not have this form.
std::optional<JournalLine> parse_line(std::string_view line) {
  JournalLine entry;
  const char* const end = line.data() + line.size();
  auto [after, failed] = std::from_chars(line.data(), end, entry.index);
  if (failed != std::errc() || after == end || *after != ' ') return std::nullopt;
  const auto seconds = std::from_chars(after + 1, end, entry.seconds);
  if (seconds.ec != std::errc() || seconds.ptr == end || *seconds.ptr != ' ') return std::nullopt;
  entry.row = std::string_view(seconds.ptr + 1, static_cast<std::size_t>(end - seconds.ptr - 1));
  entry.offset = static_cast<std::uint64_t>(entry.row.data() - line.data());
  if (entry.row.empty() || entry.row.front() != '{' || entry.row.back() != '}') return std::nullopt;
  return entry;
}

/// Collects entries; those before a mark are void.
JournalVisitor collect(std::map<std::size_t, Entry>& entries) {
  return {[&](const JournalLine& line) {
            entries.insert_or_assign(line.index, Entry{line.seconds, std::string(line.row)});
          },
          [&] { entries.clear(); }};
}

/// Whether an open file still has its name: a run that finishes removes its journal while others wait for the lock.
bool has_name(int file, const std::string& path) {
  struct stat open {
  }, named{};
  return ::fstat(file, &open) == 0 && ::stat(path.c_str(), &named) == 0 && open.st_dev == named.st_dev &&
         open.st_ino == named.st_ino;
}

/// The children of a killed run keep its lock until they have ended too, a moment later.
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

struct FirstLine {
  std::string text;
  bool whole = false;  ///< ends with a line feed
};

FirstLine first_line(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw JournalError(fmt::format("{}: cannot be read", path));
  FirstLine line;
  line.whole = std::getline(in, line.text) && !in.eof();
  return line;
}

}  // namespace

std::uint64_t scan_journal(const std::string& path, const std::string& study, const JournalVisitor& visit) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw JournalError(fmt::format("{}: cannot be read", path));
  const std::string header = fmt::format("{}{}", magic, study);
  std::string line;
  // A last line without a line feed was cut off by a kill.
  const auto whole = [&] { return std::getline(in, line) && !in.eof(); };
  if (!whole()) {
    // A cut-off header must be the beginning of our header.
    if (header.starts_with(line)) return 0;
    if (!line.starts_with(magic))
      throw JournalError(fmt::format("{}: not a study's journal; it is left as it is", path));
  }
  if (!line.starts_with(magic)) throw JournalError(fmt::format("{}: not a study's journal; it is left as it is", path));
  if (line != header)
    throw JournalError(fmt::format(
        "{}: the journal of another study, or of an earlier form of this one; choose another folder or delete this one",
        path));
  std::uint64_t at = header.size() + 1;
  while (whole()) {
    if (line == mark) {
      visit.fresh();
    } else if (auto entry = parse_line(line)) {
      entry->offset += at;
      visit.entry(*entry);
    } else {
      throw JournalError(fmt::format("{}: damaged at byte {}; it is left as it is", path, at));
    }
    at += line.size() + 1;
  }
  return at;
}

Journal::Journal(std::string path, const std::string& study, const JournalVisitor* visit) : path_(std::move(path)) {
  file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_NOFOLLOW | O_CLOEXEC, 0644);
  if (file_ < 0) throw JournalError(fmt::format("{}: {}", path_, std::strerror(errno)));
  try {
    if (!lock(file_)) throw JournalError(fmt::format("{}: in use by another accdec study", path_));
    if (!has_name(file_, path_))
      throw JournalError(fmt::format(
          "{}: was in use by another accdec study, which has just ended; run the same command again", path_));
    const JournalVisitor to = visit ? *visit : collect(entries_);
    size_ = scan_journal(path_, study, {to.entry, [&] {
                                          to.fresh();
                                          fresh_ = true;
                                        }});
    if (::ftruncate(file_, static_cast<off_t>(size_)) != 0)
      throw JournalError(fmt::format("{}: {}", path_, std::strerror(errno)));
    if (size_ == 0) write(fmt::format("{}{}\n", magic, study));
  } catch (...) {
    ::close(file_);
    throw;
  }
}

Journal::~Journal() {
  ::close(file_);
}

void Journal::write(std::string_view text) {
  write_all(file_, path_, text);
  size_ += text.size();
}

std::uint64_t Journal::append(std::size_t index, const Entry& entry) {
  const std::string before = fmt::format("{} {} ", index, entry.seconds);
  const std::uint64_t offset = size_ + before.size();
  write(fmt::format("{}{}\n", before, entry.row));
  return offset;
}

void Journal::begin_fresh() {
  write(fmt::format("{}\n", mark));
  entries_.clear();
  fresh_ = true;
}

std::vector<Entry> read_any_journal(const std::string& path) {
  std::vector<Entry> entries;
  const FirstLine header = first_line(path);
  // A cut-off header has no entries after it.
  if (!header.whole && magic.starts_with(header.text.substr(0, magic.size()))) return entries;
  if (!header.text.starts_with(magic))
    throw JournalError(fmt::format("{}: not a study's journal; it is left as it is", path));
  if (!header.whole) return entries;
  for (auto& [index, entry] : read_journal(path, header.text.substr(magic.size()))) entries.push_back(std::move(entry));
  return entries;
}

void set_aside_other(const std::string& path, const std::string& study) {
  const int file = ::open(path.c_str(), O_RDWR | O_NOFOLLOW | O_CLOEXEC);
  if (file < 0) return;
  // Closing the file releases the lock.
  struct Closing {
    int file;
    ~Closing() { ::close(file); }
  } closing{file};
  if (!lock(file)) throw JournalError(fmt::format("{}: in use by another accdec", path));
  const FirstLine found = first_line(path);
  const std::string header = fmt::format("{}{}", magic, study);
  if (found.whole ? found.text == header : header.starts_with(found.text)) return;
  if (!found.text.starts_with(magic))
    throw JournalError(fmt::format("{}: not a study's journal; it is left as it is", path));
  for (int number = 1;; ++number) {
    const std::string name = fmt::format("{}.{}", path, number);
    if (::renameat2(AT_FDCWD, path.c_str(), AT_FDCWD, name.c_str(), RENAME_NOREPLACE) == 0) return;
    if (errno != EEXIST) throw JournalError(fmt::format("{}: {}", name, std::strerror(errno)));
  }
}

std::map<std::size_t, Entry> read_journal(const std::string& path, const std::string& study) {
  std::map<std::size_t, Entry> entries;
  scan_journal(path, study, collect(entries));
  return entries;
}

bool journal_in_use(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC);
  if (file < 0) return false;
  const bool used = ::flock(file, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(file);
  return used;
}

}  // namespace accdec::batch
