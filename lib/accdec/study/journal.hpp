#pragma once

#include <cstddef>
#include <map>
#include <stdexcept>
#include <string>

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

/// Append-only record of the points of a study that are done. Every entry is one line, written with one system call as
/// soon as it is there, so that whatever kills the process leaves whole lines and at most one torn one at the end,
/// which the next opening cuts off. The file is locked while open: two processes cannot append to the same one. A run
/// that computes all anew begins with a mark, and what stands before the last mark is void.
class Journal {
 public:
  /// Opens or creates. @param study  identifies what is computed (no line feeds); a journal begun for anything else is
  /// refused.
  /// @throws JournalError
  Journal(std::string path, const std::string& study);
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
  /// @throws JournalError if the disk does not take it.
  void append(std::size_t index, const Entry& entry);

 private:
  std::string path_;
  int file_ = -1;
  bool anew_ = false;
  std::map<std::size_t, Entry> entries_;
};

/// The entries of a journal that another process wrote (a shard), without opening it for writing. A torn last line is
/// skipped.
/// @throws JournalError as the constructor does, and if the file does not exist.
std::map<std::size_t, Entry> read_journal(const std::string& path, const std::string& study);

}  // namespace accdec::study
