#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <unistd.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/comparison/comparison_folder.hpp>
#include <accdec/comparison/comparison_schedule.hpp>
#include <accdec/files/shown_text.hpp>

#include "cluster_options.hpp"
#include "command.hpp"
#include "interrupt.hpp"
#include "progress_bar.hpp"

namespace accdec::cli {
namespace {

struct CompareArguments {
  std::string suite, redraw, shard;
  std::vector<std::string> solvers;
  ComparisonRunOptions run;
  ClusterOptions cluster;
};

/// A margin problem asks for the least error at given delays. If none are given, they are 0, and a line says so.
void tell_missing_delays(const Suite& suite) {
  std::string last;
  for (const comparison::CaseSpec& spec : suite.cases) {
    if (spec.question != comparison::Question::margin || !spec.delays.empty() || spec.name == last) continue;
    fmt::print(stderr,
               "{}: problem \"{}\": margin without delay_samples: asks for the least corner error without any delay\n",
               suite.path, spec.name);
    last = spec.name;
  }
}

int run_cluster(const CompareArguments& options, const Context& context) {
  if (const std::string& folder = options.cluster.status; !folder.empty()) {
    const ClusterPlan plan = read_cluster_plan(folder, "compare");
    // The further arguments are --solvers and its list.
    const Suite suite =
        read_suite(plan.input, plan.more.empty() ? plan.more : std::vector(plan.more.begin() + 1, plan.more.end()));
    return print_cluster_status(plan, comparison::comparison_shards(suite, folder, plan.shards),
                                comparison_finished(suite, folder));
  }
  const Suite suite = read_suite(options.suite, options.solvers);
  ClusterWork work{
      "compare", suite.settings.title, options.suite, options.run.out, {}, suite.cases.size(), "problems", {}, {}, {},
      {}};
  if (!options.solvers.empty()) work.more.push_back("--solvers");
  work.more.insert(work.more.end(), options.solvers.begin(), options.solvers.end());
  work.claim = [&] { claim_comparison_folder(suite, options.run.out); };
  work.check = [&](const std::string& frozen) {
    if (read_suite(frozen, options.solvers).hash != suite.hash)
      throw std::runtime_error(fmt::format("{}: this copy of the suite differs from {}", frozen, options.suite));
  };
  work.states = [&](std::size_t shards) { return comparison::comparison_shards(suite, options.run.out, shards); };
  work.finished = [&] { return comparison_finished(suite, options.run.out); };
  return submit_to_cluster(work, options.cluster, context);
}

void run(CompareArguments& options, Context& context) {
  if (!options.redraw.empty()) {
    const std::size_t files = redraw_comparison(options.redraw);
    if (!context.quiet) fmt::print("{} files made again from {}/raw.jsonl\n", files, options.redraw);
    return;
  }
  require_work(options.cluster, options.suite, options.run.out,
               "compare needs SUITE.toml and --out DIR, or --redraw DIR, or --status DIR");
  if (options.cluster.asked()) {
    context.exit_code = run_cluster(options, context);
    return;
  }
  if (!options.shard.empty()) std::tie(options.run.shard, options.run.shards) = parse_shard(options.shard);
  const Suite suite = read_suite(options.suite, options.solvers);
  if (!context.quiet) tell_missing_delays(suite);
  options.run.command =
      fmt::format("accdec compare {} --out {}", shell_quoted(options.suite), shell_quoted(options.run.out));
  if (!options.solvers.empty()) options.run.command += fmt::format(" --solvers {}", fmt::join(options.solvers, ","));
  if (options.run.workers > 0) options.run.command += fmt::format(" --workers {}", options.run.workers);
  options.run.version = ACCDEC_VERSION;
  if (!context.quiet) options.run.progress = ProgressBar("runs");
  const ComparisonSummary s = [&] {
    const InterruptNote note(options.run.out, "runs", false, context.quiet);
    return run_comparison(suite, options.run);
  }();
  options.run.progress = nullptr;  // takes the bar away
  context.exit_code = s.contradictions == 0 ? exit_ok : exit_no_answer;
  if (s.contradictions > 0)
    fmt::print(stderr, "{} contradictions between answers, proofs and the suite: see report.html\n", s.contradictions);
  if (context.quiet) return;
  if (!s.finished) {
    fmt::print("{}\nShard {}/{} is done: {} runs; put all together with `accdec compare {} --out DIR --merge {}`\n",
               suite.settings.title, options.run.shard, options.run.shards, s.runs, shell_quoted(options.suite),
               shell_quoted(options.run.out));
    return;
  }
  fmt::print("{}\n\n{}\n", suite.settings.title, s.table);
  fmt::print("{} problems, {} runs: {} entries computed in {:.1f} s ({:.2f} % bookkeeping), {} from an earlier run\n",
             s.problems, s.runs, s.computed, s.wall_time, 100.0 * s.bookkeeping, s.found);
  if (s.set_aside > 0) {
    fmt::print("{} entries that the suite no longer asks for are kept in {}/earlier.jsonl\n", s.set_aside,
               options.run.out);
  }
  fmt::print("Results: {}/report.html, raw.jsonl, tables in CSV, figures, manifest.json\n", printable(options.run.out));
}

}  // namespace

void add_compare(CLI::App& app, Context& context) {
  const auto options = std::make_shared<CompareArguments>();
  CLI::App* command = app.add_subcommand("compare", "Compare solvers on a suite of problems, every answer verified");
  const auto suite =
      command->add_option("suite", options->suite, "Suite file: problems, solvers, limits")->type_name("SUITE.toml");
  const auto out = command
                       ->add_option("--out", options->run.out,
                                    "Folder for the results. An interrupted run continues; after a change of the suite "
                                    "only the changed entries are computed")
                       ->type_name("DIR");
  const auto solvers = command
                           ->add_option("--solvers", options->solvers,
                                        "Solvers instead of the suite's: names of `accdec solvers`; NAME/sparse or "
                                        "NAME/reduced for one form of the problem")
                           ->delimiter(',')
                           ->type_name("LIST");
  const auto workers = command
                           ->add_option("--workers", options->run.workers,
                                        "Runs at a time, each in its own process (default: all cores)")
                           ->check(CLI::Range(1, 1024))
                           ->type_name("N");
  command
      ->add_option("--redraw", options->redraw,
                   "Make the tables, figures and report of a folder again from its raw data, without solving anything")
      ->type_name("DIR")
      ->excludes(suite)
      ->excludes(out)
      ->excludes(solvers)
      ->excludes(workers);
  const auto shard =
      command->add_option("--shard", options->shard, "Run only the problems of part I of N, without a report")
          ->type_name("I/N");
  const auto merge =
      command->add_option("--merge", options->run.merge, "Merge the shards in these folders instead of solving")
          ->type_name("DIR...")
          ->excludes(shard);
  add_cluster_options(*command, options->cluster);
  for (const char* name : {"--slurm", "--status"}) {
    for (const char* other : {"--workers", "--redraw", "--shard", "--merge"})
      command->get_option(name)->excludes(command->get_option(other));
  }
  for (CLI::Option* option : {shard, merge}) option->excludes(command->get_option("--redraw"));
  command->callback([options, &context] { run(*options, context); });
}

}  // namespace accdec::cli
