#include <cmath>
#include <limits>

#include <fmt/format.h>

#include <accdec/files/csv_table.hpp>
#include <accdec/study/compute.hpp>
#include <accdec/study/study_report.hpp>

namespace accdec {
namespace {

std::string plain(const study::Row& value) {
  if (value.is_null()) return "";
  return value.is_string() ? value.get<std::string>() : value.dump();
}

}  // namespace

StudyTable::StudyTable(const Study& study, const std::vector<std::string>& lines) : size_(lines.size()) {
  const std::vector<std::string> names = study.columns();
  for (const std::string& name : study.computations) {
    for (const char* column : {"status", "cycle_time_ms", "error_um", "message"})
      columns_[fmt::format("{}.{}", name, column)];
  }
  columns_["point"];
  for (const StudyFigure& f : study.figures) {
    for (const std::string& name : {f.x, f.z, f.family}) {
      if (!name.empty()) columns_[name];
    }
    for (const std::string& name : f.y) columns_[name];
    for (const auto& [name, value] : f.where) columns_[name];
  }
  for (std::size_t i = 0; i < names.size(); ++i) csv_.append(i > 0 ? "," : "").append(csv_field(names[i]));
  csv_ += "\n";
  for (const std::string& line : lines) {
    const study::Row row = study::Row::parse(line);
    bool first = true;
    for (const std::string& name : names) {
      const auto found = row.find(name);
      const std::string text = found == row.end() ? "" : plain(*found);
      if (!first) csv_ += ',';
      first = false;
      csv_ += csv_field(text);
      const auto wanted = columns_.find(name);
      if (wanted == columns_.end()) continue;
      wanted->second.texts.push_back(text);
      wanted->second.numbers.push_back(
          found != row.end() && found->is_number() ? found->get<double>() : std::numeric_limits<double>::quiet_NaN());
    }
    csv_ += '\n';
  }
  for (auto& [name, column] : columns_) {  // computed names such as a Pareto figure's, which are no columns
    column.numbers.resize(size_, std::numeric_limits<double>::quiet_NaN());
    column.texts.resize(size_);
  }
}

}  // namespace accdec
