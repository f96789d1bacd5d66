#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <unistd.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/comparison/comparison_folder.hpp>

#include "command.hpp"
#include "progress_bar.hpp"

namespace accdec::cli {
namespace {

struct Options {
  std::string suite, redraw;
  std::vector<std::string> solvers;
  ComparisonRunOptions run;
};

void run(Options& options, Context& context) {
  if (!options.redraw.empty()) {
    const std::size_t files = redraw_comparison(options.redraw);
    if (!context.quiet) fmt::print("{} files drawn anew from {}/raw.jsonl\n", files, options.redraw);
    return;
  }
  if (options.suite.empty() || options.run.out.empty())
    throw std::invalid_argument("compare needs SUITE.toml and --out DIR, or --redraw DIR");
  const Suite suite = read_suite(options.suite, options.solvers);
  options.run.command = fmt::format("accdec compare {} --out {}", options.suite, options.run.out);
  if (!options.solvers.empty()) options.run.command += fmt::format(" --solvers {}", fmt::join(options.solvers, ","));
  if (options.run.workers > 0) options.run.command += fmt::format(" --workers {}", options.run.workers);
  options.run.version = ACCDEC_VERSION;
  if (!context.quiet && ::isatty(2)) options.run.progress = ProgressBar("runs");
  const ComparisonSummary s = run_comparison(suite, options.run);
  context.exit_code = s.contradictions == 0 ? exit_ok : exit_no_answer;
  if (s.contradictions > 0)
    fmt::print(stderr, "{} contradictions between answers, proofs and the suite: see report.html\n", s.contradictions);
  if (context.quiet) return;
  fmt::print(
      "{}\n{} problems, {} runs: {} entries computed in {:.1f} s ({:.2f} % bookkeeping), {} from an earlier "
      "run\nResults: {}/report.html, raw.jsonl, tables in CSV, figures, manifest.json\n",
      suite.settings.title, s.problems, s.runs, s.computed, s.wall_time, 100.0 * s.bookkeeping, s.found,
      options.run.out);
}

}  // namespace

void add_compare(CLI::App& app, Context& context) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("compare", "Compare solvers on a suite of problems, every answer verified");
  const auto suite =
      command->add_option("suite", options->suite, "Suite file: problems, solvers, limits")->type_name("SUITE.toml");
  const auto out =
      command
          ->add_option("--out", options->run.out,
                       "Folder for the results; goes on where an interrupted run of the same suite stopped")
          ->type_name("DIR");
  const auto solvers = command
                           ->add_option("--solvers", options->solvers,
                                        "Instead of the suite's: names of `accdec solvers`, NAME/sparse or "
                                        "NAME/reduced for a form of the problem")
                           ->delimiter(',')
                           ->type_name("LIST");
  const auto workers = command
                           ->add_option("--workers", options->run.workers,
                                        "Runs at a time, each in its own process (default: all cores)")
                           ->check(CLI::Range(1, 1024))
                           ->type_name("N");
  command
      ->add_option("--redraw", options->redraw,
                   "Make tables, figures and report of a folder anew from its raw data, solving nothing")
      ->type_name("DIR")
      ->excludes(suite)
      ->excludes(out)
      ->excludes(solvers)
      ->excludes(workers);
  command->callback([options, &context] { run(*options, context); });
}

}  // namespace accdec::cli
