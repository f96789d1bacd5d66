#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <accdec/batch/shards.hpp>

// Arrays of Slurm: the plan and its scripts in cluster_plan.cpp, submission and state in cluster_jobs.cpp.

namespace accdec {

/// A Slurm array that was submitted, and the merge that waits for it.
struct ClusterJob {
  std::string array, merge;         ///< job numbers; empty if none was submitted
  std::vector<std::size_t> shards;  ///< of the array
};

/// A study or comparison that a cluster computes in shards; kept as DIR/slurm/plan.json.
struct ClusterPlan {
  std::string command;              ///< subcommand: "study" or "compare"
  std::string title;                ///< for people
  std::string folder;               ///< of the results, absolute; all nodes must see it
  std::string input;                ///< the frozen study or suite, absolute
  std::vector<std::string> more;    ///< further arguments of shards and merge
  std::vector<std::string> sbatch;  ///< further arguments for sbatch, of every submission
  std::size_t shards = 1;
  std::vector<ClusterJob> jobs;
};

/// A task of a plan's arrays, or a merge, that Slurm knows of now.
struct QueuedTask {
  std::string job;
  std::size_t shard = 0;  ///< 0: a merge
  std::string state;      ///< Slurm's state: "R", "PD", ...
  std::string since, node, reason;
  int cpus = 1;
  bool runs() const { return state == "R" || state == "CG"; }
};

/// Call before anything is written. It refuses arguments that would end a comment or the quotes of a script, and
/// arguments that accdec sets itself (the array, the dependency).
/// @throws std::invalid_argument
void check_for_scripts(const ClusterPlan& plan);

/// Copies a study or suite and all task files it names into a folder; the copy names the copies.
/// @return the copy's path
/// @throws InputError, OutputError
std::string freeze_inputs(const std::string& file, const std::string& folder);

/// Writes DIR/slurm: plan.json, array.sh and merge.sh.
/// @param program  path of accdec on the nodes
/// @throws OutputError
void write_cluster_plan(const ClusterPlan& plan, const std::string& program);

/// The plan in a results' folder. @throws OutputError if there is none, or one of another subcommand
ClusterPlan read_cluster_plan(const std::string& folder, const std::string& command);
bool has_cluster_plan(const std::string& folder);

/// A plan's entries in Slurm's queue; empty if Slurm is not installed.
/// @throws std::runtime_error with Slurm's message
std::vector<QueuedTask> cluster_queue(const ClusterPlan& plan);

/// Submits the shards that are neither complete nor in the queue, as an array. Also submits a merge that waits for all
/// running arrays; an older waiting merge is cancelled. Records the jobs in the plan and rewrites it.
/// @param program  as in write_cluster_plan
/// @return the jobs submitted; members are empty if there are none
/// @throws std::runtime_error with Slurm's message, or if it is not installed
ClusterJob submit_missing(ClusterPlan& plan, const std::vector<batch::ShardState>& shards, const std::string& program);

/// A text for people: what runs, what is done, what is lost, and how long it will take.
std::string cluster_status(const ClusterPlan& plan, const std::vector<batch::ShardState>& shards,
                           const std::vector<QueuedTask>& queue, bool finished);

/// Shards that are neither complete nor in the queue, nor being written by another process.
std::vector<std::size_t> stranded_shards(const std::vector<batch::ShardState>& shards,
                                         const std::vector<QueuedTask>& queue);

}  // namespace accdec
