#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include <accdec/batch/runner.hpp>
#include <accdec/comparison/suite_file.hpp>

namespace accdec {

struct ComparisonRunOptions {
  std::string out;                    ///< the results' folder
  int workers = 0;                    ///< runs at a time; 0: all cores
  std::size_t shard = 1, shards = 1;  ///< run only the problems of this part, without results
  std::vector<std::string> merge;     ///< folders of shards to merge; then nothing is solved
  std::string command, version;       ///< for the manifest
  std::function<void(const batch::Progress&)> progress;
};

struct ComparisonSummary {
  std::size_t problems = 0, runs = 0, found = 0, computed = 0;
  std::size_t set_aside = 0;  ///< entries of earlier forms of the suite, not used now: kept in earlier.jsonl
  std::size_t contradictions = 0;
  bool finished = false;  ///< the folder has the report; false for a shard
  std::string table;      ///< the outcome of each solver, in plain text
  double wall_time = 0.0,
         bookkeeping = 0.0;  ///< s, of this run; share of all workers' time that went into neither solving nor judging
};

/// Runs a comparison in a folder. Each run has its own process with a kill timer, and every line is journaled at once.
/// At the end it writes raw data, tables, figures, report and manifest, all or none. After a kill at any moment, the
/// next run continues from there. In a folder of an earlier form of the suite, entries are used if everything they
/// depend on is unchanged. The others are kept beside the results and used again if the suite needs them again. A shard
/// writes only its journal, shard-I-of-N.journal. All runs of a problem are in one shard, so that one machine times all
/// solvers on it.
/// @throws OutputError for a folder with anything but such results, or one that cannot be written, and for a merge that
/// lacks entries (it names the shards)
ComparisonSummary run_comparison(const Suite& suite, const ComparisonRunOptions& options);

/// Claims a folder for the suite. @throws OutputError if it holds anything else
void claim_comparison_folder(const Suite& suite, const std::string& folder);

/// Whether a folder has the finished results of a suite.
bool comparison_finished(const Suite& suite, const std::string& folder);

/// Makes tables, figures and report of a folder again from its raw.jsonl. Nothing is solved, and the manifest stays.
/// @throws OutputError if there is no raw data, or it is not a comparison's
std::size_t redraw_comparison(const std::string& folder);

}  // namespace accdec
