#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <sys/resource.h>

#include <fmt/format.h>

#include <accdec/files/output_files.hpp>
#include <accdec/files/text_file.hpp>
#include <accdec/formats/program_record.hpp>
#include <accdec/formats/task_reader.hpp>
#include <accdec/plot/figure.hpp>
#include <accdec/program/write/fastest_plan.hpp>
#include <accdec/program/write/program_file.hpp>
#include <accdec/program/write/program_report.hpp>
#include <accdec/program/write/samples.hpp>

#include "option_checks.hpp"
#include "output.hpp"
#include "program_figure.hpp"
#include "program_profiles.hpp"
#include "status_line.hpp"

namespace accdec::cli {
namespace {

struct Options {
  std::string program, task, json, delays, samples, emit, figure, stream;
  std::string plan = "fixed", feeds = "choose";
  std::optional<double> arc_tolerance_um;
  ProgramFileOptions file;
  std::size_t worst = 5;
};

/// What the result is made from, for whoever rechecks it.
ProgramInputs inputs_of(const Options& options, const ProgramFile& file) {
  ProgramInputs inputs;
  inputs.program = options.program;
  inputs.program_hash = hash_of_file(options.program);
  inputs.task_path = options.task;
  inputs.task_text = read_text_file(options.task);
  inputs.reading = file.reading;
  inputs.interpreted = file.interpreted;
  if (file.interpreted) inputs.tool_table = options.file.tool_table;
  return inputs;
}

ProgramFilter choose_filter(const Options& options, const Context& context, const Toolpath& path, const Task& task) {
  StatusLine status(context.quiet || task.filter.has_value());
  return filter_for_program(path, task, options.file, [&](const std::string& line) { status.tell(line); });
}

void check_outputs(const Options& options) {
  const bool profiles = options.plan == "profiles";
  const auto refuse = [&](const std::string& value, bool belongs, const char* name, const char* which) {
    if (!value.empty() && !belongs) throw std::invalid_argument(std::string(name) + " needs --plan " + which);
  };
  refuse(options.delays, !profiles, "--delays", "fixed or per-leg");
  refuse(options.emit, !profiles, "--emit", "fixed or per-leg");
  refuse(options.stream, profiles, "--stream", "profiles");
  if (options.file.compensate_arcs && options.feeds == "keep") {
    throw std::invalid_argument("--compensate-arcs needs --feeds choose");
  }
}

/// Plan profiles, and because it is never to be slower than they are, the plans of one filter and one a leg.
void run_profiles_and_others(const Options& options, Context& context, ProgramFile& file, const Task& task) {
  const auto fastest = [&] {
    StatusLine status(context.quiet);
    return run_fastest_plan(options.program, file, task, options.file,
                            [&](const std::string& line) { status.tell(line); });
  }();
  const ProgramInputs inputs = options.json.empty() ? ProgramInputs{} : inputs_of(options, file);
  write_fastest(fastest, inputs, file.path, task.machine,
                {options.json, options.samples, options.stream, options.figure}, context);
}

/// Plans with one filter, or one a leg.
ProgramResult plan_with(const Options& options, const Context& context, ProgramFile& file, const ProgramFilter& choice,
                        const Task& task) {
  StatusLine status(context.quiet, StatusLine::Lines::none);
  status.tell("planning and simulating");
  std::optional<CornerBound> bound;
  if (file.path.blocks() <= several_plans_max) bound = corner_bound_of(file.path, task);
  ProgramResult result = plan_program_file(options.program, file, choice, task, options.file);
  result.corner_bound = bound;
  result.worst_shown = options.worst;
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) == 0) result.peak_memory = static_cast<std::int64_t>(usage.ru_maxrss) * 1024;
  return result;
}

/// The large files first, beside their targets; everything gets its name only when all is written.
void write_outputs(const Options& options, const Context& context, const ProgramResult& result, const std::string& json,
                   const std::string& figure) {
  std::vector<OutputFile> large;
  if (!options.samples.empty()) {
    write_samples(result, large.emplace_back(options.samples).stream());
    large.back().close();
  }
  if (!options.emit.empty()) {
    emit_program(result, large.emplace_back(options.emit).stream());
    large.back().close();
  }
  OutputFiles files;
  if (!options.json.empty()) files.add(options.json, json);
  if (!options.delays.empty()) files.add(options.delays, delays_to_csv(result));
  if (!options.figure.empty()) files.add(options.figure, figure);
  files.commit();
  for (OutputFile& file : large) file.commit();
  const bool stdout_taken =
      options.json == "-" || options.delays == "-" || options.samples == "-" || options.emit == "-";
  if (!context.quiet && !stdout_taken) std::fputs(program_summary(result).c_str(), stdout);
}

