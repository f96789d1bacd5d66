#include "cluster_options.hpp"

#include <charconv>
#include <cstdio>
#include <filesystem>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/files/shown_text.hpp>

namespace accdec::cli {
namespace {

namespace fs = std::filesystem;

/// The tasks of a plan that Slurm has; none, and a note, if it is not installed.
std::vector<QueuedTask> queue_or_none(const ClusterPlan& plan) {
  try {
    return cluster_queue(plan);
  } catch (const std::runtime_error& error) {
    fmt::print(stderr, "accdec: note: {}; what runs is known from locked journals alone\n", error.what());
    return {};
  }
}

ClusterPlan plan_of(const ClusterWork& work, const ClusterOptions& options) {
  ClusterPlan plan;
  const fs::path folder = fs::absolute(work.out).lexically_normal();
  if (has_cluster_plan(work.out)) {
    plan = read_cluster_plan(work.out, work.command);
    if (plan.shards != options.shards)
      throw std::invalid_argument(fmt::format("--slurm {}: {} was begun with {} shards; go on with --slurm {}",
                                              options.shards, work.out, plan.shards, plan.shards));
  }
  plan.command = work.command;
  plan.title = work.title;
  plan.folder = folder.string();
  plan.more = work.more;
  plan.shards = options.shards;
  if (!options.sbatch.empty()) plan.sbatch = options.sbatch;  // else those of before
  check_for_scripts(plan);
  plan.input = freeze_inputs(work.input, (folder / "slurm" / "inputs").string());
  work.check(plan.input);
  return plan;
}

}  // namespace

void add_cluster_options(CLI::App& command, ClusterOptions& options) {
  const auto slurm =
      command
          .add_option("--slurm", options.shards,
                      "Compute N shards with Slurm and merge them: copies the inputs to DIR/slurm and submits an array "
                      "and a merge after it. The same command again submits the missing shards")
          ->check(CLI::Range(2, 1000))
          ->type_name("N");
  command
      .add_option("--sbatch-arg", options.sbatch,
                  "A further argument for sbatch, for example --partition=long; kept in DIR for when the command is "
                  "repeated without any")
      ->allow_extra_args(false)
      ->take_all()
      ->type_name("ARG")
      ->needs(slurm);
  command
      .add_option(
          "--status", options.status,
          "Print the state of the jobs that --slurm submitted from DIR: running, done, lost, and remaining time")
      ->type_name("DIR")
      ->excludes(slurm);
}

void require_work(const ClusterOptions& options, const std::string& input, const std::string& out, const char* usage) {
  if (options.status.empty() && (input.empty() || out.empty())) throw std::invalid_argument(usage);
}

int submit_to_cluster(const ClusterWork& work, const ClusterOptions& options, const Context& context) {
  if (options.shards > work.units)
    throw std::invalid_argument(
        fmt::format("--slurm {}: there are only {} {} to share out", options.shards, work.units, work.unit_name));
  work.claim();
  const std::string program = fs::read_symlink("/proc/self/exe").string();
  ClusterPlan plan = plan_of(work, options);
  write_cluster_plan(plan, program);
  const std::vector<batch::ShardState> states = work.states(plan.shards);
  const bool complete =
      std::all_of(states.begin(), states.end(), [](const batch::ShardState& s) { return s.complete(); });
  if (complete && work.finished()) {
    if (!context.quiet) fmt::print("{}\nNothing to submit: {} is complete\n", work.title, work.out);
    return exit_ok;
  }
  const ClusterJob job = submit_missing(plan, states, program);
  if (context.quiet) return exit_ok;
  fmt::print("{}\n", work.title);
  if (!job.array.empty())
    fmt::print("Submitted shard {} of {} as array job {}\n", batch::ranges_text(job.shards), plan.shards, job.array);
  if (!job.merge.empty()) fmt::print("Submitted the merge as job {}\n", job.merge);
  if (job.array.empty() && job.merge.empty()) fmt::print("Nothing to submit: all that is missing is in the queue\n");
  if (options.sbatch.empty() && !plan.sbatch.empty())
    fmt::print("With the arguments for sbatch of before: {}\n", fmt::join(plan.sbatch, " "));
  fmt::print("How far it is: accdec {} --status {}\n", work.command, shell_quoted(work.out));
  return exit_ok;
}

int print_cluster_status(const ClusterPlan& plan, const std::vector<batch::ShardState>& shards, bool finished) {
  const std::vector<QueuedTask> queue = queue_or_none(plan);
  const std::string text = cluster_status(plan, shards, queue, finished);
  std::fwrite(text.data(), 1, text.size(), stdout);
  return finished || stranded_shards(shards, queue).empty() ? exit_ok : exit_no_answer;
}

std::pair<std::size_t, std::size_t> parse_shard(const std::string& text) {
  std::size_t number = 0, count = 0;
  const char *begin = text.data(), *end = begin + text.size();
  const auto first = std::from_chars(begin, end, number);
  const bool slash = first.ec == std::errc() && first.ptr != end && *first.ptr == '/';
  const auto second = slash ? std::from_chars(first.ptr + 1, end, count) : first;
  if (!slash || second.ec != std::errc() || second.ptr != end || number < 1 || number > count)
    throw std::invalid_argument(fmt::format("--shard {}: allowed is I/N with 1 <= I <= N, for example 2/8", text));
  return {number, count};
}

}  // namespace accdec::cli
