#pragma once

#include <string>
#include <vector>

#include <accdec/task/result.hpp>

namespace accdec {

/// A table in plain text: columns as wide as they need, the first left-aligned, the others right unless `left` names
/// them.
class TextTable {
 public:
  explicit TextTable(std::vector<std::string> header) : header_(std::move(header)) {}
  /// @throws std::invalid_argument unless there is one cell a column.
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

/// A table of a result, in um, mm/s, ms and %.
struct ReportTable {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
};
/// One row a corner.
ReportTable corner_report(const DesignResult& result);
/// One row for the worst use of every limit, over all corners.
ReportTable limit_report(const DesignResult& result);

/// A result for people, in um, mm/s, ms and %: status, filter, cycle time, one line a corner, one line for the worst
/// use of every limit (over all corners). Everything else stands in the result file.
std::string result_text(const DesignResult& result);

/// That on standard output.
void print_result(const DesignResult& result);

}  // namespace accdec
