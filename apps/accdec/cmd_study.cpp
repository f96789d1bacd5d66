#include <charconv>
#include <cstdio>
#include <memory>

#include <unistd.h>

#include <fmt/format.h>

#include <accdec/study/study_folder.hpp>

#include "command.hpp"
#include "progress_bar.hpp"

namespace accdec::cli {
namespace {

struct Options {
  std::string study, shard;
  StudyRunOptions run;
};

void read_shard(Options& options) {
  if (options.shard.empty()) return;
  std::size_t number = 0, count = 0;
  const char *begin = options.shard.data(), *end = begin + options.shard.size();
  const auto first = std::from_chars(begin, end, number);
  const bool slash = first.ec == std::errc() && first.ptr != end && *first.ptr == '/';
  const auto second = slash ? std::from_chars(first.ptr + 1, end, count) : first;
  if (!slash || second.ec != std::errc() || second.ptr != end || number < 1 || number > count) {
    throw std::invalid_argument(
        fmt::format("--shard {}: allowed is I/N with 1 <= I <= N, for example 2/8", options.shard));
  }
  options.run.shard = number;
  options.run.shards = count;
}

void run(Options& options, Context& context) {
  read_shard(options);
  const Study study = read_study(options.study);
  options.run.command = fmt::format("accdec study {} --out {}", options.study, options.run.out);
  options.run.version = ACCDEC_VERSION;
  if (!context.quiet && ::isatty(2)) options.run.progress = ProgressBar();
  const StudySummary s = run_study(study, options.run);
  context.exit_code = s.bad < s.points ? exit_ok : exit_no_answer;
  for (const std::string& name : s.empty_figures)
    fmt::print(stderr, "accdec: warning: figure `{}` has no data: no row that counts has numbers its axes can show\n",
               name);
  if (context.quiet) return;
  fmt::print(
      "{}\n{} points: {} computed in {:.1f} s ({:.1f} % of the workers' time inside the methods), {} from an earlier "
      "run{}\n",
      study.title, s.points, s.computed, s.wall_time, 100.0 * s.method_share(), s.found,
      s.bad > 0 ? fmt::format(", {} without an answer (column `reason`)", s.bad) : "");
  if (s.lost > 0) {
    fmt::print(
        "{} of them were lost with the process computing them; run the study in this folder once more (without "
        "--fresh) to compute these\n",
        s.lost);
  }
  if (s.finished) {
    fmt::print("Results: {0}/report.html, rows.csv, rows.jsonl, manifest.json, {1} figures\n", options.run.out,
               study.figures.size());
  } else {
    fmt::print("Shard {}/{} is done; put all together with `accdec study {} --out DIR --merge {}`\n", options.run.shard,
               options.run.shards, options.study, options.run.out);
  }
}

}  // namespace

void add_study(CLI::App& app, Context& context) {
  const auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("study", "Parameter study: many tasks from one, with tables, figures and a report");
  command->add_option("study", options->study, "Study file: base task, what varies, what to compute, figures")
      ->required()
      ->type_name("STUDY.toml");
  command
      ->add_option("--out", options->run.out,
                   "Folder for the results; goes on where an interrupted run of the same study stopped, with the "
                   "points lost in a crash once more")
      ->required()
      ->type_name("DIR");
  command
      ->add_option("--workers", options->run.workers,
                   "Points computed at a time (default: all cores); rows depend on it only where time_limit_s cuts an "
                   "optimum off")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
  const auto shard =
      command->add_option("--shard", options->shard, "Compute part I of N only, without a report")->type_name("I/N");
  command->add_option("--merge", options->run.merge, "Put the shards in these folders together instead of computing")
      ->type_name("DIR...")
      ->excludes(shard);
  command->add_flag("--large", options->run.large, fmt::format("Allow more than {} points", large_study));
  command->add_flag("--fresh", options->run.fresh,
                    "Compute all points anew, whatever the folder has; if this is interrupted, the same command "
                    "without --fresh goes on with it");
  command->callback([options, &context] { run(*options, context); });
}

}  // namespace accdec::cli
