#include <algorithm>
#include <filesystem>
#include <set>
#include <unordered_map>

#include <accdec/comparison/comparison_reuse.hpp>
#include <accdec/files/text_file.hpp>

namespace accdec {
namespace {

namespace fs = std::filesystem;
using batch::Row;

/// Puts lines at the places where the comparison has their keys.
class Places {
 public:
  Places(const comparison::Comparison& comparison, bool same_suite) : comparison_(comparison), same_suite_(same_suite) {
    for (std::size_t i = 0; i < comparison.size(); ++i) {
      if (std::string key = comparison.key(i); !key.empty()) place_.emplace(std::move(key), i);
    }
  }

  void take(batch::Entry entry) {
    Row row = Row::parse(entry.row, nullptr, false);
    if (!row.is_object()) return;
    const std::string record = row.value("record", "");
    if (record == "session") found.session = row;
    if (record != "problem" && record != "run") return;
    const std::string key = row.value("key", "");
    const auto index = row.find("index");
    if (key.empty()) {
      if (same_suite_ && index != row.end() && index->is_number_unsigned())
        found.entries[index->get<std::size_t>()] = std::move(entry);
      else
        found.unknown = true;
      return;
    }
    const auto place = place_.find(key);
    if (place == place_.end()) {
      if (set_aside_.insert(key).second) found.others.push_back(std::move(entry.row));
      return;
    }
    if (move_to(row, place->second)) entry.row = row.dump(-1, ' ', false, Row::error_handler_t::replace);
    found.entries[place->second] = std::move(entry);
  }

  EarlierEntries found;

 private:
  /// Names the row after its place. Returns whether that changes it.
  bool move_to(Row& row, std::size_t index) const {
    const comparison::ScheduledRun run = comparison_.at(index);
    const auto set = [&](const char* key, const Row& value) {
      if (row.value(key, Row()) == value) return false;
      row[key] = value;
      return true;
    };
    bool changed = set("index", index);
    changed |= set("case", run.case_index);
    if (!run.reference) changed |= set("solver", comparison_.settings().solvers[run.solver].name);
    return changed;
  }

  const comparison::Comparison& comparison_;
  bool same_suite_;
  std::unordered_map<std::string, std::size_t> place_;
  std::set<std::string> set_aside_;
};

}  // namespace

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::size_t from = 0;
  while (from < text.size()) {
    const std::size_t end = std::min(text.find('\n', from), text.size());
    if (end > from) lines.push_back(text.substr(from, end - from));
    from = end + 1;
  }
  return lines;
}

EarlierEntries earlier_entries(const std::string& folder, const comparison::Comparison& comparison, bool same_suite) {
  Places places(comparison, same_suite);
  for (const char* name : {comparison_earlier_name, comparison_raw_name}) {
    const fs::path path = fs::path(folder) / name;
    if (!fs::exists(path)) continue;
    for (std::string& line : lines_of(read_text_file(path.string(), result_file_limit)))
      places.take({0.0, std::move(line)});
  }
  // Journals of an interrupted run, and of runs interrupted before the suite was changed.
  std::vector<fs::path> journals;
  if (fs::is_directory(folder)) {
    for (const auto& item : fs::directory_iterator(folder)) {
      const std::string name = item.path().filename().string();
      if (name.starts_with(comparison_journal_name)) journals.push_back(item.path());
    }
  }
  std::sort(journals.begin(), journals.end());
  for (const fs::path& path : journals) {
    for (batch::Entry& entry : batch::read_any_journal(path.string())) places.take(std::move(entry));
  }
  return std::move(places.found);
}

comparison::Entries placed_entries(const comparison::Entries& entries, const comparison::Comparison& comparison) {
  Places places(comparison, true);
  for (const auto& [index, entry] : entries) places.take(entry);
  return std::move(places.found.entries);
}

}  // namespace accdec
