#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/comparison/comparison_folder.hpp>
#include <accdec/comparison/comparison_report.hpp>
#include <accdec/files/output_files.hpp>
#include <accdec/files/results_folder.hpp>
#include <accdec/files/seconds_since.hpp>
#include <accdec/files/text_file.hpp>
#include <accdec/formats/manifest.hpp>
#include <accdec/study/journal.hpp>

namespace accdec {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using study::Row;
using Entries = std::map<std::size_t, study::Entry>;

const ResultsKind kind{"accdec.comparison/1", "suite_hash", "suite"};
constexpr const char* raw_name = "raw.jsonl";

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

/// Entries of finished results, and the record of how their time was spent.
Entries finished_entries(const fs::path& folder, const std::string& hash, Row& session) {
  Entries entries;
  if (results_hash(folder.string(), kind) != hash || !fs::exists(folder / raw_name)) return entries;
  for (const std::string& line : lines_of(read_text_file((folder / raw_name).string(), result_file_limit))) {
    const Row row = Row::parse(line, nullptr, false);
    if (!row.is_object()) continue;
    if (const auto index = row.find("index"); index != row.end() && index->is_number_unsigned())
      entries[index->get<std::size_t>()] = {0.0, line};
    if (row.value("record", "") == "session") session = row;
  }
  return entries;
}

/// Where the time of one session went.
struct Times {
  double solving = 0.0, evaluating = 0.0, judging = 0.0, references = 0.0;
  void add(const study::Entry& entry) {
    const Row row = Row::parse(entry.row);
    const bool lost = row.value("claim", "") == "killed" || row.value("claim", "") == "crashed";
    solving += lost ? entry.seconds : row.value("wall_time_s", 0.0);
    evaluating += row.value("evaluation_time_s", 0.0);
    judging += row.value("verification_time_s", 0.0);
    references += row.value("reference_time_s", 0.0);
  }
};

void write_results(const Suite& suite, const std::vector<std::string>& lines, const Row& session,
                   const ComparisonRunOptions& options) {
  const fs::path folder = options.out;
  OutputFiles files;
  std::string raw;
  for (const std::string& line : lines) raw.append(line).append(1, '\n');
  files.add((folder / raw_name).string(), std::move(raw));
  for (auto& [name, content] : comparison_documents(lines)) files.add((folder / name).string(), std::move(content));
  Row manifest;
  manifest["schema"] = kind.schema;
  manifest["suite"] = suite.path;
  manifest["title"] = suite.settings.title;
  manifest[kind.hash_key] = suite.hash;
  manifest["command"] = options.command;
  manifest["session"] = session;
  add_environment(manifest, options.version);
  for (const auto& solver : solvers::registry()) {
    const std::string library = solver->library_version();
    manifest["libraries"][library.substr(0, library.find(' '))] = library.substr(library.find(' ') + 1);
  }
  files.add((folder / "manifest.json").string(), manifest.dump(2) + "\n");
  files.commit();
}

}  // namespace

