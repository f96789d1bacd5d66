#include <cstdio>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/files/shown_text.hpp>
#include <accdec/study/study_folder.hpp>

#include "cluster_options.hpp"
#include "command.hpp"
#include "interrupt.hpp"
#include "progress_bar.hpp"

namespace accdec::cli {
namespace {

struct StudyArguments {
  std::string study, shard;
  StudyRunOptions run;
  ClusterOptions cluster;
};

int run_cluster(const StudyArguments& options, const Context& context) {
  if (const std::string& folder = options.cluster.status; !folder.empty()) {
    const ClusterPlan plan = read_cluster_plan(folder, "study");
    const Study study = read_study(plan.input);
    return print_cluster_status(plan, study_shards(study, folder, plan.shards), study_finished(study, folder));
  }
  const Study study = read_study(options.study);
  check_study_size(study, options.run.large);
  ClusterWork work{"study", study.title, options.study, options.run.out, {}, study.points().size(), "points", {}, {},
                   {},      {}};
  if (options.run.large) work.more.push_back("--large");
  work.claim = [&] { claim_study_folder(study, options.run.out); };
  work.check = [&](const std::string& frozen) {
    if (read_study(frozen).hash() != study.hash())
      throw std::runtime_error(fmt::format("{}: this copy of the study differs from {}", frozen, options.study));
  };
  work.states = [&](std::size_t shards) { return study_shards(study, options.run.out, shards); };
  work.finished = [&] { return study_finished(study, options.run.out); };
  return submit_to_cluster(work, options.cluster, context);
}

void print_summary(const StudyArguments& options, const Study& study, const StudySummary& s) {
  fmt::print(
      "{}\n{} points: {} computed in {:.1f} s ({:.1f} % of the workers' time inside the methods), {} from an earlier "
      "run{}\n",
      study.title, s.points, s.computed, s.wall_time, 100.0 * s.method_share(), s.found,
      s.bad > 0 ? fmt::format(", {} without an answer (column `reason`)", s.bad) : "");
  if (s.lost > 0) {
    fmt::print(
        "{} of them were lost because their process died; run the study in this folder again (without --fresh) to "
        "compute these\n",
        s.lost);
  }
  if (s.finished) {
    fmt::print("Results: {0}/report.html, rows.csv, rows.jsonl, manifest.json, {1} figures\n",
               printable(options.run.out), study.figures.size());
  } else {
    fmt::print("Shard {}/{} is done; put all together with `accdec study {} --out DIR --merge {}`\n", options.run.shard,
               options.run.shards, shell_quoted(options.study), shell_quoted(options.run.out));
  }
}

void run(StudyArguments& options, Context& context) {
  require_work(options.cluster, options.study, options.run.out,
               "study needs STUDY.toml and --out DIR, or --status DIR");
  if (options.cluster.asked()) {
    context.exit_code = run_cluster(options, context);
    return;
  }
  if (!options.shard.empty()) std::tie(options.run.shard, options.run.shards) = parse_shard(options.shard);
  const Study study = read_study(options.study);
  options.run.command =
      fmt::format("accdec study {} --out {}", shell_quoted(options.study), shell_quoted(options.run.out));
  options.run.version = ACCDEC_VERSION;
  if (!context.quiet) options.run.progress = ProgressBar();
  const StudySummary s = [&] {
    const InterruptNote note(options.run.out, "points", options.run.fresh, context.quiet);
    return run_study(study, options.run);
  }();
  options.run.progress = nullptr;  // takes the bar away
  context.exit_code = s.bad < s.points ? exit_ok : exit_no_answer;
  for (const std::string& name : s.empty_figures)
    fmt::print(stderr, "accdec: warning: figure `{}` has no data: no row that counts has numbers its axes can show\n",
               name);
  if (!context.quiet) print_summary(options, study, s);
}

}  // namespace

void add_study(CLI::App& app, Context& context) {
  const auto options = std::make_shared<StudyArguments>();
  CLI::App* command =
      app.add_subcommand("study", "Run a parameter study: many tasks from one, with tables, figures and a report");
  command->add_option("study", options->study, "Study file: base task, what varies, what to compute, figures")
      ->type_name("STUDY.toml");
  command
      ->add_option("--out", options->run.out,
                   "Folder for the results. An interrupted run of the same study continues; points lost in a crash are "
                   "computed again")
      ->type_name("DIR");
  const auto workers = command
                           ->add_option("--workers", options->run.workers,
                                        "Points computed at a time (default: all cores). Rows depend on it only if "
                                        "time_limit_s ends an optimum's search")
                           ->check(CLI::Range(1, 1024))
                           ->type_name("N");
  const auto shard =
      command->add_option("--shard", options->shard, "Compute part I of N only, without a report")->type_name("I/N");
  const auto merge =
      command->add_option("--merge", options->run.merge, "Merge the shards in these folders instead of computing")
          ->type_name("DIR...")
          ->excludes(shard);
  command->add_flag("--large", options->run.large, fmt::format("Allow more than {} points", large_study));
  const auto fresh = command->add_flag("--fresh", options->run.fresh,
                                       "Compute all points again, even those in the folder. If this is interrupted, "
                                       "the same command without --fresh continues it");
  add_cluster_options(*command, options->cluster);
  for (const char* name : {"--slurm", "--status"}) {
    for (CLI::Option* other : {workers, shard, merge, fresh}) command->get_option(name)->excludes(other);
  }
  command->callback([options, &context] { run(*options, context); });
}

}  // namespace accdec::cli
