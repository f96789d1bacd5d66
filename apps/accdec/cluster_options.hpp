#pragma once

#include <functional>
#include <string>
#include <vector>

#include <accdec/batch/cluster.hpp>

#include "command.hpp"

namespace accdec::cli {

/// The options of `study` and `compare` that have a cluster do the work.
struct ClusterOptions {
  std::size_t shards = 0;           ///< --slurm; 0: not asked for
  std::vector<std::string> sbatch;  ///< --sbatch-arg
  std::string status;               ///< --status
  bool asked() const { return shards > 0 || !status.empty(); }
};
void add_cluster_options(CLI::App& command, ClusterOptions& options);

/// @param usage  what the command needs
/// @throws std::invalid_argument with it, if there is neither --status nor both an input and a folder for results
void require_work(const ClusterOptions& options, const std::string& input, const std::string& out, const char* usage);

/// Cluster options shared by studies and comparisons.
struct ClusterWork {
  std::string command, title, input, out;                ///< subcommand; as given by the user
  std::vector<std::string> more;                         ///< further arguments of shards and merge
  std::size_t units = 1;                                 ///< what shards are made of: no more shards than that
  std::string unit_name;                                 ///< "points"
  std::function<void()> claim;                           ///< makes the results' folder this work's own
  std::function<void(const std::string& frozen)> check;  ///< throws unless the copy is the same work
  std::function<std::vector<batch::ShardState>(std::size_t shards)> states;
  std::function<bool()> finished;
};

/// Freezes the inputs, writes the scripts, submits what is missing and says so. @return the exit code
int submit_to_cluster(const ClusterWork& work, const ClusterOptions& options, const Context& context);

/// Says how far a plan is. @return exit_no_answer if something of it is in no queue
int print_cluster_status(const ClusterPlan& plan, const std::vector<batch::ShardState>& shards, bool finished);

/// I and N of "I/N". @throws std::invalid_argument
std::pair<std::size_t, std::size_t> parse_shard(const std::string& text);

}  // namespace accdec::cli
