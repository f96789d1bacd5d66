#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include <accdec/comparison/suite_file.hpp>
#include <accdec/study/study_folder.hpp>

namespace accdec {

struct ComparisonRunOptions {
  std::string out;               ///< the results' folder
  int workers = 0;               ///< runs at a time; 0: all cores
  std::string command, version;  ///< for the manifest
  std::function<void(const StudyProgress&)> progress;
};

struct ComparisonSummary {
  std::size_t problems = 0, runs = 0, found = 0, computed = 0;
  std::size_t contradictions = 0;
  double wall_time = 0.0,
         bookkeeping = 0.0;  ///< s, of this run; share of all workers' time that went into neither solving nor judging
};

/// Carries out a comparison in a folder: one process for each run with a kill timer, every line journaled as it comes,
/// and at last raw data, tables, figures, report and manifest (whole or not at all). A process killed at any moment
/// goes on where it was.
/// @throws OutputError for a folder with anything but this suite's results, or one that cannot be written
ComparisonSummary run_comparison(const Suite& suite, const ComparisonRunOptions& options);

/// Makes tables, figures and report of a folder anew from its raw.jsonl; nothing is solved and the manifest stays.
/// @throws OutputError if there is no raw data, or it is not a comparison's
std::size_t redraw_comparison(const std::string& folder);

}  // namespace accdec