ComparisonSummary run_comparison(const Suite& suite, const ComparisonRunOptions& options) try {
  const auto began = Clock::now();
  claim_results_folder(options.out, kind, suite.hash);
  const study::Comparison comparison(suite.settings, suite.cases);
  const fs::path folder = options.out;
  const std::string identity = fmt::format("comparison {} {}", suite.hash, comparison.size());
  auto journal = std::make_unique<study::Journal>((folder / "comparison.journal").string(), identity);
  Row session;
  Entries entries = journal->entries();
  entries.merge(finished_entries(folder, suite.hash, session));

  ComparisonSummary summary;
  summary.problems = comparison.cases().size();
  summary.found = entries.size();
  study::RunOptions run;
  run.workers = options.workers;
  run.isolation = study::Isolation::processes;
  run.kill_after_of = [&](std::size_t i) { return comparison.kill_after(i); };
  run.fresh_children = true;
  Times times;
  StudyProgress progress{entries.size(), comparison.size(), 0.0};
  const auto compute = [&](const std::vector<std::size_t>& indices) {
    study::run_points(
        indices, [&](std::size_t i) { return comparison.run(i).dump(-1, ' ', false, Row::error_handler_t::replace); },
        [&](std::size_t i, const std::string& why) { return comparison.lost(i, why).dump(); },
        [&](std::size_t i, const study::Entry& entry) {
          journal->append(i, entry);
          times.add(entry);
          entries[i] = entry;
          ++summary.computed;
          ++progress.done;
          progress.seconds = study::seconds_since(began);
          if (options.progress) options.progress(progress);
        },
        run);
  };
  const auto missing = [&](std::size_t from, std::size_t to, const auto& wanted) {
    std::vector<std::size_t> indices;
    for (std::size_t i = from; i < to; ++i) {
      if (entries.contains(i)) continue;
      if (wanted(i))
        indices.push_back(i);
      else
        ++progress.done;
    }
    return indices;
  };
  const auto always = [](std::size_t) { return true; };
  const std::size_t references = comparison.cases().size(), first = references + comparison.per_repeat();
  compute(missing(0, references, always));
  compute(missing(references, first, always));
  Row header = comparison.header();
  header["suite_hash"] = suite.hash;
  const auto raw_lines = [&] {
    std::vector<std::string> lines{header.dump()};
    for (const auto& [index, entry] : entries) lines.push_back(entry.row);
    return lines;
  };
  if (comparison.size() > first) {
    const study::ComparisonData so_far = study::read_comparison(raw_lines());
    compute(missing(first, comparison.size(), [&](std::size_t i) {
      const study::ScheduledRun entry = comparison.at(i);
      return so_far.worth_repeating(entry.case_index, entry.start, entry.solver);
    }));
  }
  summary.wall_time = study::seconds_since(began);
  summary.runs = entries.size() - references;

  if (summary.computed > 0) {
    const double all = summary.wall_time * study::workers_of(run);
    summary.bookkeeping = 1.0 - (times.solving + times.judging + times.references) / all;
    session = Row();
    session["record"] = "session";
    session["workers"] = study::workers_of(run);
    session["entries"] = summary.computed;
    session["wall_time_s"] = summary.wall_time;
    session["solving_s"] = times.solving;
    session["evaluating_s"] = times.evaluating;
    session["judging_s"] = times.judging;
    session["references_s"] = times.references;
    session["bookkeeping_share"] = summary.bookkeeping;
  }
  std::vector<std::string> lines = raw_lines();
  if (!session.is_null()) lines.push_back(session.dump());
  summary.contradictions = study::read_comparison(lines).contradictions.size();
  write_results(suite, lines, session, options);
  journal.reset();
  fs::remove(folder / "comparison.journal");
  return summary;
} catch (const study::JournalError& error) {
  throw OutputError(error.what());
} catch (const fs::filesystem_error& error) {
  throw OutputError(error.what());
}

std::size_t redraw_comparison(const std::string& folder) {
  const fs::path path = fs::path(folder) / raw_name;
  if (!fs::is_regular_file(path)) {
    const bool begun = fs::exists(fs::path(folder) / "comparison.journal");
    throw OutputError(
        fmt::format("{}: no raw data ({}) to draw from{}", folder, raw_name,
                    begun ? "; the comparison is not finished: run it again with --out and it goes on" : ""));
  }
  OutputFiles files;
  std::size_t count = 0;
  try {
    for (auto& [name, content] : comparison_documents(lines_of(read_text_file(path.string(), result_file_limit)))) {
      files.add((fs::path(folder) / name).string(), std::move(content));
      ++count;
    }
  } catch (const std::invalid_argument& error) {
    throw OutputError(fmt::format("{}: {}", path.string(), error.what()));
  }
  files.commit();
  return count;
}

}  // namespace accdec
