#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

// Internal to the room: where the rows of a study stand.

namespace accdec::study {

/// Where the row of every point stands on the disk: 16 bytes a point, so that millions of rows need not be held in
/// memory. Rows are read through maps of their files, which may grow (a journal) but must not change.
class RowStore {
 public:
  /// @param points  of the study
  explicit RowStore(std::size_t points) : places_(points) {}
  ~RowStore();
  RowStore(const RowStore&) = delete;
  RowStore& operator=(const RowStore&) = delete;

  /// Names a file rows stand in. @return its number for `put`
  /// @throws JournalError if there are more than 65535
  std::size_t add_file(const std::string& path);
  /// Notes a row of a point. What is no row of it is left out: damage costs the points it hit, which are then computed
  /// anew. A row replaces an earlier one, unless it says that the point was lost and the earlier one does not.
  void put(std::size_t index, std::size_t file, std::uint64_t offset, std::string_view row);
  /// All that was put is void, or all that stands in one file.
  void clear() { places_.assign(places_.size(), {}); }
  void clear(std::size_t file);
  /// Rows of points whose process died are void: what killed it (memory, a signal) need not be there the next time.
  void drop_lost();

  std::size_t size() const { return places_.size(); }
  bool has(std::size_t index) const { return places_[index].length > 0; }
  /// Its line of rows.jsonl, valid until the next call. @throws JournalError if the file cannot be read
  std::string_view row(std::size_t index);

  std::size_t count() const;             ///< rows
  std::size_t count_lost() const;        ///< of them, of points whose process died
  std::size_t count_unanswered() const;  ///< of them, without an answer to any computation (lost ones too)

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
