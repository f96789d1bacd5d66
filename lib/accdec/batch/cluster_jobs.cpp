#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/batch/cluster.hpp>
#include <accdec/files/process.hpp>
#include <accdec/formats/design_report.hpp>

namespace accdec {
namespace {

namespace fs = std::filesystem;
using batch::ShardState;

constexpr const char* package = "slurm-client";

const QueuedTask* task_of(const std::vector<QueuedTask>& queue, std::size_t shard) {
  const auto found = std::find_if(queue.begin(), queue.end(), [&](const QueuedTask& t) { return t.shard == shard; });
  return found == queue.end() ? nullptr : &*found;
}

std::string trimmed(const std::string& text) {
  const std::size_t end = text.find_last_not_of(" \n\t");
  return end == std::string::npos ? "" : text.substr(0, end + 1);
}

/// Runs one of Slurm's commands. @throws std::runtime_error with its message
std::string slurm(const std::vector<std::string>& arguments) {
  const ProcessOutput result = run_process(arguments, "", package);
  if (result.exit_code != 0)
    throw std::runtime_error(fmt::format("{} failed ({}): {}", arguments[0], result.exit_code,
                                         trimmed(result.errors.empty() ? result.output : result.errors)));
  return result.output;
}

/// Submits a script. Returns the number of its job.
std::string submit(std::vector<std::string> arguments, const std::vector<std::string>& more, const fs::path& script) {
  arguments.insert(arguments.begin(), {"sbatch", "--parsable"});
  arguments.insert(arguments.end(), more.begin(), more.end());
  arguments.push_back(script.string());
  const std::string answer = trimmed(slurm(arguments));
  std::string job = answer.substr(0, answer.find(';'));  // after it comes the cluster's name
  if (job.empty() || job.find_first_not_of("0123456789") != std::string::npos)
    throw std::runtime_error(fmt::format("sbatch answered `{}`, which is no number of a job", answer));
  return job;
}

std::string clock_text(double seconds) {
  const long s = std::lround(seconds);
  return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

std::string state_text(const ShardState& shard, const QueuedTask* task) {
  if (shard.complete()) return "done";
  if (task && task->runs()) return fmt::format("runs on {} for {}", task->node, task->since);
  if (task) return task->reason.empty() ? "waits" : fmt::format("waits ({})", task->reason);
  return shard.in_use ? "is being computed" : "in no queue";
}

/// The last line a merge wrote.
std::string last_line(const fs::path& log) {
  std::ifstream in(log);
  std::string last;
  for (std::string line; std::getline(in, line);) {
    if (!line.empty()) last = line;
  }
  return last;
}

std::string merge_text(const ClusterPlan& plan, const std::vector<QueuedTask>& queue, bool finished) {
  if (finished) return "Put together: report.html, rows and figures are there.";
  if (const QueuedTask* merge = task_of(queue, 0)) return merge->runs() ? "The merge runs." : "The merge waits.";
  const std::string last = last_line(fs::path(plan.folder) / "slurm" / "merge.log");
  return last.empty() ? "The merge is in no queue." : fmt::format("The last merge ended without results: {}", last);
}

std::string time_text(const std::vector<ShardState>& shards, const std::vector<QueuedTask>& queue) {
  std::size_t done = 0, left = 0;
  double seconds = 0.0;
  int cpus = 0;
  for (const ShardState& s : shards) {
    done += s.done;
    left += s.points - std::min(s.points, s.done);
    seconds += s.seconds;
    const QueuedTask* task = task_of(queue, s.number);
    if (s.complete()) continue;
    cpus += task && task->runs() ? task->cpus : !task && s.in_use ? 1 : 0;
  }
  if (left == 0) return "";
  if (done == 0) return "How long it will take shows when the first points are done.\n";
  const double work = seconds / static_cast<double>(done) * static_cast<double>(left);
  std::string text = fmt::format("About {} of one core are left by the mean of the points so far", clock_text(work));
  if (cpus > 0) text += fmt::format("; with the {} that compute now about {}", cpus, clock_text(work / cpus));
  return text + ".\n";
}

}  // namespace

std::vector<QueuedTask> cluster_queue(const ClusterPlan& plan) {
  std::set<std::string> ours, merges;
  for (const ClusterJob& job : plan.jobs) {
    if (!job.array.empty()) ours.insert(job.array);
    if (!job.merge.empty()) merges.insert(job.merge);
  }
  std::vector<QueuedTask> queue;
  if (ours.empty() && merges.empty()) return queue;
  // Asks for all of the user's jobs: Slurm refuses a list of numbers if it has forgotten one of them.
  std::istringstream lines(slurm({"squeue", "--me", "--noheader", "--array", "--format=%F|%K|%t|%M|%N|%C|%r"}));
  for (std::string line; std::getline(lines, line);) {
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, '|');) cells.push_back(trimmed(cell));
    if (cells.size() < 6) continue;
    QueuedTask task{cells[0],
                    0,
                    cells[2],
                    cells[3],
                    cells[4],
                    cells.size() > 6 ? cells[6] : "",
                    std::max(1, std::atoi(cells[5].c_str()))};
    if (ours.contains(task.job))
      task.shard = std::strtoul(cells[1].c_str(), nullptr, 10);
    else if (!merges.contains(task.job))
      continue;
    queue.push_back(std::move(task));
  }
  return queue;
}

