#include <iterator>
#include <limits>
#include <set>

#include <fmt/format.h>

#include <accdec/files/csv_table.hpp>
#include <accdec/study/point_columns.hpp>
#include <accdec/study/study_table.hpp>

namespace accdec {
namespace {

std::string plain(const batch::Row& value) {
  if (value.is_null()) return "";
  return value.is_string() ? value.get<std::string>() : value.dump();
}

}  // namespace

void StudyTable::Words::push(const std::string& text) {
  const auto [found, added] = known.try_emplace(text, static_cast<std::uint32_t>(words.size()));
  if (added) words.push_back(text);
  ids.push_back(found->second);
}

StudyTable::StudyTable(const Study& study) : names_(study.columns()) {
  std::set<std::string> stops, words_only, conditions;
  texts_["point"];
  for (const std::string& name : study.computations) {
    numbers_[name + ".cycle_time_ms"];
    numbers_[name + ".error_um"];
    texts_[name + ".status"];
    stops.insert(name + ".stop");
  }
  for (const StudyFigure& f : study.figures) {
    for (const std::string& name : f.y) numbers_[name];
    for (const std::string& name : {f.x, f.z, f.family}) {
      if (!name.empty()) numbers_[name];
    }
    for (const std::string& name : {f.z, f.family}) {
      if (!name.empty()) texts_[name];
    }
    for (const auto& [name, value] : f.where) texts_[name], conditions.insert(name);
    words_only.insert(f.z);
    conditions.insert(f.family);
  }
  for (const std::string& name : names_) {
    const auto number = numbers_.find(name);
    const auto text = texts_.find(name);
    columns_.push_back({number == numbers_.end() ? nullptr : &number->second,
                        text == texts_.end() ? nullptr : &text->second,
                        words_only.contains(name) && !conditions.contains(name), stops.contains(name)});
  }
}

std::string StudyTable::csv_head() const {
  std::string line;
  for (const std::string& name : names_) line.append(line.empty() ? "" : ",").append(csv_field(name));
  return line + "\n";
}

std::string StudyTable::take(std::string_view line) {
  const batch::Row row = batch::Row::parse(line);
  std::string csv;
  std::vector<std::string> shown;
  auto next = row.begin();  // rows nearly always have their columns in this order
  for (std::size_t c = 0; c < names_.size(); ++c) {
    const auto found = next != row.end() && next.key() == names_[c] ? next : row.find(names_[c]);
    if (found != row.end()) next = std::next(found);
    const std::string text = found == row.end() ? "" : plain(*found);
    const bool number = found != row.end() && found->is_number();
    if (c > 0) csv += ',';
    csv += csv_field(text);
    const Column& column = columns_[c];
    if (column.numbers)
      column.numbers->push_back(number ? found->get<double>() : std::numeric_limits<double>::quiet_NaN());
    // Values of a heat map may all differ, so only its classes are kept as words.
    if (column.words) column.words->push(number && column.only_words ? "" : text);
    if (column.stop && text == to_string(StopReason::time_limit)) ++cut_off_;
    if (size_ < rows_shown) shown.push_back(text);
  }
  if (size_ < rows_shown) first_rows_.push_back(std::move(shown));
  ++size_;
  for (auto& [name, column] : numbers_)  // computed names, such as a Pareto figure's, are no columns
    column.resize(size_, std::numeric_limits<double>::quiet_NaN());
  for (auto& [name, column] : texts_) {
    if (column.ids.size() < size_) column.push("");
  }
  return csv + "\n";
}

}  // namespace accdec
