#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

// Internal to this folder: where the rows of a study stand.

namespace accdec::study {

/// The place of every point's row on the disk. It takes 16 bytes per point, so that millions of rows need not be in
/// memory. Rows are read through memory maps of their files, which may grow (a journal) but must not change.
class RowStore {
 public:
  /// @param points  number of points of the study
  explicit RowStore(std::size_t points) : places_(points) {}
  ~RowStore();
  RowStore(const RowStore&) = delete;
  RowStore& operator=(const RowStore&) = delete;

  /// Adds a file that holds rows. @return its number for `put`
  /// @throws JournalError if there are more than 65535
  std::size_t add_file(const std::string& path);
  /// Records a row of a point. Anything that is not a row of it is left out: the damaged points are computed again. A
  /// row replaces an earlier one, unless it says that the point was lost and the earlier one does not.
  void put(std::size_t index, std::size_t file, std::uint64_t offset, std::string_view row);
  /// Makes all recorded rows void, or all rows of one file.
  void clear() { places_.assign(places_.size(), {}); }
  void clear(std::size_t file);
  /// Makes rows of points void whose process died: its cause (memory, a signal) may be absent next time.
  void drop_lost();

  std::size_t size() const { return places_.size(); }
  bool has(std::size_t index) const { return places_[index].length > 0; }
  /// A point's line of rows.jsonl, valid until the next call. @throws JournalError if the file cannot be read
  std::string_view row(std::size_t index);

  std::size_t count() const;             ///< rows
  std::size_t count_lost() const;        ///< of these, points whose process died
  std::size_t count_unanswered() const;  ///< of these, rows without an answer to any computation (lost ones too)

 private:
  struct Place {
    std::uint64_t offset = 0;
    std::uint32_t length = 0;  ///< 0: none
    std::uint16_t file = 0;
    bool lost = false, answered = false;
  };
  struct File {
    std::string path;
    const char* data = nullptr;
    std::size_t mapped = 0;  ///< bytes
  };
  void map(File& file, std::size_t least);

  std::vector<Place> places_;
  std::vector<File> files_;
};

/// Whether a row says that the process computing its point died.
bool is_lost(std::string_view row);

}  // namespace accdec::study
