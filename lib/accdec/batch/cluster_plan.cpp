#include <algorithm>
#include <cstring>
#include <filesystem>
#include <map>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <toml++/toml.h>

#include <accdec/batch/cluster.hpp>
#include <accdec/files.hpp>
#include <accdec/files/output_files.hpp>
#include <accdec/files/results_folder.hpp>
#include <accdec/files/text_file.hpp>
#include <accdec/formats/toml_file.hpp>

namespace accdec {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr const char* schema = "accdec.cluster/1";

/// The text quoted for a POSIX shell.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) c == '\'' ? out += "'\\''" : out += c;
  return out + "'";
}

/// The path as a quoted file name of #SBATCH, where %a is a number.
std::string pattern(const std::string& path) {
  std::string out;
  for (const char c : path) out += c == '%' ? "%%" : std::string(1, c);
  return out;
}

fs::path slurm_folder(const std::string& folder) {
  return fs::path(folder) / "slurm";
}

std::string command_line(const ClusterPlan& plan, const std::string& program) {
  std::string text =
      fmt::format("{} --quiet {} {} --out {}", quoted(program), plan.command, quoted(plan.input), quoted(plan.folder));
  for (const std::string& argument : plan.more) text += " " + quoted(argument);
  return text;
}

std::string array_script(const ClusterPlan& plan, const std::string& program) {
  const std::string slurm = slurm_folder(plan.folder).string();
  std::string sbatch;
  for (const std::string& argument : plan.sbatch) sbatch += quoted(argument) + " ";
  return fmt::format(R"sh(#!/bin/bash
# One shard of {shards}, written by accdec {command} --slurm, which submits it for every shard that is missing:
#   sbatch --array=1-{shards} {sbatch}{array}
#   sbatch --dependency=afterany:JOB {sbatch}{merge}
# Without Slurm, on hosts that see this folder and are named in nodes.txt one a line (GNU parallel over ssh; the same
# command again does what failed or is missing), and then the merge:
#   parallel --joblog {joblog} --resume-failed --sshloginfile nodes.txt \
#     bash {array} {{}} ::: $(seq {shards})
#   bash {merge}
#SBATCH --job-name=accdec-{command}
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output="{slurm}/shard-%a.log"
set -eu
shard=${{SLURM_ARRAY_TASK_ID:-${{1:?the number of a shard, 1 to {shards}}}}}
echo "shard $shard of {shards} on $(hostname), $(date -u +%FT%TZ)"
exec {run} --shard "$shard/{shards}" --workers "${{SLURM_CPUS_PER_TASK:-1}}"
)sh",
                     fmt::arg("shards", plan.shards), fmt::arg("command", plan.command),
                     fmt::arg("slurm", pattern(slurm)), fmt::arg("array", quoted(slurm + "/array.sh")),
                     fmt::arg("merge", quoted(slurm + "/merge.sh")), fmt::arg("joblog", quoted(slurm + "/joblog")),
                     fmt::arg("sbatch", sbatch), fmt::arg("run", command_line(plan, program)));
}

std::string merge_script(const ClusterPlan& plan, const std::string& program) {
  return fmt::format(R"sh(#!/bin/bash
# Puts the shards of array.sh together. It fails, naming them, while any shard lacks a point.
#SBATCH --job-name=accdec-merge
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output="{slurm}/merge.log"
set -eu
echo "merge on $(hostname), $(date -u +%FT%TZ)"
exec {run} --merge {folder}
)sh",
                     fmt::arg("slurm", pattern(slurm_folder(plan.folder).string())),
                     fmt::arg("run", command_line(plan, program)), fmt::arg("folder", quoted(plan.folder)));
}

/// Replaces the task that a table names by a copy of its file.
void freeze_task(toml::table& table, const fs::path& beside, const fs::path& folder,
                 std::map<std::string, std::string>& copies) {
  const auto given = table["task"].value<std::string>();
  if (!given) return;
  const fs::path source = fs::weakly_canonical(beside / *given);
  auto [found, added] = copies.try_emplace(source.string());
  if (added) {
    found->second = source.filename().string();
    for (const auto& [other, name] : copies) {
      if (other != source.string() && name == found->second)
        found->second = fmt::format("{}-{}", copies.size(), source.filename().string());
    }
    write_file((folder / found->second).string(), read_text_file(source.string()));
  }
  table.insert_or_assign("task", found->second);
}

}  // namespace

