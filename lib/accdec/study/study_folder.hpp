#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include <accdec/study/shards.hpp>
#include <accdec/study/study_file.hpp>

namespace accdec {

/// Points beyond which a study must be asked for by a flag.
inline constexpr std::size_t large_study = 100'000;
/// Points beyond which there is no study: a point takes some 100 bytes of memory for places of rows and for figures.
inline constexpr std::size_t largest_study = 10'000'000;

struct StudyProgress {
  std::size_t done = 0, total = 0;  ///< of the points this run has to compute
  double seconds = 0.0;             ///< since it began
};

struct StudyRunOptions {
  std::string out;                    ///< the results' folder
  std::size_t shard = 1, shards = 1;  ///< compute only this part
  std::vector<std::string> merge;     ///< folders of shards to put together instead of computing
  int workers = 0;                    ///< 0: all cores
  bool large = false;                 ///< allow more than `large_study` points
  bool fresh = false;                 ///< compute all anew, whatever the folder has of this study (or of this shard)
  std::string command, version;       ///< for the manifest
  std::function<void(const StudyProgress&)> progress;  ///< after every point
};

struct StudySummary {
  std::size_t points = 0;                       ///< of this run's share
  std::size_t found = 0;                        ///< already there
  std::size_t computed = 0;                     ///< now
  std::size_t bad = 0;                          ///< rows without an answer to any computation
  std::size_t lost = 0;                         ///< of them: the process computing them died or was killed
  std::vector<std::string> empty_figures = {};  ///< names of those with nothing to draw
  bool finished = false;                        ///< the folder has the report; false for a shard
  int workers = 0;                              ///< that computed points at a time
  double wall_time = 0.0;                       ///< s, of this run, with its tables and figures
  double method_time = 0.0;                     ///< s of it inside the computations, summed over the workers
  /// Share of the workers' time that went into the computations.
  double method_share() const { return wall_time > 0.0 && workers > 0 ? method_time / (wall_time * workers) : 0.0; }
};

/// Runs a study in a folder: takes what the folder's journal (or finished results) already has, computes the rest,
/// journals every point as it is done, and at last writes rows, figures, report and manifest (whole or not at all) and
/// removes the journal. A process killed at any moment goes on where it was. Points lost with the process that computed
/// them are no results: the next run computes them again. A fresh run marks its journal when it begins, so that, if it
/// is killed, a run that is not fresh goes on with it and uses none of the older results, which stay in the folder
/// until the new ones are complete. A shard leaves its journal only, shard-I-of-N.journal.
/// @throws OutputError for a folder with anything but this study's results in it (nothing is changed then), or one that
/// cannot be written; InputError for a study too large without the flag, at what makes it so; std::invalid_argument for
/// a shard that does not exist, a merge with points missing (it names the shards that lack them).
StudySummary run_study(const Study& study, const StudyRunOptions& options);

/// @throws InputError for a study too large, at what makes it so. @param large  allow more than `large_study` points
void check_study_size(const Study& study, bool large);

/// Makes a folder the study's own. @throws OutputError if it holds anything else
void claim_study_folder(const Study& study, const std::string& folder);

/// How far the shards of a study in a folder are, one entry each. @throws OutputError
std::vector<study::ShardState> study_shards(const Study& study, const std::string& folder, std::size_t shards);

/// Whether a folder has the finished results of a study.
bool study_finished(const Study& study, const std::string& folder);

}  // namespace accdec
