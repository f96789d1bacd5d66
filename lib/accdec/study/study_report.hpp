#pragma once

#include <string>
#include <utility>
#include <vector>

#include <accdec/plot/figure.hpp>
#include <accdec/study/study_file.hpp>

namespace accdec {

/// A study's rows as columns of text and numbers, as far as figures and the summary need them.
class StudyTable {
 public:
  /// @param lines  rows.jsonl, one string a row. Also writes the CSV, in the same pass.
  StudyTable(const Study& study, const std::vector<std::string>& lines);

  const std::string& csv() const { return csv_; }
  std::size_t size() const { return size_; }
  /// NaN where a row has no number. @throws std::out_of_range for a column no figure asked for
  const std::vector<double>& numbers(const std::string& column) const { return columns_.at(column).numbers; }
  /// As in the CSV, without quotes; empty for null.
  const std::vector<std::string>& texts(const std::string& column) const { return columns_.at(column).texts; }

 private:
  struct Column {
    std::vector<double> numbers;
    std::vector<std::string> texts;
  };
  std::map<std::string, Column> columns_;
  std::string csv_;
  std::size_t size_ = 0;
};

/// One figure of a study as something to draw.
Figure make_study_figure(const StudyFigure& figure, const StudyTable& table);

/// Every file of a finished study but its manifest: rows.jsonl, rows.csv, NAME.svg and NAME.png of each figure, and
/// report.html with the figures inside and nothing linked. A function of study and rows alone.
/// @param empty  receives the names of figures that have nothing to draw, unless null
/// @return file name and content
std::vector<std::pair<std::string, std::string>> study_documents(const Study& study,
                                                                 const std::vector<std::string>& lines,
                                                                 std::vector<std::string>* empty = nullptr);

}  // namespace accdec