void run(Options& options, Context& context) {
  check_outputs(options);
  const std::string figure_type = options.figure.empty() ? "" : figure_format(options.figure);
  const Task task = read_task(options.task, {.require_corners = false, .axes = static_cast<int>(program_axis_count)});
  require_outputs({options.json, options.delays, options.samples, options.emit, options.figure, options.stream},
                  {options.program, options.task, options.file.tool_table});
  options.file.per_leg = options.file.per_leg || options.plan == "per-leg";
  options.file.feeds = options.feeds == "keep" ? Feeds::keep : Feeds::choose;
  if (options.arc_tolerance_um) options.file.arc_tolerance = *options.arc_tolerance_um * 1e-6;
  ProgramFile file = read_program_file(options.program, task, options.file,
                                       [](const std::string& line) { std::fprintf(stderr, "%s\n", line.c_str()); });
  if (options.plan == "profiles") {
    run_profiles_and_others(options, context, file, task);
    return;
  }
  const ProgramFilter choice = choose_filter(options, context, file.path, task);
  if (!choice.filter) {
    std::fprintf(stderr, "%s\n", choice.message.c_str());
    context.exit_code = exit_no_answer;
    return;
  }
  const Toolpath programmed = figure_type.empty() ? Toolpath{} : file.path;
  const ProgramResult result = plan_with(options, context, file, choice, task);
  write_outputs(options, context, result, options.json.empty() ? "" : program_to_json(result, inputs_of(options, file)),
                figure_type.empty() ? "" : program_figure(result, programmed, task.machine, figure_type));
  context.exit_code = result.verification.feasible ? exit_ok : exit_no_answer;
}

void add_inputs(CLI::App& command, Options& options) {
  command.add_option("file", options.program, "RS-274, canonical calls (rs274 -g) or CSV of points and feeds")
      ->required()
      ->type_name("FILE");
  command
      .add_option("--task", options.task,
                  "Task with the sample period, the axes and the filter; without filter one is designed")
      ->required()
      ->type_name("TASK.toml");
  command
      .add_option("--arc-tolerance-um", options.arc_tolerance_um,
                  "Largest distance of a chord from its arc; default: what an arc's fastest motion leaves of the arc "
                  "between two samples, a T^2/8, from 0.1 to 2; 2 with --feeds keep")
      ->type_name("UM")
      ->check(number_between(1e-3, 1e4));
  command.add_option("--tool-table", options.file.tool_table, "LinuxCNC's, for programs that rs274 has to run")
      ->type_name("FILE");
  command.add_flag(
      "--dwells-before-filter", options.file.dwells_before_filter,
      "Read G4 as --emit writes it: a delay of the command, without an exact stop unless G61.1 or M0 asks for one");
  command.add_flag("--rapid-stops", options.file.rapid_stops, "Stop wherever rapid and feed moves meet");
}

void add_outputs(CLI::App& command, Options& options) {
  add_output_option(command, "--json", options.json, "Write the result to FILE, - for standard output");
  add_output_option(command, "--delays", options.delays, "Write the delay and error of every corner as CSV");
  add_output_option(command, "--samples", options.samples, "Write the sampled motion as CSV");
  add_output_option(command, "--emit", options.emit,
                    "Write the program back with the feeds, dwells and path modes that realise the plan; its G4 must "
                    "act before the filter");
  add_output_option(
      command, "--figure", options.figure,
      "Draw the path by its errors and speed, the delays, the speed over time by the limit that binds and "
      "where time is lost, .svg, .png or .pdf; or .html: one page that zooms into path and speed");
  add_output_option(command, "--stream", options.stream,
                    "With --plan profiles: one line a cycle of positions, - for standard output");
  command.add_option("--worst", options.worst, "How many corners to list by the use of their tolerance")
      ->check(CLI::Range(0, 10000))
      ->type_name("N")
      ->capture_default_str();
}

void add_planning(CLI::App& command, Options& options) {
  command
      .add_option("--time-limit", options.file.time_limit,
                  "s, for the design of a filter where the task has none; default 2 s and 5 ms a block, at most 60")
      ->check(positive_number());
  command
      .add_option("--plan", options.plan,
                  "fixed: one filter for the whole program; per-leg: the filter of each leg follows what the limits "
                  "allow in its direction, where that is faster; profiles: every corner its own filter and speed, for "
                  "controllers that take a position every cycle (--samples, --stream); never slower than the others, "
                  "which are made beside it")
      ->check(one_of({"fixed", "per-leg", "profiles"}))
      ->capture_default_str();
  command
      .add_option("--feeds", options.feeds,
                  "choose: F is an upper bound, feeds and steps of feed inside blocks are chosen; keep: every block at "
                  "its programmed feed")
      ->check(one_of({"choose", "keep"}))
      ->capture_default_str();
  command.add_flag("--compensate-arcs", options.file.compensate_arcs,
                   "Command arcs on a radius larger by what the filter takes away, v^2 s^2/(2 R); errors are measured "
                   "from the programmed arc");
  command.add_flag("--per-leg", options.file.per_leg, "The same as --plan per-leg");
  command.add_flag("--filter-bound", options.file.filter_bound,
                   "Also say which time no filters that keep the acceleration limits, not longer than the blocks, can "
                   "undercut with any delays");
}

}  // namespace

void add_program(CLI::App& app, Context& context) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "program", "A whole toolpath: feeds, filters and delays chosen, every sample simulated and verified");
  add_inputs(*command, *options);
  add_outputs(*command, *options);
  add_planning(*command, *options);
  command->callback([options, &context] { run(*options, context); });
}

}  // namespace accdec::cli
