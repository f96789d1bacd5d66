#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <set>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <accdec/batch/journal.hpp>
#include <accdec/batch/shards.hpp>
#include <accdec/files.hpp>
#include <accdec/files/memory.hpp>
#include <accdec/files/output_files.hpp>
#include <accdec/files/results_folder.hpp>
#include <accdec/formats/manifest.hpp>
#include <accdec/study/row_store.hpp>
#include <accdec/study/study_folder.hpp>
#include <accdec/study/study_report.hpp>

namespace accdec {
namespace {

namespace fs = std::filesystem;
using study::RowStore;
using Clock = std::chrono::steady_clock;

const ResultsKind kind{"accdec.study/1", "study_hash", "study"};

/// Memory per point: 16 bytes for the place of its row, the lists of points to compute, and the data for figures. The
/// rows themselves stay on the disk.
constexpr double bytes_a_point = 200;

/// A row with the time of its computations in front, "0.25{...}", because a child returns only text.
std::string timed_row(const Study& study, std::size_t index) {
  double seconds = 0.0;
  std::string row = study.row(index, &seconds);
  return fmt::format("{}{}", seconds, row);
}

batch::Entry without_time(const batch::Entry& entry) {
  const std::size_t row = entry.row.find('{');
  // The row of a lost point has no time: it is not known how much of its time the computations took.
  return {row == 0 ? 0.0 : std::stod(entry.row.substr(0, row)), entry.row.substr(row)};
}

std::string identity(const Study& study) {
  return fmt::format("{} {}", study.hash(), study.points().size());
}

/// Records every row of a journal, under the number of its file.
batch::JournalVisitor noting(RowStore& rows, std::size_t file) {
  return {[&rows, file](const batch::JournalLine& line) { rows.put(line.index, file, line.offset, line.row); },
          [&rows] { rows.clear(); }};
}

/// Records the rows of finished results.
void note_finished(RowStore& rows, const fs::path& folder, const Study& study) {
  const fs::path path = folder / "rows.jsonl";
  if (results_hash(folder.string(), kind) != study.hash() || !fs::is_regular_file(path)) return;
  const std::size_t file = rows.add_file(path.string());
  std::ifstream in(path, std::ios::binary);
  std::string line;
  std::uint64_t at = 0;
  for (std::size_t i = 0; std::getline(in, line); ++i) {
    if (i < rows.size()) rows.put(i, file, at, line);
    at += line.size() + 1;
  }
}

/// @param summary  receives the wall time up to here, without the writing itself
void write_results(const Study& study, RowStore& rows, const StudyRunOptions& options, Clock::time_point began,
                   StudySummary& summary) {
  std::vector<OutputFile> files = write_study(study, rows, options.out, &summary.empty_figures);
  summary.wall_time = seconds_since(began);
  nlohmann::ordered_json manifest;
  manifest["schema"] = kind.schema;
  manifest["study"] = study.path;
  manifest["title"] = study.title;
  manifest["study_hash"] = study.hash();
  manifest["points"] = study.points().size();
  manifest["points_without_answer"] = summary.bad;
  manifest["command"] = options.command;
  manifest["last_run"] = {{"points_computed", summary.computed},  {"points_found", summary.found},
                          {"workers", summary.workers},           {"wall_time_s", summary.wall_time},
                          {"method_time_s", summary.method_time}, {"method_share", summary.method_share()}};
  add_environment(manifest, options.version);
  files.emplace_back((fs::path(options.out) / "manifest.json").string()).write(manifest.dump(2) + "\n");
  files.back().close();
  for (OutputFile& file : files) file.commit();
}

/// The number of shards of the journals of a merge; 0 unless they agree.
std::size_t common_count(const std::vector<std::string>& names) {
  std::set<std::size_t> counts;
  for (const std::string& name : names) counts.insert(batch::shard_count(name));
  return counts.size() == 1 ? *counts.begin() : 0;
}

/// The points missing in a merge, and their shards.
std::string missing_text(const RowStore& rows, std::size_t count) {
  std::size_t first = 0;
  while (rows.has(first)) ++first;
  std::string text = fmt::format("{} of {} points are missing from the shards, the first is {}; nothing was written",
                                 rows.size() - rows.count(), rows.size(), first);
  if (count < 2 || count > rows.size()) return text;
  std::vector<batch::ShardState> shards(count);
  const std::vector<std::uint32_t> owners = batch::shard_owners(rows.size(), count);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    batch::ShardState& shard = shards[owners[i] - 1];
    shard.number = owners[i];
    ++shard.points;
    shard.done += rows.has(i) ? 1 : 0;
  }
  return fmt::format("{}. Missing: shard {}", text, batch::incomplete_text(shards));
}

void collect_shards(const Study& study, const std::vector<std::string>& folders, RowStore& rows) {
  std::vector<std::string> names;
  for (const std::string& folder : folders) {
    if (!fs::is_directory(folder)) throw OutputError(fmt::format("{}: no folder to merge", folder));
    for (const auto& item : fs::directory_iterator(folder)) {
      if (item.path().extension() != ".journal") continue;
      names.push_back(item.path().filename().string());
      const std::size_t file = rows.add_file(item.path().string());
      batch::JournalVisitor visit = noting(rows, file);
      // A mark makes the earlier entries of this journal void, not those of other shards.
      visit.fresh = [&rows, file] { rows.clear(file); };
      batch::scan_journal(item.path().string(), identity(study), visit);
    }
  }
  if (rows.count() != rows.size()) throw std::invalid_argument(missing_text(rows, common_count(names)));
}

StudySummary merge(const Study& study, const StudyRunOptions& options, Clock::time_point began) {
  RowStore rows(study.points().size());
  collect_shards(study, options.merge, rows);
  StudySummary summary{.points = rows.size(),
                       .found = rows.size(),
                       .bad = rows.count_unanswered(),
                       .lost = rows.count_lost(),
                       .finished = true};
  claim_results_folder(options.out, kind, study.hash());
  write_results(study, rows, options, began, summary);
  return summary;
}

}  // namespace

