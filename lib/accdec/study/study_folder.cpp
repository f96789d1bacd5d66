#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <numeric>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <accdec/files/output_files.hpp>
#include <accdec/files/results_folder.hpp>
#include <accdec/files/seconds_since.hpp>
#include <accdec/formats/manifest.hpp>
#include <accdec/study/journal.hpp>
#include <accdec/study/study_folder.hpp>
#include <accdec/study/study_report.hpp>

namespace accdec {
namespace {

namespace fs = std::filesystem;
using Entries = std::map<std::size_t, study::Entry>;
using Clock = std::chrono::steady_clock;

const ResultsKind kind{"accdec.study/1", "study_hash", "study"};

/// A row with the time its computations took in front, "0.25{...}": all that comes back from a child is text.
std::string timed_row(const Study& study, std::size_t index) {
  double seconds = 0.0;
  std::string row = study.row(index, &seconds);
  return fmt::format("{}{}", seconds, row);
}

study::Entry without_time(const study::Entry& entry) {
  const std::size_t row = entry.row.find('{');
  // The row of a point that was lost has none: nothing of what it took is known to be the computations'.
  return {row == 0 ? 0.0 : std::stod(entry.row.substr(0, row)), entry.row.substr(row)};
}

std::string identity(const Study& study) {
  return fmt::format("{} {}", study.hash(), study.plan().size());
}

/// Drops what is no row of this study: damage costs the points it hit, which are then computed anew.
void drop_damaged(Entries& entries, const Study& study) {
  std::erase_if(entries, [&](const auto& item) {
    const auto& [index, entry] = item;
    return index >= study.plan().size() || !entry.row.starts_with(fmt::format(R"({{"index":{},)", index)) ||
           !nlohmann::json::accept(entry.row);
  });
}

/// Whether the process that computed a point died: what killed it (memory, a signal) need not be there the next time.
bool lost(const study::Entry& entry) {
  return entry.row.find(R"("point":"lost")") != std::string::npos;
}

void drop_lost(Entries& entries) {
  std::erase_if(entries, [](const auto& item) { return lost(item.second); });
}

/// Rows of finished results.
Entries finished_rows(const fs::path& folder, const Study& study) {
  Entries entries;
  if (results_hash(folder.string(), kind) != study.hash()) return entries;
  std::ifstream in(folder / "rows.jsonl", std::ios::binary);
  std::string line;
  for (std::size_t i = 0; std::getline(in, line); ++i) entries[i] = {0.0, line};
  drop_damaged(entries, study);
  return entries;
}

/// @param summary  receives the wall time up to here but for the writing itself
void write_results(const Study& study, const Entries& entries, const StudyRunOptions& options, Clock::time_point began,
                   StudySummary& summary) {
  std::vector<std::string> lines;
  for (const auto& [index, entry] : entries) lines.push_back(entry.row);
  const fs::path folder = options.out;
  OutputFiles files;
  for (auto& [name, content] : study_documents(study, lines, &summary.empty_figures))
    files.add((folder / name).string(), std::move(content));
  summary.wall_time = study::seconds_since(began);
  nlohmann::ordered_json manifest;
  manifest["schema"] = kind.schema;
  manifest["study"] = study.path;
  manifest["title"] = study.title;
  manifest["study_hash"] = study.hash();
  manifest["points"] = study.plan().size();
  manifest["points_without_answer"] = summary.bad;
  manifest["command"] = options.command;
  manifest["last_run"] = {{"points_computed", summary.computed},  {"points_found", summary.found},
                          {"workers", summary.workers},           {"wall_time_s", summary.wall_time},
                          {"method_time_s", summary.method_time}, {"method_share", summary.method_share()}};
  add_environment(manifest, options.version);
  files.add((folder / "manifest.json").string(), manifest.dump(2) + "\n");
  files.commit();
}

std::size_t count_bad(const Entries& entries) {
  std::size_t bad = 0;
  for (const auto& [index, entry] : entries) bad += entry.row.find(R"("point":"ok")") == std::string::npos ? 1 : 0;
  return bad;
}

std::size_t count_lost(const Entries& entries) {
  return static_cast<std::size_t>(
      std::count_if(entries.begin(), entries.end(), [](const auto& item) { return lost(item.second); }));
}

Entries collect_shards(const Study& study, const std::vector<std::string>& folders) {
  Entries all, without;
  for (const std::string& folder : folders) {
    if (!fs::is_directory(folder)) throw OutputError(fmt::format("{}: no folder to merge", folder));
    for (const auto& item : fs::directory_iterator(folder)) {
      if (item.path().extension() != ".journal") continue;
      Entries part = study::read_journal(item.path().string(), identity(study));
      for (const auto& [index, entry] : part) {
        if (lost(entry)) without.emplace(index, entry);
      }
      drop_lost(part);
      all.merge(part);
    }
  }
  all.merge(without);  // points lost in one shard's folder may have been computed in another
  drop_damaged(all, study);
  if (all.size() != study.plan().size()) {
    std::size_t first = 0;
    while (all.contains(first)) ++first;
    throw std::invalid_argument(
        fmt::format("{} of {} points are missing from the shards, the first is {}; nothing was written",
                    study.plan().size() - all.size(), study.plan().size(), first));
  }
  return all;
}

StudySummary merge(const Study& study, const StudyRunOptions& options, Clock::time_point began) {
  const Entries all = collect_shards(study, options.merge);
  StudySummary summary{
      .points = all.size(), .found = all.size(), .bad = count_bad(all), .lost = count_lost(all), .finished = true};
  claim_results_folder(options.out, kind, study.hash());
  write_results(study, all, options, began, summary);
  return summary;
}

}  // namespace

StudySummary run_study(const Study& study, const StudyRunOptions& options) try {
  const auto began = Clock::now();
  const std::size_t size = study.plan().size();
  if (size > largest_study || (size > large_study && !options.large)) {
    throw InputError(study.path, study.origin.line, study.origin.column,
                     fmt::format("the study has {} points, most by {}; {}", size, study.origin.what,
                                 size > largest_study ? fmt::format("allowed is up to {}", largest_study)
                                                      : fmt::format("more than {} need --large", large_study)));
  }
  const std::vector<std::size_t> share = study::shard(size, options.shard, options.shards);
  if (!options.merge.empty()) return merge(study, options, began);
  claim_results_folder(options.out, kind, study.hash());

  const bool whole = options.shards == 1;
  const fs::path folder = options.out;
  const std::string journal_path =
      (folder / (whole ? "study.journal" : fmt::format("shard-{}-of-{}.journal", options.shard, options.shards)))
          .string();
  study::Journal journal(journal_path, identity(study));
  if (options.fresh) journal.begin_anew();
  Entries entries = journal.entries();
  drop_damaged(entries, study);
  if (whole && !journal.anew()) entries.merge(finished_rows(folder, study));
  drop_lost(entries);

  std::vector<std::size_t> missing;
  for (const std::size_t i : share) {
    if (!entries.contains(i)) missing.push_back(i);
  }
  StudySummary summary{.points = share.size(), .found = share.size() - missing.size(), .computed = missing.size()};
  study::RunOptions run{options.workers, study.isolation, 0.0};
  // Twice what the design may take by its own limit, and time for everything beside it.
  run.kill_after = 2.0 * study.design.time_limit + 30.0;
  summary.workers = std::min(study::workers_of(run), std::max(1, static_cast<int>(missing.size())));
  StudyProgress progress{0, missing.size(), 0.0};
  study::run_points(
      missing, [&](std::size_t i) { return timed_row(study, i); },
      [&](std::size_t i, const std::string& why) { return study.lost_row(i, why); },
      [&](std::size_t i, const study::Entry& timed) {
        const study::Entry entry = without_time(timed);
        journal.append(i, entry);
        summary.method_time += entry.seconds;
        entries[i] = entry;
        ++progress.done;
        progress.seconds = study::seconds_since(began);
        if (options.progress) options.progress(progress);
      },
      run);
  summary.wall_time = study::seconds_since(began);
  summary.bad = count_bad(entries);
  summary.lost = count_lost(entries);
  if (!whole) return summary;
  write_results(study, entries, options, began, summary);
  // The rows are safe now; a kill just before this line costs nothing but the reading of a journal that says the same.
  fs::remove(journal_path);
  summary.finished = true;
  return summary;
} catch (const study::JournalError& error) {
  throw OutputError(error.what());
} catch (const fs::filesystem_error& error) {
  throw OutputError(error.what());
}

}  // namespace accdec
