#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include <accdec/result.hpp>

namespace accdec {

/// A table in plain text with columns as wide as needed. The first column is left-aligned; the others are right-aligned
/// unless `left` names them.
class TextTable {
 public:
  explicit TextTable(std::vector<std::string> header) : header_(std::move(header)) {}
  /// @throws std::invalid_argument unless there is one cell per column.
  void add(std::vector<std::string> row);
  /// Aligns a column left. @param column from 0
  void left(std::size_t column) { left_.push_back(column); }
  bool empty() const { return rows_.empty(); }
  /// Lines, each ending with a line feed; cells two spaces apart, no trailing spaces.
  std::string str() const;

 private:
  std::vector<std::string> header_;
  std::vector<std::vector<std::string>> rows_;
  std::vector<std::size_t> left_{0};
};

/// Meanings of words in the heads of tables, a line each: N, d, cycle, corners, polyline, contour.
/// @throws std::invalid_argument for another word
std::string legend(std::initializer_list<std::string_view> words);

/// A table of a result, in um, mm/s, ms and %.
struct ReportTable {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
  std::string note{};  ///< to stand below it; may be empty
};
/// One row per corner.
ReportTable corner_report(const DesignResult& result);
/// One row for the worst use of every limit, over all corners. That of a force-speed curve has the force of its sample
/// and what the curve allows at that speed, where the result has both: `LimitUse` has them scaled to standstill.
ReportTable limit_report(const DesignResult& result);

}  // namespace accdec