void check_study_size(const Study& study, bool large) {
  const std::size_t size = study.points().size();
  if (size > largest_study || (size > large_study && !large)) {
    throw InputError(study.path, study.origin.line, study.origin.column,
                     fmt::format("the study has {} points, most by {}; {}", size, study.origin.what,
                                 size > largest_study ? fmt::format("allowed is up to {}", largest_study)
                                                      : fmt::format("more than {} need --large", large_study)));
  }
  if (const double bytes = bytes_a_point * static_cast<double>(size);
      size > large_study && bytes > available_memory()) {
    throw InputError(
        study.path, study.origin.line, study.origin.column,
        fmt::format("the results of {} points, most by {}, would take about {:.0f} GB of memory, {:.0f} GB "
                    "are there; nothing was computed",
                    size, study.origin.what, 1e-9 * bytes, 1e-9 * available_memory()));
  }
}

void claim_study_folder(const Study& study, const std::string& folder) {
  claim_results_folder(folder, kind, study.hash());
}

StudySummary run_study(const Study& study, const StudyRunOptions& options) try {
  const auto began = Clock::now();
  const std::size_t size = study.points().size();
  check_study_size(study, options.large);
  const std::vector<std::size_t> share = batch::shard(size, options.shard, options.shards);
  if (!options.merge.empty()) return merge(study, options, began);
  // A fresh run replaces all results in the folder, also those of an earlier form of the study.
  claim_results_folder(options.out, kind, study.hash(), options.fresh);

  const bool whole = options.shards == 1;
  const fs::path folder = options.out;
  const std::string journal_path =
      (folder / (whole ? "study.journal" : batch::shard_journal(options.shard, options.shards))).string();
  RowStore rows(size);
  if (whole) note_finished(rows, folder, study);
  const std::size_t file = rows.add_file(journal_path);
  const batch::JournalVisitor found = noting(rows, file);
  if (options.fresh) batch::set_aside_other(journal_path, identity(study));
  batch::Journal journal(journal_path, identity(study), &found);
  if (options.fresh) journal.begin_fresh();
  if (options.fresh) rows.clear();
  rows.drop_lost();

  std::vector<std::size_t> missing;
  for (const std::size_t i : share) {
    if (!rows.has(i)) missing.push_back(i);
  }
  StudySummary summary{.points = share.size(), .found = share.size() - missing.size(), .computed = missing.size()};
  batch::RunOptions run{options.workers, study.isolation, 0.0};
  // Twice the time limit of the design, and time for everything else.
  run.kill_after = 2.0 * study.design.time_limit + 30.0;
  summary.workers = std::min(batch::workers_of(run), std::max(1, static_cast<int>(missing.size())));
  batch::Progress progress{0, missing.size(), 0.0};
  batch::run_points(
      missing, [&](std::size_t i) { return timed_row(study, i); },
      [&](std::size_t i, const std::string& why) { return study.lost_row(i, why); },
      [&](std::size_t i, const batch::Entry& timed) {
        const batch::Entry entry = without_time(timed);
        rows.put(i, file, journal.append(i, entry), entry.row);
        summary.method_time += entry.seconds;
        ++progress.done;
        progress.seconds = seconds_since(began);
        if (options.progress) options.progress(progress);
      },
      run);
  summary.wall_time = seconds_since(began);
  summary.bad = rows.count_unanswered();
  summary.lost = rows.count_lost();
  if (!whole) return summary;
  write_results(study, rows, options, began, summary);
  // The rows are safe now. A kill just before this line only means that the journal is read again.
  fs::remove(journal_path);
  summary.finished = true;
  return summary;
} catch (const batch::JournalError& error) {
  throw OutputError(error.what());
} catch (const fs::filesystem_error& error) {
  throw OutputError(error.what());
}

std::vector<batch::ShardState> study_shards(const Study& study, const std::string& folder, std::size_t shards) try {
  const std::size_t size = study.points().size();
  std::vector<batch::ShardState> states(shards);
  std::vector<bool> done(size), lost(size);
  for (std::size_t s = 0; s < shards; ++s) {
    batch::ShardState& state = states[s];
    state.number = s + 1;
    state.points = size / shards + (s < size % shards ? 1 : 0);
    const std::string path = (fs::path(folder) / batch::shard_journal(s + 1, shards)).string();
    if (!fs::exists(path)) continue;
    state.in_use = batch::journal_in_use(path);
    std::vector<std::size_t> seen;
    batch::JournalVisitor visit;
    visit.entry = [&](const batch::JournalLine& line) {
      if (line.index >= size || done[line.index]) return;
      if (!lost[line.index]) seen.push_back(line.index);
      lost[line.index] = study::is_lost(line.row);
      done[line.index] = !lost[line.index];
      if (done[line.index]) state.seconds += line.seconds;
    };
    visit.fresh = [&] {
      for (const std::size_t i : seen) done[i] = lost[i] = false;
      seen.clear();
      state.seconds = 0.0;
    };
    batch::scan_journal(path, identity(study), visit);
    for (const std::size_t i : seen) done[i] ? ++state.done : ++state.lost;
  }
  return states;
} catch (const batch::JournalError& error) {
  throw OutputError(error.what());
}

bool study_finished(const Study& study, const std::string& folder) {
  return results_hash(folder, kind) == study.hash() && fs::exists(fs::path(folder) / "rows.jsonl");
}

}  // namespace accdec
