#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace accdec::study {

/// A journal that cannot be used: of another study, in use by another process, unreadable, not writable.
class JournalError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// One finished point.
struct Entry {
  double seconds = 0.0;  ///< spent computing it; in a study's journal inside the computations alone
  std::string row;       ///< its line of rows.jsonl, without the line feed
};

/// An entry where it stands in its journal.
struct JournalLine {
  std::size_t index = 0;
  double seconds = 0.0;
  std::string_view row;
  std::uint64_t offset = 0;  ///< bytes from the file's beginning to the row's
};

/// What to do with a journal's lines in the order they were written.
struct JournalVisitor {
  std::function<void(const JournalLine&)> entry;
  std::function<void()> anew = [] {};  ///< all before is void
};

/// Append-only record of the points of a study that are done. Every entry is one line, written with one system call as
/// soon as it is there, so that whatever kills the process leaves whole lines and at most one torn one at the end,
/// which the next opening cuts off. The file is locked while open: two processes cannot append to the same one. A run
/// that computes all anew begins with a mark, and what stands before the last mark is void.
class Journal {
 public:
  /// Opens or creates. @param study  identifies what is computed (no line feeds); a journal begun for anything else is
  /// refused.
  /// @param visit  receives the entries found instead of `entries`, unless null: millions need not be held in memory
  /// @throws JournalError
  Journal(std::string path, const std::string& study, const JournalVisitor* visit = nullptr);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// Voids all entries, here and for whoever opens the journal later.
  /// @throws JournalError as append does
  void begin_anew();
  /// Whether the entries are of a run that began anew: then nothing older may stand in for the points they lack.
  bool anew() const { return anew_; }

  /// Entries found when opening, since the last mark.
  const std::map<std::size_t, Entry>& entries() const { return entries_; }
  /// Where the row stands in the file, bytes. @throws JournalError if the disk does not take it.
  std::uint64_t append(std::size_t index, const Entry& entry);

 private:
  void write(std::string_view text);

  std::string path_;
  int file_ = -1;
  std::uint64_t size_ = 0;
  bool anew_ = false;
  std::map<std::size_t, Entry> entries_;
};

/// The entries of a journal that another process wrote (a shard), without opening it for writing. A torn last line is
/// skipped.
/// @throws JournalError as the constructor does, and if the file does not exist.
std::map<std::size_t, Entry> read_journal(const std::string& path, const std::string& study);

/// The entries of a journal whatever it was begun for, in their order.
/// @throws JournalError if it is no journal, or cannot be read
std::vector<Entry> read_any_journal(const std::string& path);

/// Gives a journal that was begun for anything else a name of its own, PATH.1, PATH.2, .., so that one for `study` can
/// be begun; nothing if there is none, or it is this study's.
/// @throws JournalError if it is no journal, or another process uses it
void set_aside_other(const std::string& path, const std::string& study);
/// Passes through such a journal, holding no more than one line of it.
/// @return bytes up to the end of the last whole line
/// @throws JournalError as read_journal
std::uint64_t scan_journal(const std::string& path, const std::string& study, const JournalVisitor& visit);

/// Whether a process is appending to a journal now, as far as its file system tells. False if there is none.
bool journal_in_use(const std::string& path);

}  // namespace accdec::study
