#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace accdec::batch {

/// A journal that cannot be used: of another study, in use by another process, unreadable, not writable.
class JournalError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// One finished point.
struct Entry {
  double seconds = 0.0;  ///< time spent computing it; in a study's journal the time inside the computations only
  std::string row;       ///< its line of rows.jsonl, without the line feed
};

/// An entry and its place in the journal.
struct JournalLine {
  std::size_t index = 0;
  double seconds = 0.0;
  std::string_view row;
  std::uint64_t offset = 0;  ///< bytes from the file's beginning to the row's
};

/// Functions called for a journal's lines in the order they were written.
struct JournalVisitor {
  std::function<void(const JournalLine&)> entry;
  std::function<void()> fresh = [] {};  ///< called at a mark: all entries before it are void
};

/// Append-only record of the finished points of a study. Every entry is one line, written at once with one system call.
/// After a kill, the file has whole lines and at most one cut-off line at its end. The next opening removes this line.
/// The file is locked while open: two processes cannot append to the same one. A fresh run, which computes all points
/// again, begins with a mark; entries before the last mark are void.
class Journal {
 public:
  /// Opens or creates. @param study  identifies what is computed (no line feeds); a journal of anything else is
  /// refused.
  /// @param visit  if not null, receives the entries found instead of `entries`: millions need not be in memory
  /// @throws JournalError
  Journal(std::string path, const std::string& study, const JournalVisitor* visit = nullptr);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// Makes all entries void, here and for every later opening of the journal.
  /// @throws JournalError as append does
  void begin_fresh();
  /// Whether the entries are of a fresh run: then older results must not replace missing points.
  bool fresh() const { return fresh_; }

  /// Entries found when opening, since the last mark.
  const std::map<std::size_t, Entry>& entries() const { return entries_; }
  /// Offset of the row in the file, bytes. @throws JournalError if the disk does not take it.
  std::uint64_t append(std::size_t index, const Entry& entry);

 private:
  void write(std::string_view text);

  std::string path_;
  int file_ = -1;
  std::uint64_t size_ = 0;
  bool fresh_ = false;
  std::map<std::size_t, Entry> entries_;
};

/// The entries of a journal that another process wrote (a shard), without opening it for writing. A cut-off last line
/// is skipped.
/// @throws JournalError as the constructor does, and if the file does not exist.
std::map<std::size_t, Entry> read_journal(const std::string& path, const std::string& study);

/// The entries of any journal, in their order.
/// @throws JournalError if it is no journal, or cannot be read
std::vector<Entry> read_any_journal(const std::string& path);

/// Renames a journal of anything else to PATH.1, PATH.2, .., so that one for `study` can be begun. Does nothing if
/// there is no journal, or if it belongs to this study.
/// @throws JournalError if it is no journal, or another process uses it
void set_aside_other(const std::string& path, const std::string& study);
/// Reads such a journal, with only one line of it in memory.
/// @return bytes up to the end of the last whole line
/// @throws JournalError as read_journal
std::uint64_t scan_journal(const std::string& path, const std::string& study, const JournalVisitor& visit);

/// Whether a process is appending to a journal now, as far as its file system tells. False if there is no journal.
bool journal_in_use(const std::string& path);

}  // namespace accdec::batch
