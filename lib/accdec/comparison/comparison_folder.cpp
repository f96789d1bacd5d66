#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/batch/journal.hpp>
#include <accdec/batch/shards.hpp>
#include <accdec/comparison/comparison_folder.hpp>
#include <accdec/comparison/comparison_report.hpp>
#include <accdec/comparison/comparison_reuse.hpp>
#include <accdec/comparison/comparison_schedule.hpp>
#include <accdec/files.hpp>
#include <accdec/files/output_files.hpp>
#include <accdec/files/results_folder.hpp>
#include <accdec/files/text_file.hpp>
#include <accdec/formats/manifest.hpp>

namespace accdec {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using batch::Row;
using comparison::Entries;

const ResultsKind kind{"accdec.comparison/1", "suite_hash", "suite"};
/// How the time of one session was spent.
struct Times {
  double solving = 0.0, evaluating = 0.0, judging = 0.0, references = 0.0;
  void add(const batch::Entry& entry) {
    const Row row = Row::parse(entry.row);
    const bool lost = comparison::lost(row.value("claim", ""));
    solving += lost ? entry.seconds : row.value("wall_time_s", 0.0);
    evaluating += row.value("evaluation_time_s", 0.0);
    judging += row.value("verification_time_s", 0.0);
    references += row.value("reference_time_s", 0.0);
  }
};

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text.append(line).append(1, '\n');
  return text;
}

/// Whether a folder with the results of another hash belongs to an earlier form of the suite. It does if it was made
/// from the same file, if some of its entries are usable, or if it has nothing to lose.
bool is_earlier_form(const fs::path& folder, const Suite& suite, const EarlierEntries& earlier) {
  if (earlier.unknown) return false;
  if (!earlier.entries.empty() || earlier.others.empty()) return true;
  const fs::path path = folder / "manifest.json";
  if (!fs::is_regular_file(path)) return false;
  const Row manifest = Row::parse(read_text_file(path.string()), nullptr, false);
  return manifest.is_object() && manifest.value("suite", Row()) == Row(suite.path);
}

/// @param others  lines that the suite no longer has a place for
void write_results(const Suite& suite, const std::vector<std::string>& lines, const std::vector<std::string>& others,
                   const Row& session, const ComparisonRunOptions& options) {
  const fs::path folder = options.out;
  OutputFiles files;
  if (!others.empty()) files.add((folder / comparison_earlier_name).string(), joined(others));
  files.add((folder / comparison_raw_name).string(), joined(lines));
  for (auto& [name, content] : comparison_documents(lines)) files.add((folder / name).string(), std::move(content));
  Row manifest;
  manifest["schema"] = kind.schema;
  manifest["suite"] = suite.path;
  manifest["title"] = suite.settings.title;
  manifest[kind.hash_key] = suite.hash;
  manifest["command"] = options.command;
  manifest["session"] = session;
  add_environment(manifest, options.version);
  files.add((folder / "manifest.json").string(), manifest.dump(2) + "\n");
  files.commit();
  if (others.empty()) fs::remove(folder / comparison_earlier_name);
}

/// Removes the journals: the results now hold all their lines.
void remove_journals(const fs::path& folder) {
  std::vector<fs::path> journals;
  for (const auto& item : fs::directory_iterator(folder)) {
    if (item.path().filename().string().starts_with(comparison_journal_name)) journals.push_back(item.path());
  }
  for (const fs::path& path : journals) fs::remove(path);
}

/// The entries missing in a merge: the problems' first numbers, and their shards if all journals have the same number
/// of shards.
std::string missing_text(const comparison::Comparison& comparison, const std::vector<std::size_t>& missing,
                         const std::vector<std::string>& folders) {
  std::set<std::size_t> counts, without;
  for (const std::string& folder : folders) {
    for (const auto& item : fs::directory_iterator(folder)) {
      const std::size_t count = batch::shard_count(item.path().filename().string());
      if (count > 0) counts.insert(count);
    }
  }
  std::string text = fmt::format("{} runs are missing from the shards; nothing was written", missing.size());
  if (counts.size() != 1) return text;
  const auto owners = batch::shard_owners(comparison.cases().size(), *counts.begin());
  for (const std::size_t i : missing) without.insert(owners[comparison.at(i).case_index]);
  return fmt::format("{}. Missing: shard {} of {}", text,
                     batch::ranges_text(std::vector<std::size_t>(without.begin(), without.end())), *counts.begin());
}

