#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include <accdec/comparison/suite_file.hpp>
#include <accdec/study/study_folder.hpp>

namespace accdec {

struct ComparisonRunOptions {
  std::string out;                    ///< the results' folder
  int workers = 0;                    ///< runs at a time; 0: all cores
  std::size_t shard = 1, shards = 1;  ///< carry out only the problems of this part, without results
  std::vector<std::string> merge;     ///< folders of shards to put together; nothing is solved then
  std::string command, version;       ///< for the manifest
  std::function<void(const StudyProgress&)> progress;
};

struct ComparisonSummary {
  std::size_t problems = 0, runs = 0, found = 0, computed = 0;
  std::size_t set_aside = 0;  ///< of earlier forms of the suite, not asked for now: kept in earlier.jsonl
  std::size_t contradictions = 0;
  bool finished = false;  ///< the folder has the report; false for a shard
  std::string table;      ///< what each solver came to, in plain text
  double wall_time = 0.0,
         bookkeeping = 0.0;  ///< s, of this run; share of all workers' time that went into neither solving nor judging
};

/// Carries out a comparison in a folder: one process for each run with a kill timer, every line journaled as it comes,
/// and at last raw data, tables, figures, report and manifest (whole or not at all). A process killed at any moment
/// goes on where it was. In a folder of an earlier form of the suite, entries count on which nothing has changed that
/// they depend on; the others are kept beside the results, and found again if the suite asks for them again.
/// A shard leaves its journal only, shard-I-of-N.journal; all runs of a problem are in one shard, so that one machine
/// times all solvers on it.
/// @throws OutputError for a folder with anything but such results, or one that cannot be written, and for a merge that
/// lacks entries (it names the shards)
ComparisonSummary run_comparison(const Suite& suite, const ComparisonRunOptions& options);

/// Makes a folder the suite's own. @throws OutputError if it holds anything else
void claim_comparison_folder(const Suite& suite, const std::string& folder);

/// Whether a folder has the finished results of a suite.
bool comparison_finished(const Suite& suite, const std::string& folder);

/// Makes tables, figures and report of a folder anew from its raw.jsonl; nothing is solved and the manifest stays.
/// @throws OutputError if there is no raw data, or it is not a comparison's
std::size_t redraw_comparison(const std::string& folder);

}  // namespace accdec
