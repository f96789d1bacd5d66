#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include <accdec/batch/runner.hpp>
#include <accdec/batch/shards.hpp>
#include <accdec/study/study_file.hpp>

namespace accdec {

/// A study of more points needs a flag.
inline constexpr std::size_t large_study = 100'000;
/// Largest number of points: a point takes about 100 bytes of memory for the place of its row and for figures.
inline constexpr std::size_t largest_study = 10'000'000;

struct StudyRunOptions {
  std::string out;                    ///< the results' folder
  std::size_t shard = 1, shards = 1;  ///< compute only this part
  std::vector<std::string> merge;     ///< folders of shards to merge instead of computing
  int workers = 0;                    ///< 0: all cores
  bool large = false;                 ///< allow more than `large_study` points
  bool fresh = false;                 ///< compute all points again, even if the folder has results of this study (or of
                                      ///< this shard)
  std::string command, version;       ///< for the manifest
  std::function<void(const batch::Progress&)> progress;  ///< after every point
};

struct StudySummary {
  std::size_t points = 0;                       ///< points of this run
  std::size_t found = 0;                        ///< points already computed
  std::size_t computed = 0;                     ///< now
  std::size_t bad = 0;                          ///< rows without an answer to any computation
  std::size_t lost = 0;                         ///< of these: their process died or was killed
  std::vector<std::string> empty_figures = {};  ///< names of figures with nothing to draw
  bool finished = false;                        ///< the folder has the report; false for a shard
  int workers = 0;                              ///< number that computed points at a time
  double wall_time = 0.0;                       ///< s, of this run, including its tables and figures
  double method_time = 0.0;                     ///< s of it inside the computations, summed over the workers
  /// Part of the workers' time spent in the computations.
  double method_share() const { return wall_time > 0.0 && workers > 0 ? method_time / (wall_time * workers) : 0.0; }
};

/// Runs a study in a folder. It takes finished points from the folder's journal (or finished results), computes the
/// others, and journals every point at once. At the end it writes rows, figures, report and manifest, all or none, and
/// removes the journal. After a kill at any moment, the next run continues from there. A point whose process died has
/// no result: the next run computes it again. A fresh run marks its journal at the beginning. If it is killed, a normal
/// run continues it and uses none of the older results. These stay in the folder until the new ones are complete. A
/// shard writes only its journal, shard-I-of-N.journal.
/// @throws OutputError for a folder with anything but this study's results in it (nothing is changed then), or one that
/// cannot be written
/// @throws InputError for a study too large without the flag, at the key that makes it so
/// @throws std::invalid_argument for a shard that does not exist, and for a merge with points missing (it names their
/// shards)
StudySummary run_study(const Study& study, const StudyRunOptions& options);

/// @throws InputError for a study too large, at what makes it so. @param large  allow more than `large_study` points
void check_study_size(const Study& study, bool large);

/// Claims a folder for the study. @throws OutputError if it holds anything else
void claim_study_folder(const Study& study, const std::string& folder);

/// Progress of the shards of a study in a folder, one entry each. @throws OutputError
std::vector<batch::ShardState> study_shards(const Study& study, const std::string& folder, std::size_t shards);

/// Whether a folder has the finished results of a study.
bool study_finished(const Study& study, const std::string& folder);

}  // namespace accdec
