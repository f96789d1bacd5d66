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

void print_baselines(const Task& task, DesignOptions options) {
  options.certificate = false;
  const auto here = study::compare_with_baselines(task, options);
  const auto quarter = study::compare_with_baselines(study::at_shorter_period(task, 4), options);
  fmt::print("{}", study::baseline_text(here, quarter));
}

/// About what simulating a design for the report and writing it takes, s; of few corners nothing worth mentioning.
double delivery_seconds(const Task& task) {
  return 2e-5 * static_cast<double>(task.corners.size());
}

void run(const Arguments& arguments, Context& context) {
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
  options.time_limit = std::max(0.5 * arguments.time_limit, arguments.time_limit - delivery_seconds(task));
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
  const auto began = std::chrono::steady_clock::now();
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
      const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - began;
      print_quick_baselines(result, arguments.time_limit - taken.count());
    }
    if (task.baseline && result.filter) fmt::print("{}", study::saving_text(*task.baseline, result));
    if (result.status == Status::infeasible) {
      fmt::print("`accdec explain {}` says how much each limit has to give.\n", arguments.task);
    }
  }
  if (arguments.baselines) print_baselines(task, options);
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
      ->add_option("--time-limit", arguments->time_limit,
                   "seconds for the whole design, then the best so far; the default is 600")
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
