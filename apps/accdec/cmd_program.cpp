#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <sys/resource.h>

#include <fmt/format.h>

#include <accdec/files/output_files.hpp>
#include <accdec/files/shown_text.hpp>
#include <accdec/files/temporaries.hpp>
#include <accdec/files/text_file.hpp>
#include <accdec/formats/controller_file.hpp>
#include <accdec/formats/key_place.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/plan/emit/dialect_words.hpp>
#include <accdec/plan/emit/emit.hpp>
#include <accdec/plan/feeds/control_delay.hpp>
#include <accdec/plan/record/program_record.hpp>
#include <accdec/plan/report/samples.hpp>
#include <accdec/plot/figure.hpp>
#include <accdec/program.hpp>
#include <accdec/task.hpp>

#include "interruptible_plan.hpp"
#include "option_checks.hpp"
#include "output.hpp"
#include "program_figure.hpp"
#include "status_line.hpp"

namespace accdec::cli {
namespace {

constexpr const char* no_per_leg =
    "plan per-leg was removed: it was not faster than plan fixed with a filter that suits the program; leave out "
    "[filter] to have one designed";

struct ProgramArguments {
  std::string program, task, json, delays, samples, emit, dwell_axis, figure, stream;
  std::string plan = "fixed", feeds = "choose", view = "auto";
  std::vector<std::string> controls, control_options;
  std::optional<double> arc_tolerance_um, tool_length_mm;
  ProgramFileOptions file;
  std::size_t worst = 5;
  bool per_leg = false;  // no more; said so
};

/// The inputs of the result, for whoever rechecks it.
ProgramInputs inputs_of(const ProgramArguments& options, const ProgramResult& result, bool interpreted) {
  ProgramInputs inputs;
  inputs.program = options.program;
  inputs.program_hash = hash_of_file(options.program);
  inputs.task_path = options.task;
  inputs.task_text = read_text_file(options.task);
  inputs.reading = result.reading;
  inputs.interpreted = interpreted;
  if (interpreted) inputs.tools = options.file.tools;
  return inputs;
}

/// How long other controls would take.
std::vector<ControlEstimate> estimates_of(const ProgramArguments& options, const Toolpath& path, const Task& task) {
  return estimate_times(path, task.machine, options.controls, named_numbers("--as-option", options.control_options));
}

/// As the answer's chords of arcs were read, so that whoever rechecks it finds the same.
void add_estimates(const ProgramArguments& options, const Task& task, ProgramResult& result) {
  if (options.controls.empty()) return;
  ProgramFileOptions as_answered = options.file;
  as_answered.arc_tolerance = result.reading.read.arc_tolerance;
  result.estimates = estimates_of(options, read_program_file(options.program, task, as_answered, {}).path, task);
}

void check_options(const ProgramArguments& options) {
  if (!options.controls.empty() && options.file.fixed.dwells_before_filter)
    throw std::invalid_argument("--as excludes --dwells-before-filter: other controls stop for G4");
  if (options.per_leg) throw std::invalid_argument(no_per_leg);
  const bool positions = options.plan != "fixed";
  const auto refuse = [&](const std::string& value, bool belongs, const char* name, const char* which) {
    if (!value.empty() && !belongs) throw std::invalid_argument(std::string(name) + " needs --plan " + which);
  };
  refuse(options.delays, !positions, "--delays", "fixed");
  refuse(options.emit, !positions, "--emit", "fixed");
  refuse(options.stream, positions, "--stream", "profiles or free");
  if (options.file.fixed.compensate_arcs && options.feeds == "keep") {
    throw std::invalid_argument("--compensate-arcs needs --feeds choose");
  }
}

/// Whether the task's control holds tolerances by lower feeds alone.
bool only_runs_on(const Task& task) {
  return task.settings && runs_on(control_of(task, 0.0));
}

/// @throws InputError for free taps beside other families, and for a control whose delays --feeds keep does not give
void require_delays(const ProgramArguments& options, const Task& task) {
  try {
    if (task.settings) require_planned_taps(*task.settings);
  } catch (const std::invalid_argument& why) {
    throw error_at_family(options.task, why.what());
  }
  if (options.plan != "fixed" || options.feeds != "keep" || !only_runs_on(task)) return;
  if (task.settings->names(DelayKind::continuous)) return;
  throw error_at_delays(options.task,
                        "`delays` = \"corner-feed\" lowers the feed at corners, and --feeds keep commands the "
                        "programmed feeds; allowed are --feeds choose, or another kind beside it: continuous, "
                        "exact-stop, in-position, dwell, timed-axis");
}

/// @throws InputError for a control whose programs nobody knows to write, or that delays in another way
void require_words(const ProgramArguments& options, const Task& task) {
  if (options.emit.empty() || !task.settings) return;
  if (!options.dwell_axis.empty()) {
    if (task.settings->any_delay()) return;
    throw error_at_delays(options.task,
                          "`delays` has no \"timed-axis\", by which programs of --dwell-axis delay; without "
                          "that option --emit writes the control's own program");
  }
  try {
    require_dwells(*task.settings);
  } catch (const std::invalid_argument& why) {
    throw error_at_delays(options.task, why.what());
  }
  try {
    require_dialect(*task.settings);
  } catch (const std::invalid_argument& why) {
    throw error_at_controller(options.task, why.what());
  }
}

/// Says so where --samples writes more than a gigabyte: about 26 bytes an axis and 12 for the time, every sample.
void warn_of_size(const std::string& file, double samples, std::size_t axes) {
  const double bytes = samples * (12.0 + 26.0 * static_cast<double>(axes));
  if (!file.empty() && bytes > 1e9)
    std::fprintf(stderr, "--samples %s: about %.1f GB, %.3g samples\n", printable(file).c_str(), 1e-9 * bytes, samples);
}

std::int64_t peak_memory() {
  rusage usage{};
  return getrusage(RUSAGE_SELF, &usage) == 0 ? static_cast<std::int64_t>(usage.ru_maxrss) * 1024 : 0;
}

/// The requested plan. None if no filter holds; a line then says so.
std::optional<ProgramResult> plan_with(const ProgramArguments& options, Context& context, ProgramFile file,
                                       const Task& task) {
  std::optional<ProgramResult> result;
  if (options.file.plan == PlanKind::free) {
    result = interruptible_plan(options.file, context.quiet, std::move(file), task);
  } else {
    const bool given = options.file.plan == PlanKind::fixed && task.filter;
    StatusLine status(context.quiet, given ? StatusLine::Lines::none : StatusLine::Lines::news);
    result = run_program_file(std::move(file), task, options.file, [&](const std::string& line) { status.tell(line); });
  }
  if (result->plan.empty()) {
    std::string why = result->message;
    if (only_runs_on(task))
      why = error_at_delays(options.task, why).what();
    else if (task.settings && task.settings->names_family())
      why = error_at_family(options.task, why).what();
    std::fprintf(stderr, "%s\n", why.c_str());
    context.exit_code = exit_no_answer;
    return {};
  }
  result->worst_shown = options.worst;
  result->peak_memory = peak_memory();
  return result;
}

/// The large files first, beside their targets; everything gets its name only when all is written. A motion for a
/// controller that takes positions is only written where it holds: nothing behind it would slow it down.
void write_outputs(const ProgramArguments& options, const Context& context, const ProgramResult& result,
                   const std::string& json, const std::string& figure) {
  std::vector<OutputFile> large;
  warn_of_size(options.samples, result.cycle_time / result.sample_period, result.plan.path.dimensions());
  const bool motion = result.verification.feasible || result.plan.command() != nullptr;
  const auto write = [&](const std::string& name, bool wanted, const auto& content) {
    if (name.empty() || !wanted) return;
    content(large.emplace_back(name).stream());
    large.back().close();
  };
  write(options.samples, motion, [&](std::ostream& out) { write_samples(result, out); });
  write(options.stream, result.verification.feasible, [&](std::ostream& out) { stream_samples(result, out); });
  if (!options.emit.empty() && !result.verification.feasible)
    std::fprintf(stderr, "--emit: nothing is written, because no control may run a plan that breaks a limit\n");
  write(options.emit, result.verification.feasible, [&](std::ostream& out) {
    if (options.dwell_axis.empty())
      emit_program(result, out);
    else
      emit_for_linuxcnc(result, options.dwell_axis.front(), out);
  });
  OutputFiles files;
  if (!options.json.empty()) files.add(options.json, json);
  if (!options.delays.empty()) files.add(options.delays, delays_to_csv(result));
  if (!options.figure.empty() && motion) files.add(options.figure, figure);
  say_on_signals("");
  files.commit();
  for (OutputFile& file : large) file.commit();
  bool stdout_taken = false;
  for (const std::string& name : {options.json, options.delays, options.samples, options.emit, options.stream})
    stdout_taken = stdout_taken || name == "-";
  if (!motion) std::fprintf(stderr, "%s\n", result.message.c_str());
  if (!context.quiet && !stdout_taken) std::fputs(program_summary(result).c_str(), stdout);
}

/// Says how much slower than its bound a plan is, if by much.
void say_what_ended(const ProgramResult& result, const ProgramFileOptions& options) {
  const double ratio = result.lower_bound > 0.0 ? result.cycle_time / result.lower_bound : 1.0;
  std::fputs("the time limit ended the search: a longer --time-limit may find a faster plan\n", stderr);
  const double passed = -options.deadline.left(), limit = options.time_limit.value_or(0.0);
  if (!options.deadline.asked_to_end() && passed > 0.1 + 0.1 * limit) {
    fmt::print(stderr,
               "it was exceeded by {:.1f} s: reading the program, one plan of it and its check are never cut short\n",
               passed);
  }
  if (ratio > 2.0) fmt::print(stderr, "this plan takes {:.3g} times the bound way over feed\n", ratio);
}

void run(ProgramArguments& options, Context& context) {
  check_options(options);
  const std::string figure_type = options.figure.empty() ? "" : figure_format(options.figure);
  const Task task =
      read_task(options.task,
                {.require_corners = false, .axes = static_cast<int>(program_axis_count), .response = Considered::all});
  warn(task, options.task, context);
  require_delays(options, task);
  require_words(options, task);
  require_outputs({options.json, options.delays, options.samples, options.emit, options.figure, options.stream},
                  {options.program, options.task, options.file.tools.table});
  options.file.plan = plan_kind(options.plan);
  options.file.fixed.feeds = options.feeds == "keep" ? Feeds::keep : Feeds::choose;
  if (options.tool_length_mm) options.file.tools.length = *options.tool_length_mm * 1e-3;
  if (options.file.time_limit) options.file.deadline = Deadline(*options.file.time_limit);
  if (options.arc_tolerance_um) options.file.arc_tolerance = *options.arc_tolerance_um * 1e-6;
  say_on_signals("\nstopped: no file is written\n");
  ProgramFile file = read_program_file(options.program, task, options.file, [&](const std::string& line) {
    if (!context.quiet) std::fprintf(stderr, "%s\n", line.c_str());
  });
  const Toolpath programmed = figure_type.empty() ? Toolpath{} : file.path;
  const std::vector<ControlEstimate> estimates = estimates_of(options, file.path, task);
  const bool interpreted = file.interpreted;
  std::optional<ProgramResult> planned;
  try {
    planned = plan_with(options, context, std::move(file), task);
  } catch (const RefusedKey& refused) {
    throw error_at_key(options.task, refused);
  }
  if (!planned) {
    for (const ControlEstimate& estimate : estimates) std::fputs(estimate_text(estimate, 0.0).c_str(), stdout);
    return;
  }
  add_estimates(options, task, *planned);
  const ProgramResult& result = *planned;
  write_outputs(options, context, result,
                options.json.empty() ? "" : program_to_json(result, inputs_of(options, result, interpreted)),
                figure_type.empty()
                    ? ""
                    : program_figure(result, programmed, task.machine, figure_type, view_from(options.view)));
  if (result.verification.feasible && options.file.deadline.over()) say_what_ended(result, options.file);
  context.exit_code = result.verification.feasible ? exit_ok : exit_no_answer;
}

void add_inputs(CLI::App& command, ProgramArguments& options) {
  command.add_option("file", options.program, "RS-274, canonical calls (rs274 -g) or CSV of points and feeds")
      ->required()
      ->type_name("FILE");
  command
      .add_option("--task", options.task,
                  "Task with the sample period, the axes and the filter. If it has no filter, one is designed")
      ->required()
      ->type_name("TASK.toml");
  command
      .add_option("--arc-tolerance-um", options.arc_tolerance_um,
                  "Largest distance of a chord from its arc. Default: a T^2/8 (how far the fastest motion leaves the "
                  "arc between two samples), from 0.1 to 2; with --feeds keep 2")
      ->type_name("UM")
      ->check(number_between(1e-3, 1e4));
  auto* const table = command
                          .add_option("--tool-table", options.file.tools.table,
                                      "LinuxCNC's tool table for G41, G42 and G43; rs274 then runs the program")
                          ->type_name("FILE");
  command.add_flag("--tool-table-inch", options.file.tools.table_in_inch, "The tool table is in inches, not in mm")
      ->needs(table);
  command
      .add_option("--tool-length", options.tool_length_mm,
                  "Length of every tool for G43, instead of a tool table; 0 if the program's Z is the tool tip")
      ->type_name("MM")
      ->check(number_between(-1e6, 1e6))
      ->excludes(table);
  command.add_flag(
      "--dwells-before-filter", options.file.fixed.dwells_before_filter,
      "Read G4 as --emit writes it: it delays the command, with an exact stop only if G61.1 or M0 asks for one");
  command.add_flag("--rapid-stops", options.file.rapid_stops, "Stop where rapid and feed moves meet");
}

void add_outputs(CLI::App& command, ProgramArguments& options) {
  add_output_option(command, "--json", options.json, "Write the result to FILE, - for standard output");
  add_output_option(command, "--delays", options.delays, "Write the delay and error of every corner as CSV");
  add_output_option(command, "--samples", options.samples, "Write the sampled motion as CSV");
  add_output_option(command, "--emit", options.emit,
                    "Write the program back with the feeds, dwells and path modes that realise the plan; its G4 must "
                    "act before the filter");
  command
      .add_option("--dwell-axis", options.dwell_axis,
                  "With --emit: for LinuxCNC, time delays by moves of this axis in G93 instead of G4. The program must "
                  "not use it")
      ->needs("--emit")
      ->check(one_of({"A", "B", "C", "U", "V", "W"}));
  add_output_option(command, "--figure", options.figure,
                    "Draw the path with its errors and speeds, the delays, the speed over time with the limits that "
                    "bind, and where time is lost. The ending is .svg, .png or .pdf; .html makes a page with zoom");
  add_view_option(command, options.view);
  add_output_option(command, "--stream", options.stream,
                    "With --plan profiles or free: write the positions, one line per cycle, - for standard output");
  command
      .add_option("--as", options.controls,
                  "Also estimate how long another control needs, by the rules of its own planner; may be repeated")
      ->type_name("CONTROL")
      ->allow_extra_args(false)
      ->check(one_of(estimated_controls()));
  command
      .add_option("--as-option", options.control_options,
                  "A parameter of that control under its own name and in its own unit, such as "
                  "square_corner_velocity=8; the answer lists all with their values; may be repeated")
      ->type_name("NAME=NUMBER")
      ->allow_extra_args(false)
      ->needs("--as");
  command.add_option("--worst", options.worst, "How many corners to list: those that use most of their tolerance")
      ->check(CLI::Range(0, 10000))
      ->type_name("N")
      ->capture_default_str();
}

void add_planning(CLI::App& command, ProgramArguments& options) {
  options.file.free.threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  command
      .add_option("--time-limit", options.file.time_limit,
                  "Seconds for the whole command; half of them goes to the search for a filter. Without this option, "
                  "the search has 2 s plus 5 ms per block, at most 60 s. A search for a control's settings ends after "
                  "the work of so many seconds, or of a third of this limit, and by the clock after half of it. The "
                  "plan of what was found then takes as long as it needs")
      ->check(positive_number());
  command
      .add_option("--plan", options.plan,
                  "fixed: one filter for the whole program. profiles: a filter and a speed for every corner, for "
                  "controllers that take a position every cycle (--samples, --stream). profiles also makes the plan "
                  "fixed, and motions along the arcs, whose plan is free. It returns the fastest one, by name. free: "
                  "begins with the fastest one and shortens windows of its samples as far as limits, feeds and "
                  "tolerances allow. It ends when nothing is gained, at --time-limit or at Ctrl-C")
      ->check([](const std::string& plan) { return std::string(plan == "per-leg" ? no_per_leg : ""); })
      ->check(one_of(plan_names()))
      ->capture_default_str();
  command
      .add_option("--feeds", options.feeds,
                  "choose: F is an upper bound; feeds of blocks and steps of feed inside blocks are chosen. keep: "
                  "every block has its programmed feed (only with --plan fixed)")
      ->check(one_of({"choose", "keep"}))
      ->capture_default_str();
  command.add_option("--threads", options.file.free.threads, "Threads for --plan free (default: one per core)")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
  command.add_flag("--compensate-arcs", options.file.fixed.compensate_arcs,
                   "Command arcs on a radius larger by the filter's radius error, v^2 s^2/(2 R); errors are measured "
                   "from the programmed arc");
  command.add_flag("--per-leg", options.per_leg)->group("");
  command.add_flag(
      "--filter-bound", options.file.fixed.filter_bound,
      "Also print a lower bound of the time at the programmed feeds. It holds for all filters that keep the "
      "acceleration limits and are no longer than a block, with any delays. There is none if a block is shorter "
      "than every such filter");
}

}  // namespace

void add_program(CLI::App& app, Context& context) {
  const auto options = std::make_shared<ProgramArguments>();
  CLI::App* command = app.add_subcommand(
      "program", "Plan a whole toolpath: choose feeds, filters and delays, simulate and verify every sample");
  add_inputs(*command, *options);
  add_outputs(*command, *options);
  add_planning(*command, *options);
  command->callback([options, &context] { run(*options, context); });
}

}  // namespace accdec::cli
