#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include <accdec/design/design.hpp>
#include <accdec/files/output_files.hpp>
#include <accdec/files/seconds_since.hpp>
#include <accdec/formats/task_reader.hpp>
#include <accdec/study/baseline_table.hpp>

#include "interrupt.hpp"
#include "option_checks.hpp"
#include "output.hpp"
#include "status_line.hpp"

namespace accdec::cli {
namespace {

struct Arguments {
  std::string task, json, method, solver;
  double time_limit = 600.0;
  std::string gap = "0 %";
  std::uint64_t seed = 1;
  bool solver_given = false;
  std::vector<std::string> native;
  bool no_certificate = false, baselines = false, no_baselines = false;
  double certificate_max = certificate_max_default;
  int threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
};

/// Unasked beside a design: what is found in a moment.
void print_quick_baselines(const DesignResult& design, double seconds) {
  constexpr double at_most = 1.0;
  if (seconds <= 0.0) return;
  fmt::print("\nbeside filters that controllers have (--baselines: all, and at a shorter period){}",
             study::baseline_text(study::compare_with_baselines(design, std::min(at_most, seconds))));
}

/// Two tables, that of the task's period with the design that is there; the first gets half of what is left.
void print_baselines(const Task& task, const DesignResult& design, DesignOptions options, double left) {
  const auto began = std::chrono::steady_clock::now();
  options.certificate = false;
  options.time_limit = 0.5 * left;
  const auto here =
      task.filter ? study::compare_with_baselines(task, options) : study::compare_with_baselines(design, task, options);
  options.time_limit = left - seconds_since(began);
  const auto quarter = study::compare_with_baselines(study::at_shorter_period(task, 4), options);
  fmt::print("{}", study::baseline_text(here, quarter));
}

/// What a time limit leaves for the search: not what was spent on reading, nor what simulating the design and writing
/// it takes. Of few corners neither is worth mentioning, of very many it is said.
double search_seconds(const Task& task, double limit, double reading, bool quiet) {
  if (task.corners.size() < 1000) return limit;
  const double delivery = 1.2e-5 * static_cast<double>(task.corners.size());
  const double search = std::max(0.2 * limit, limit - reading - delivery);
  if (!quiet && reading + delivery > std::max(0.1, 0.05 * limit)) {
    fmt::print(stderr, "{} corners took {:.2g} s to read; simulating and writing the answer take about {:.2g} s; ",
               task.corners.size(), reading, delivery);
    fmt::print(stderr, "the search gets {:.2g} of the {:g} s\n", search, limit);
  }
  return search;
}

void run(const Arguments& arguments, Context& context) {
  const auto began = std::chrono::steady_clock::now();
  const Task task = read_task(arguments.task);
  require_outputs({arguments.json}, {arguments.task});

  DesignOptions options;
  // Naming a solver is asking for it.
  if (arguments.solver_given && arguments.method == "exact") {
    throw std::invalid_argument("--method exact and --solver exclude each other: a solver is used by --method nlp");
  }
  options.method = arguments.method == "nlp" || arguments.solver_given ? Method::nlp : Method::exact;
  if (arguments.solver_given) options.solver = arguments.solver;
  if (!arguments.native.empty() && (options.method == Method::exact || task.filter)) {
    throw std::invalid_argument(
        task.filter ? "--option: the filter is given, so its delays are enumerated and no solver is used"
                    : "--option NAME=VALUE goes with --solver: the exact method takes none");
  }
  if (task.filter && arguments.solver_given && !context.quiet) {
    fmt::print(stderr, "the filter is given: its delays are enumerated, {} is not used\n", options.solver);
  }
  options.time_limit = search_seconds(task, arguments.time_limit, seconds_since(began), context.quiet);
  // A third of it each for the design and the two tables.
  if (arguments.baselines) options.time_limit /= 3.0;
  options.gap = fraction(arguments.gap).value_or(0.0);
  if (options.gap > 0.0 && options.method == Method::nlp) {
    throw std::invalid_argument("--gap goes with the exact method: no other proves a bound");
  }
  options.solver_options.seed = arguments.seed;
  options.certificate = !arguments.no_certificate;
  options.threads = arguments.threads;
  for (const std::string& pair : arguments.native) {
    const auto equals = pair.find('=');
    if (equals == std::string::npos)
      throw std::invalid_argument(fmt::format("--option takes NAME=VALUE, got \"{}\"", pair));
    options.solver_options.native[pair.substr(0, equals)] = pair.substr(equals + 1);
  }
  options.cancel = &Interrupt::asked();
  const Interrupt interrupt;
  const DesignResult result = [&] {
    StatusLine status(context.quiet, StatusLine::Lines::news, options.time_limit);
    DesignOptions told = options;
    if (!context.quiet) told.progress = [&status](const std::string& line) { status.tell(line); };
    return design_task(task, told);
  }();

  context.exit_code = deliver(result, arguments.json, context, arguments.certificate_max);
  if (!context.quiet && arguments.json != "-") {
    if (result.filter && !task.filter && !arguments.baselines && !arguments.no_baselines) {
      print_quick_baselines(result, arguments.time_limit - seconds_since(began));
    }
    if (task.baseline && result.filter) fmt::print("{}", study::saving_text(*task.baseline, result));
    if (result.status == Status::infeasible) {
      fmt::print("`accdec explain {}` says how much each limit has to give.\n", arguments.task);
    }
  }
  if (arguments.baselines) print_baselines(task, result, options, arguments.time_limit - seconds_since(began));
}

}  // namespace

void add_design(CLI::App& app, Context& context) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      app.add_subcommand("design", "Choose the filter, its order and the delays that a task leaves open");
  command->add_option("task", arguments->task, "Task file")->required()->type_name("TASK.toml");
  add_json_option(*command, arguments->json);
  command
      ->add_option("--method", arguments->method,
                   "exact: proved shortest (default); nlp: by a nonlinear solver (ipopt unless --solver names one)")
      ->check(one_of({"exact", "nlp"}));
  command->add_option("--solver", arguments->solver,
                      "nonlinear solver to use (see `accdec solvers`); implies --method nlp");
  command
      ->add_option(
          "--time-limit", arguments->time_limit,
          "seconds for the whole design, then the best so far; the default is 600; with --baselines a third of it "
          "for the design, the rest for the tables")
      ->type_name("SECONDS")
      ->capture_default_str()
      ->check(positive_number());
  command
      ->add_option("--gap", arguments->gap,
                   "end once the design is proved to be within this of the shortest, 1% or 0.01 (default 0)")
      ->check([](const std::string& text) {
        return fraction(text) ? std::string() : "must be from 0 to less than 100 %, as 1% or 0.01, got " + text;
      });
  command
      ->add_option("--threads", arguments->threads,
                   "for proofs of several corners; design and proof do not depend on it (default: one a core)")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
  command->add_option("--seed", arguments->seed, "seed of solvers that draw random numbers")
      ->check([](const std::string& text) {
        const bool whole = !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
        // 19 digits always fit 64 bits.
        return whole && text.size() <= 19 ? std::string() : "must be a whole number from 0 to 10^19 - 1, got " + text;
      });
  command->add_option("--option", arguments->native, "the solver's own option, NAME=VALUE; may be repeated");
  const auto all = command->add_flag(
      "--baselines", arguments->baselines,
      "search the best that filters of common controllers do to the end, at the task's sample period and a quarter of "
      "it; without this what is found at the task's in a second. [baseline] in the task names the filter in use today");
  command->add_flag("--no-baselines", arguments->no_baselines, "print no such table")->excludes(all);
  command->add_flag("--no-certificate", arguments->no_certificate, "leave the proof out of the result");
  command
      ->add_option("--certificate-max", arguments->certificate_max, "MB; a larger proof is left out of the file (50)")
      ->check(number_between(0.0, 1e6));
  command->callback([arguments, command, &context] {
    arguments->solver_given = command->count("--solver") > 0;
    run(*arguments, context);
  });
}

}  // namespace accdec::cli