void check_for_scripts(const ClusterPlan& plan) {
  const auto control = [](const std::string& text) {
    return std::any_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < ' '; });
  };
  if (control(plan.folder) || plan.folder.find_first_of("\"\\") != std::string::npos)
    throw std::invalid_argument(
        "--slurm: the name of the folder must have no control characters, double quotes or backslashes");
  for (const std::string& argument : plan.sbatch) {
    if (control(argument)) throw std::invalid_argument("--sbatch-arg: control characters are not allowed");
    for (const char* own : {"--array", "-a", "--dependency", "-d", "--parsable"}) {
      if (argument.starts_with(own) &&
          (own[1] != '-' || argument.size() == std::strlen(own) || argument[std::strlen(own)] == '='))
        throw std::invalid_argument(fmt::format("--sbatch-arg {}: {} is set by --slurm", argument, own));
    }
  }
}

std::string freeze_inputs(const std::string& file, const std::string& folder) {
  create_results_folder(folder);
  toml::table tree = toml_input::parse_file(file);
  std::map<std::string, std::string> copies;
  const fs::path beside = fs::path(file).parent_path(), to = folder;
  const std::string name = fs::path(file).filename().string();
  copies[fs::weakly_canonical(file).string()] = name;
  freeze_task(tree, beside, to, copies);
  for (const char* list : {"case", "problem"}) {
    if (toml::array* tables = tree[list].as_array()) {
      for (toml::node& node : *tables) {
        if (toml::table* table = node.as_table()) freeze_task(*table, beside, to, copies);
      }
    }
  }
  if (!tree.contains("title")) tree.insert("title", file);
  std::ostringstream text;
  text << tree << '\n';
  write_file((to / name).string(), text.str());
  return fs::absolute(to / name).lexically_normal().string();
}

void write_cluster_plan(const ClusterPlan& plan, const std::string& program) {
  const fs::path folder = slurm_folder(plan.folder);
  create_results_folder(folder.string());
  ordered_json json;
  json["schema"] = schema;
  json["command"] = plan.command;
  json["title"] = plan.title;
  json["input"] = plan.input;
  json["arguments"] = plan.more;
  json["sbatch"] = plan.sbatch;
  json["shards"] = plan.shards;
  json["jobs"] = ordered_json::array();
  for (const ClusterJob& job : plan.jobs)
    json["jobs"].push_back({{"array", job.array}, {"shards", job.shards}, {"merge", job.merge}});
  OutputFiles files;
  files.add((folder / "array.sh").string(), array_script(plan, program));
  files.add((folder / "merge.sh").string(), merge_script(plan, program));
  files.add((folder / "plan.json").string(), json.dump(2) + "\n");
  files.commit();
}

bool has_cluster_plan(const std::string& folder) {
  return fs::is_regular_file(slurm_folder(folder) / "plan.json");
}

ClusterPlan read_cluster_plan(const std::string& folder, const std::string& command) {
  const std::string path = (slurm_folder(folder) / "plan.json").string();
  if (!has_cluster_plan(folder))
    throw OutputError(fmt::format("{}: nothing was submitted from here with --slurm (no slurm/plan.json)", folder));
  ClusterPlan plan;
  try {
    const ordered_json json = ordered_json::parse(read_text_file(path));
    if (json.at("schema") != schema) throw OutputError(fmt::format("{}: not a plan of shards", path));
    plan.command = json.at("command");
    plan.title = json.at("title");
    plan.input = json.at("input");
    plan.more = json.at("arguments").get<std::vector<std::string>>();
    plan.sbatch = json.value("sbatch", std::vector<std::string>());  // older plans kept none
    plan.shards = json.at("shards");
    for (const ordered_json& job : json.at("jobs"))
      plan.jobs.push_back({job.at("array"), job.at("merge"), job.at("shards").get<std::vector<std::size_t>>()});
  } catch (const nlohmann::json::exception& error) {
    throw OutputError(fmt::format("{}: not a plan of shards ({})", path, error.what()));
  }
  if (plan.command != command)
    throw OutputError(fmt::format("{}: is of `accdec {}`, not of `accdec {}`", path, plan.command, command));
  plan.folder = fs::absolute(folder).lexically_normal().string();
  return plan;
}

}  // namespace accdec