/// One call of run_comparison: reads what exists, computes the rest, writes the results.
class FolderRun {
 public:
  FolderRun(const Suite& suite, const ComparisonRunOptions& options)
      : suite_(suite),
        options_(options),
        folder_(options.out),
        whole_(options.shards == 1),
        comparison_(suite.settings, suite.cases),
        cases_(comparison::cases_of_shard(comparison_.cases().size(), options.shard, options.shards)) {
    const std::string identity = comparison::comparison_identity(comparison_, suite.hash);
    Entries merged = comparison::shard_entries(options.merge, identity);
    if (!options.merge.empty()) {
      const std::vector<std::size_t> missing = comparison::next_entries(comparison_, merged, cases_);
      if (!missing.empty()) throw OutputError(missing_text(comparison_, missing, options.merge));
    }
    if (whole_) earlier_ = earlier_entries(options.out, comparison_, results_hash(options.out, kind) == suite.hash);
    claim_results_folder(options.out, kind, suite.hash, whole_ && is_earlier_form(folder_, suite, earlier_));
    const std::string name = whole_ ? comparison_journal_name : batch::shard_journal(options.shard, options.shards);
    batch::set_aside_other((folder_ / name).string(), identity);
    journal_ = std::make_unique<batch::Journal>((folder_ / name).string(), identity);
    // A shard goes on from its own journal only. A program may have changed since the run was interrupted.
    entries_ = whole_ ? std::move(earlier_.entries) : placed_entries(journal_->entries(), comparison_);
    entries_.merge(std::move(merged));
    session_ = std::move(earlier_.session);
    header_ = comparison_.header();
    header_["suite_hash"] = suite.hash;
    summary_.problems = comparison_.cases().size();
    summary_.found = entries_.size();
    summary_.set_aside = earlier_.others.size();
    run_.workers = options.workers;
    run_.isolation = batch::Isolation::processes;
    run_.kill_after_of = [this](std::size_t i) { return comparison_.kill_after(i); };
    run_.fresh_children = true;
  }

  ComparisonSummary go() {
    batch::Progress progress{entries_.size(), comparison_.size(), 0.0};
    for (std::vector<std::size_t> next; !(next = comparison::next_entries(comparison_, entries_, cases_)).empty();) {
      progress.done = entries_.size();
      progress.total = entries_.size() + comparison::open_entries(comparison_, entries_, cases_, next);
      compute(next, progress);
    }
    summary_.wall_time = seconds_since(began_);
    summary_.runs = entries_.size() - static_cast<std::size_t>(std::count(cases_.begin(), cases_.end(), true));
    if (!whole_) return summary_;
    if (summary_.computed > 0) account();
    write();
    return summary_;
  }

 private:
  void compute(const std::vector<std::size_t>& indices, batch::Progress& progress) {
    batch::run_points(
        indices, [&](std::size_t i) { return comparison_.run(i).dump(-1, ' ', false, Row::error_handler_t::replace); },
        [&](std::size_t i, const std::string& why) { return comparison_.lost(i, why).dump(); },
        [&](std::size_t i, const batch::Entry& entry) {
          journal_->append(i, entry);
          times_.add(entry);
          entries_[i] = entry;
          ++summary_.computed;
          ++progress.done;
          progress.seconds = seconds_since(began_);
          if (options_.progress) options_.progress(progress);
        },
        run_);
  }

  /// Records how this session's time was spent.
  void account() {
    const double all = summary_.wall_time * batch::workers_of(run_);
    summary_.bookkeeping = 1.0 - (times_.solving + times_.judging + times_.references) / all;
    session_ = Row();
    session_["record"] = "session";
    session_["workers"] = batch::workers_of(run_);
    Row environment;
    add_environment(environment, options_.version);
    session_["machine"] = environment["machine"];
    session_["entries"] = summary_.computed;
    session_["wall_time_s"] = summary_.wall_time;
    session_["solving_s"] = times_.solving;
    session_["evaluating_s"] = times_.evaluating;
    session_["judging_s"] = times_.judging;
    session_["references_s"] = times_.references;
    session_["bookkeeping_share"] = summary_.bookkeeping;
  }

  void write() {
    std::vector<std::string> lines{header_.dump()};
    for (const auto& [index, entry] : entries_) lines.push_back(entry.row);
    if (!session_.is_null()) lines.push_back(session_.dump());
    const comparison::ComparisonData data = comparison::read_comparison(lines);
    summary_.contradictions = data.contradictions.size();
    summary_.table = summary_text(data);
    write_results(suite_, lines, earlier_.others, session_, options_);
    remove_journals(folder_);
    journal_.reset();
    summary_.finished = true;
  }

  Clock::time_point began_ = Clock::now();
  const Suite& suite_;
  const ComparisonRunOptions& options_;
  fs::path folder_;
  bool whole_;
  comparison::Comparison comparison_;
  std::vector<bool> cases_;
  EarlierEntries earlier_;
  std::unique_ptr<batch::Journal> journal_;
  Entries entries_;
  Row session_, header_;
  batch::RunOptions run_;
  Times times_;
  ComparisonSummary summary_;
};

}  // namespace

void claim_comparison_folder(const Suite& suite, const std::string& folder) {
  claim_results_folder(folder, kind, suite.hash);
}

bool comparison_finished(const Suite& suite, const std::string& folder) {
  return results_hash(folder, kind) == suite.hash && fs::exists(fs::path(folder) / comparison_raw_name);
}

ComparisonSummary run_comparison(const Suite& suite, const ComparisonRunOptions& options) try {
  return FolderRun(suite, options).go();
} catch (const batch::JournalError& error) {
  throw OutputError(error.what());
} catch (const fs::filesystem_error& error) {
  throw OutputError(error.what());
}

std::size_t redraw_comparison(const std::string& folder) {
  const fs::path path = fs::path(folder) / comparison_raw_name;
  if (!fs::is_regular_file(path)) {
    if (fs::exists(path.string() + ".xz"))
      throw OutputError(
          fmt::format("{0}: its raw data are packed; unpack them with xz -dk {0}/{1}.xz", folder, comparison_raw_name));
    const bool begun = fs::exists(fs::path(folder) / comparison_journal_name);
    throw OutputError(
        fmt::format("{}: no raw data ({}) to draw from{}", folder, comparison_raw_name,
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
