#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <accdec/study/study_file.hpp>

namespace accdec {

/// A study's rows as columns of words and numbers, as far as figures and the summary need them. A number takes 8 bytes
/// and a word 4, so ten million rows are possible.
class StudyTable {
 public:
  /// Rows kept whole, for the page.
  static constexpr std::size_t rows_shown = 1000;

  explicit StudyTable(const Study& study);
  StudyTable(const StudyTable&) = delete;
  StudyTable& operator=(const StudyTable&) = delete;

  /// First line of the CSV.
  std::string csv_head() const;
  /// Takes the next row, a line of rows.jsonl, and returns its line of the CSV.
  std::string take(std::string_view line);

  std::size_t size() const { return size_; }
  /// NaN if a row has no number. @throws std::out_of_range for a column no figure asked for
  const std::vector<double>& numbers(const std::string& column) const { return numbers_.at(column); }
  /// As in the CSV, without quotes; empty for null, and for the numbers of a heat map.
  const std::string& text(const std::string& column, std::size_t row) const {
    const Words& words = texts_.at(column);
    return words.words[words.ids[row]];
  }
  /// Computations that the study's time limit ended early.
  std::size_t cut_off() const { return cut_off_; }
  const std::vector<std::string>& columns() const { return names_; }
  /// The first rows, at most `rows_shown`, as texts.
  const std::vector<std::vector<std::string>>& first_rows() const { return first_rows_; }

 private:
  struct Words {
    std::vector<std::uint32_t> ids;
    std::vector<std::string> words;
    std::unordered_map<std::string, std::uint32_t> known;
    void push(const std::string& text);
  };
  /// The values of a column go here.
  struct Column {
    std::vector<double>* numbers = nullptr;
    Words* words = nullptr;
    bool only_words = false, stop = false;
  };
  std::vector<std::string> names_;
  std::vector<Column> columns_;
  std::map<std::string, std::vector<double>> numbers_;
  std::map<std::string, Words> texts_;
  std::vector<std::vector<std::string>> first_rows_;
  std::size_t size_ = 0, cut_off_ = 0;
};

}  // namespace accdec
