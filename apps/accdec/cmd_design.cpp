#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include <accdec/design.hpp>
#include <accdec/design/design_settings.hpp>
#include <accdec/files.hpp>
#include <accdec/files/output_files.hpp>
#include <accdec/files/shown_text.hpp>
#include <accdec/formats/controller_file.hpp>
#include <accdec/study/baseline_table.hpp>
#include <accdec/task.hpp>

#include "interrupt.hpp"
#include "option_checks.hpp"
#include "output.hpp"
#include "status_line.hpp"

namespace accdec::cli {
namespace {

struct DesignArguments {
  std::string task, json, method, solver;
  std::optional<double> time_limit;  // s
  std::string gap = "0 %";
  std::uint64_t seed = 1;
  bool solver_given = false;
  std::vector<std::string> native;
  bool no_certificate = false, baselines = false, no_baselines = false;
  double certificate_max = certificate_max_default;
  int threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
};

/// Beyond the orders that a task allows by itself, a proof can take hours: the first answers come within 10 s.
constexpr double patient_limit = 600.0, brief_limit = 9.0;  // s

bool is_brief(const DesignArguments& arguments, const Task& task) {
  return !arguments.time_limit && !arguments.baselines && task.design.order_max > DesignBounds{}.order_max;
}

/// Half of what is left is for the table of the task's period, the rest for that of a shorter one.
study::BaselineTable full_table(const Task& task, const DesignResult& design, DesignOptions options, double left) {
  options.exact.certificate = false;
  options.time_limit = 0.5 * left;
  return task.filter ? study::compare_with_baselines(task, options)
                     : study::compare_with_baselines(design, task, options);
}

void print_full_tables(const study::BaselineTable& here, const Task& task, DesignOptions options, double left) {
  options.exact.certificate = false;
  options.time_limit = left;
  const auto quarter = study::compare_with_baselines(study::at_shorter_period(task, 4), options);
  fmt::print("{}", study::baseline_text(here, quarter));
}

/// The part of a time limit that is left for the search: without the time spent on reading, and without the time for
/// simulating and writing the design. With few corners neither matters; with very many it is printed.
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

/// The options of the search except its time, from the command line. Throws std::invalid_argument for options that
/// exclude each other.
DesignOptions asked_options(const DesignArguments& arguments, const Task& task, bool quiet) {
  DesignOptions options;
  // Naming a solver is asking for it.
  if (arguments.solver_given && arguments.method == "exact") {
    throw std::invalid_argument("--method exact and --solver exclude each other: a solver is used by --method nlp");
  }
  options.method = arguments.method == "nlp" || arguments.solver_given ? Method::nlp : Method::exact;
  if (arguments.solver_given) options.nlp.solver = arguments.solver;
  if (!arguments.native.empty() && (options.method == Method::exact || task.filter)) {
    throw std::invalid_argument(
        task.filter ? "--option: the filter is given, so its delays are enumerated and no solver is used"
                    : "--option NAME=VALUE goes with --solver: the exact method takes none");
  }
  if (task.filter && arguments.solver_given && !quiet) {
    fmt::print(stderr, "the filter is given: its delays are enumerated, {} is not used\n", options.nlp.solver);
  }
  options.exact.gap = fraction(arguments.gap).value_or(0.0);
  if (options.exact.gap > 0.0 && options.method == Method::nlp) {
    throw std::invalid_argument("--gap goes with the exact method: no other proves a bound");
  }
  options.nlp.options.seed = arguments.seed;
  options.exact.certificate = !arguments.no_certificate;
  options.exact.threads = arguments.threads;
  for (const std::string& pair : arguments.native) {
    const auto equals = pair.find('=');
    if (equals == std::string::npos)
      throw std::invalid_argument(fmt::format("--option takes NAME=VALUE, got \"{}\"", pair));
    options.nlp.options.native[pair.substr(0, equals)] = pair.substr(equals + 1);
  }
  options.cancel = &Interrupt::asked();
  return options;
}

/// @throws InputError for a given filter with delays that are designed with free taps
void require_taps_to_design(const std::string& file, const Task& task) {
  if (task.filter && task.settings && !task.settings->names_family() && !task.settings->any_delay())
    throw error_at_delays(file,
                          "[controller] delays names kinds of delays for free taps, and a given [filter] has no taps "
                          "to design; leave out either");
}

/// Whether every setting of the task's control was looked at, and none holds all limits.
bool no_setting_holds(const DesignResult& result) {
  return result.solver.name == "families" && !result.has_design() && result.stop == StopReason::finished;
}

std::string explain_hint(const std::string& task) {
  return fmt::format("`accdec explain {}` says which change of a limit makes a design possible.\n", shell_quoted(task));
}

void run(const DesignArguments& arguments, Context& context) {
  const auto began = std::chrono::steady_clock::now();
  const Task task = read_task(arguments.task, {.response = Considered::all});
  warn(task, arguments.task, context);
  require_outputs({arguments.json}, {arguments.task});
  require_taps_to_design(arguments.task, task);
  DesignOptions options = asked_options(arguments, task, context.quiet);
  const bool brief = is_brief(arguments, task);
  const double limit = arguments.time_limit.value_or(brief ? brief_limit : patient_limit);
  options.time_limit = search_seconds(task, limit, seconds_since(began), context.quiet);
  // A third of it each for the design and the two tables.
  if (arguments.baselines) options.time_limit /= 3.0;
  const Interrupt interrupt;
  DesignResult result = [&] {
    StatusLine status(context.quiet, StatusLine::Lines::news, options.time_limit);
    DesignOptions told = options;
    if (!context.quiet) told.progress = [&status](const std::string& line) { status.tell(line); };
    return design_task(task, told);
  }();
  if (brief && result.stop == StopReason::time_limit) {
    result.message += fmt::format(" ({:g} s, the limit of orders above {}; --time-limit gives more)", brief_limit,
                                  DesignBounds{}.order_max);
  }

  const bool shown = !context.quiet && arguments.json != "-";
  if (no_setting_holds(result)) {
    // As for bad input, nothing is written.
    std::fprintf(stderr, "%s\n", error_at_family(arguments.task, result.message).what());
    if (shown) fmt::print(stderr, "{}", explain_hint(arguments.task));
    context.exit_code = exit_no_answer;
    return;
  }
  const auto left = [&] { return limit - seconds_since(began); };
  std::optional<study::BaselineTable> table;
  if (arguments.baselines) {
    table = full_table(task, result, options, left());
  } else if (result.filter && !task.filter && !result.settings && (shown || task.baseline)) {
    // Unasked: what is found in a moment.
    const double most = arguments.no_baselines ? 0.0 : 1.0;
    table = study::compare_with_baselines(result, std::clamp(left(), 0.0, most));
  }
  if (table && !control_restricts(task)) result.savings = study::savings(*table);
  context.exit_code = deliver(result, arguments.json, context, arguments.certificate_max);
  if (shown) {
    if (table && !arguments.baselines && !table->families.empty()) {
      fmt::print("\nbeside filters that controllers have (--baselines: all of them, also at a shorter period){}",
                 study::baseline_text(*table));
    }
    if (table && task.baseline && result.filter) fmt::print("{}", study::savings_text(*table));
    if (result.status == Status::infeasible) fmt::print("{}", explain_hint(arguments.task));
  }
  if (arguments.baselines) print_full_tables(*table, task, options, left());
}

}  // namespace

void add_design(CLI::App& app, Context& context) {
  auto arguments = std::make_shared<DesignArguments>();
  CLI::App* command =
      app.add_subcommand("design", "Choose the filter, its order and the delays that a task leaves open");
  command->add_option("task", arguments->task, "Task file")->required()->type_name("TASK.toml");
  add_json_option(*command, arguments->json);
  command
      ->add_option("--method", arguments->method,
                   "exact: proved shortest (default); nlp: by a nonlinear solver (ipopt unless --solver names one)")
      ->check(one_of({"exact", "nlp"}));
  command->add_option("--solver", arguments->solver,
                      "Nonlinear solver to use (see `accdec solvers`); implies --method nlp");
  command
      ->add_option("--time-limit", arguments->time_limit,
                   "Seconds for the whole command (default 600; 9 if order_max is above 400); then the best design so "
                   "far is the answer. With --baselines (default 600) the design gets a third of them, the tables the "
                   "rest")
      ->type_name("SECONDS")
      ->check(positive_number());
  command
      ->add_option(
          "--gap", arguments->gap,
          "Stop when the design is proved to be this close to the shortest time, for example 1% or 0.01 (default 0)")
      ->check([](const std::string& text) {
        return fraction(text) ? std::string() : "must be from 0 to less than 100 %, as 1% or 0.01, got " + text;
      });
  command
      ->add_option(
          "--threads", arguments->threads,
          "Threads for proofs of several corners; design and proof do not depend on it (default: one per core)")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
  command->add_option("--seed", arguments->seed, "Seed of solvers that draw random numbers")
      ->check([](const std::string& text) {
        const bool whole = !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
        // 19 digits always fit 64 bits.
        return whole && text.size() <= 19 ? std::string() : "must be a whole number from 0 to 10^19 - 1, got " + text;
      });
  command->add_option("--option", arguments->native, "The solver's own option, NAME=VALUE; may be repeated");
  const auto all =
      command->add_flag("--baselines", arguments->baselines,
                        "Search the best filters of common controllers to the end, at the task's sample period and at "
                        "a quarter of it. Without this option the search takes at most a second, at the task's period. "
                        "[baseline] in the task names the filter in use today");
  command->add_flag("--no-baselines", arguments->no_baselines, "Do not print this table")->excludes(all);
  command->add_flag("--no-certificate", arguments->no_certificate, "Leave the proof out of the result");
  command
      ->add_option("--certificate-max", arguments->certificate_max,
                   "Leave a proof of more than this many MB out of the file (default 50)")
      ->check(number_between(0.0, 1e6));
  command->callback([arguments, command, &context] {
    arguments->solver_given = command->count("--solver") > 0;
    run(*arguments, context);
  });
}

}  // namespace accdec::cli