std::vector<std::size_t> stranded_shards(const std::vector<ShardState>& shards, const std::vector<QueuedTask>& queue) {
  std::vector<std::size_t> numbers;
  for (const ShardState& s : shards) {
    if (!s.complete() && !s.in_use && !task_of(queue, s.number)) numbers.push_back(s.number);
  }
  return numbers;
}

ClusterJob submit_missing(ClusterPlan& plan, const std::vector<ShardState>& shards, const std::string& program) {
  const std::vector<QueuedTask> queue = cluster_queue(plan);
  const fs::path folder = fs::path(plan.folder) / "slurm";
  ClusterJob job;
  job.shards = stranded_shards(shards, queue);
  const QueuedTask* waiting = task_of(queue, 0);
  if (job.shards.empty() && waiting) return job;
  if (!job.shards.empty()) {
    job.array = submit({fmt::format("--array={}", batch::ranges_text(job.shards))}, plan.sbatch, folder / "array.sh");
    plan.jobs.push_back(job);
    write_cluster_plan(plan, program);  // the submitted array is recorded even if the merge fails
  } else {
    plan.jobs.push_back({});
  }
  if (waiting) slurm({"scancel", waiting->job});
  std::set<std::string> before;
  if (!job.array.empty()) before.insert(job.array);
  for (const QueuedTask& task : queue) {
    if (task.shard > 0) before.insert(task.job);
  }
  std::vector<std::string> after;
  if (!before.empty()) after.push_back(fmt::format("--dependency=afterany:{}", fmt::join(before, ":")));
  try {
    job.merge = submit(after, plan.sbatch, folder / "merge.sh");
  } catch (const std::runtime_error& error) {
    if (job.array.empty()) throw;
    throw std::runtime_error(
        fmt::format("{}; the shards are submitted as array job {}, the same command again submits "
                    "the merge",
                    error.what(), job.array));
  }
  plan.jobs.back() = job;
  write_cluster_plan(plan, program);
  return job;
}

std::string cluster_status(const ClusterPlan& plan, const std::vector<ShardState>& shards,
                           const std::vector<QueuedTask>& queue, bool finished) {
  std::size_t points = 0, done = 0, lost = 0, complete = 0, run = 0, wait = 0;
  TextTable table({"shard", "points", "done", "lost", "state"});
  table.left(4);
  for (const ShardState& s : shards) {
    points += s.points, done += s.done, lost += s.lost;
    const QueuedTask* task = task_of(queue, s.number);
    if (s.complete())
      ++complete;
    else if (task ? task->runs() : s.in_use)
      ++run;
    else if (task)
      ++wait;
    if (s.complete()) continue;  // complete shards are not listed
    table.add({fmt::format("{}/{}", s.number, shards.size()), fmt::format("{}", s.points), fmt::format("{}", s.done),
               fmt::format("{}", s.lost), state_text(s, task)});
  }
  const std::vector<std::size_t> stranded = stranded_shards(shards, queue);
  std::string text = fmt::format(
      "{}\n{} of {} points are done{}; of {} shards {} are done, {} run, {} wait, {} are in no queue\n{}", plan.title,
      done, points, lost > 0 ? fmt::format(", {} were lost because their process died", lost) : "", shards.size(),
      complete, run, wait, stranded.size(), table.empty() ? "" : table.str());
  text += time_text(shards, queue) + merge_text(plan, queue, finished) + "\n";
  if (!stranded.empty() && !finished)
    text += fmt::format("Repeat the command with --slurm to submit shard {}.\n", batch::ranges_text(stranded));
  return text;
}

}  // namespace accdec
