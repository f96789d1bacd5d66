#include <algorithm>
#include <cstdio>
#include <filesystem>
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
#include <accdec/plot/plot_program.hpp>
#include <accdec/plot/program_page.hpp>
#include <accdec/program/plan/design_program.hpp>
#include <accdec/program/read/interpreter.hpp>
#include <accdec/program/read/read_error.hpp>
#include <accdec/program/write/fastest_plan.hpp>
#include <accdec/program/write/program_report.hpp>
#include <accdec/program/write/samples.hpp>

#include "option_checks.hpp"
#include "output.hpp"
#include "program_profiles.hpp"
#include "status_line.hpp"

namespace accdec::cli {
namespace {

struct Options {
  std::string program, task, json, delays, samples, emit, figure, stream;
  std::string plan = "fixed", feeds = "choose", tool_table;
  double arc_tolerance_um = 2.0;
  std::optional<double> time_limit;
  std::size_t worst = 5;
  bool rapid_stops = false, dwells_before_filter = false, per_leg = false, filter_bound = false;
};

/// What the result is made from, for whoever rechecks it.
ProgramInputs inputs_of(const Options& options, const ToolpathOptions& reading, bool interpreted) {
  ProgramInputs inputs;
  inputs.program = options.program;
  inputs.program_hash = hash_of_file(options.program);
  inputs.task_path = options.task;
  inputs.task_text = read_text_file(options.task);
  inputs.reading = reading;
  inputs.interpreted = interpreted;
  return inputs;
}

/// By our own reader, or where only an interpreter of the whole language understands the program, through rs274.
Toolpath read(const Options& options, const Task& task, const ToolpathOptions& reading, bool& interpreter_used) {
  try {
    LineSource source{std::filesystem::path(options.program)};
    Toolpath path = read_toolpath(source, task.machine, reading);
    if (source.byte_order_mark()) {
      std::fprintf(stderr, "%s: begins with a byte order mark, which is passed over\n", options.program.c_str());
    }
    return path;
  } catch (const NeedsInterpreter& reason) {
    std::string calls;
    try {
      calls = interpreted(options.program, options.tool_table);
    } catch (const std::invalid_argument& refused) {
      throw std::invalid_argument(std::string(reason.what()) + "\n" + refused.what());
    }
    std::fprintf(stderr, "%s: run by rs274; lines are those of its output\n", reason.what());
    interpreter_used = true;
    LineSource source(options.program + " (rs274 -g)", calls);
    return read_toolpath(source, task.machine, reading);
  }
}

ProgramFilter choose_filter(const Options& options, const Context& context, const Toolpath& path, const Task& task,
                            Feeds feeds) {
  if (task.filter) {
    ProgramFilter given;
    given.filter = make_filter(*task.filter);
    given.solver.method = "given";
    return given;
  }
  StatusLine status(context.quiet);
  const auto progress = [&](const std::string& line) { status.tell(line); };
  // Small programs are not worth a minute.
  const double limit = options.time_limit.value_or(std::min(60.0, 2.0 + 5e-3 * static_cast<double>(path.blocks())));
  return feeds == Feeds::keep ? design_program_filter(path, task, limit, progress)
                              : design_filter_for_feeds(path, task, limit, progress);
}

void check_outputs(const Options& options) {
  const bool profiles = options.plan == "profiles";
  const auto refuse = [&](const std::string& value, bool belongs, const char* name, const char* which) {
    if (!value.empty() && !belongs) throw std::invalid_argument(std::string(name) + " needs --plan " + which);
  };
  refuse(options.delays, !profiles, "--delays", "fixed or per-leg");
  refuse(options.emit, !profiles, "--emit", "fixed or per-leg");
  if (!options.figure.empty() && profiles && figure_format(options.figure) != "html") {
    throw std::invalid_argument("--figure needs --plan fixed or per-leg, or a name that ends in .html");
  }
  refuse(options.stream, profiles, "--stream", "profiles");
}

/// Plan profiles, and because it is never to be slower than they are, the plans of one filter and one a leg.
void run_profiles_and_others(const Options& options, Context& context, const Toolpath& path, const Task& task,
                             const ProgramInputs& inputs) {
  ProgramFileOptions how;
  how.filter_bound = options.filter_bound;
  how.time_limit = options.time_limit;
  const auto fastest = [&] {
    StatusLine status(context.quiet);
    return run_fastest_plan(options.program, path, options.arc_tolerance_um * 1e-6, task, how,
                            [&](const std::string& line) { status.tell(line); });
  }();
  write_fastest(fastest, inputs, path, task.machine, {options.json, options.samples, options.stream, options.figure},
                context);
}

std::string figure_of(const Options& options, const Task& task, const Toolpath& programmed, const ProgramResult& result,
                      const std::string& type) {
  if (type == "html") {
    const std::string title = fmt::format("{}: {:.6g} s, plan {}", options.program, result.cycle_time,
                                          result.legs.single() ? "fixed" : "per-leg");
    return program_page(
        programmed, program_machine(task.machine, programmed),
        {title, result.sample_period, [&](const SampleVisitor& visit) { visit_samples(result, visit); }});
  }
  const Figure figure = plot_program(result);
  return convert_svg(render_svg(figure), type, figure.title);
}

void run(const Options& options, Context& context) {
  check_outputs(options);
  const std::string figure_type = options.figure.empty() ? "" : figure_format(options.figure);
  const Task task = read_task(options.task, {.require_corners = false, .axes = static_cast<int>(program_axis_count)});
  require_outputs({options.json, options.delays, options.samples, options.emit, options.figure, options.stream},
                  {options.program, options.task, options.tool_table});
  const bool per_leg = options.per_leg || options.plan == "per-leg";
  const Feeds feeds = options.feeds == "keep" ? Feeds::keep : Feeds::choose;
  ToolpathOptions reading;
  reading.read.arc_tolerance = options.arc_tolerance_um * 1e-6;
  reading.error_max = task.program_error_max;
  reading.clamp_feeds = feeds == Feeds::choose;
  reading.rapid_stops = options.rapid_stops;
  reading.dwells_before_filter = options.dwells_before_filter;
  bool interpreted = false;
  Toolpath path = read(options, task, reading, interpreted);
  ProgramInputs inputs;
  if (!options.json.empty()) inputs = inputs_of(options, reading, interpreted);
  if (options.plan == "profiles") {
    run_profiles_and_others(options, context, path, task, inputs);
    return;
  }
  const ProgramFilter choice = choose_filter(options, context, path, task, feeds);
  if (!choice.filter) {
    std::fprintf(stderr, "%s\n", choice.message.c_str());
    context.exit_code = exit_no_answer;
    return;
  }
  const Toolpath programmed = figure_type == "html" ? path : Toolpath{};
  ProgramResult result = [&] {
    StatusLine status(context.quiet, StatusLine::Lines::none);
    status.tell("planning and simulating");
    return run_program(options.program, std::move(path), *choice.filter, task, per_leg, options.filter_bound, feeds);
  }();
  result.worst_shown = options.worst;
  const double planning = result.solver.wall_time;
  result.solver = choice.solver;
  result.solver.wall_time += planning;
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) == 0) result.peak_memory = static_cast<std::int64_t>(usage.ru_maxrss) * 1024;
  // The large ones first, beside their targets; everything gets its name only when all is written.
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
  if (!options.json.empty()) files.add(options.json, program_to_json(result, inputs));
  if (!options.delays.empty()) files.add(options.delays, delays_to_csv(result));
  if (!options.figure.empty()) {
    files.add(options.figure, figure_of(options, task, programmed, result, figure_type));
  }
  files.commit();
  for (OutputFile& file : large) file.commit();

  const bool stdout_taken =
      options.json == "-" || options.delays == "-" || options.samples == "-" || options.emit == "-";
  if (!context.quiet && !stdout_taken) std::fputs(program_summary(result).c_str(), stdout);
  context.exit_code = result.verification.feasible ? exit_ok : exit_no_answer;
}

}  // namespace

void add_program(CLI::App& app, Context& context) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "program", "A whole toolpath: the smallest delay of every corner, verified by simulating every sample");
  command->add_option("file", options->program, "RS-274, canonical calls (rs274 -g) or CSV of points and feeds")
      ->required()
      ->type_name("FILE");
  command
      ->add_option("--task", options->task,
                   "Task with the sample period, the axes and the filter; without filter one is designed")
      ->required()
      ->type_name("TASK.toml");
  add_output_option(*command, "--json", options->json, "Write the result to FILE, - for standard output");
  add_output_option(*command, "--delays", options->delays, "Write the delay and error of every corner as CSV");
  add_output_option(*command, "--samples", options->samples, "Write the sampled motion as CSV");
  add_output_option(*command, "--emit", options->emit,
                    "Write the program back with the feeds, dwells and path modes that realise the plan; its G4 must "
                    "act before the filter");
  add_output_option(*command, "--figure", options->figure,
                    "Draw the path by its errors and a histogram of the delays, .svg, .png or .pdf; or .html: one page "
                    "that zooms into the path, coloured by speed, and says where time is lost");
  command->add_option("--arc-tolerance-um", options->arc_tolerance_um, "Largest distance of a chord from its arc")
      ->type_name("UM")
      ->check(number_between(1e-3, 1e4))
      ->capture_default_str();
  command
      ->add_option("--time-limit", options->time_limit,
                   "s, for the design of a filter where the task has none; default 2 s and 5 ms a block, at most 60")
      ->check(positive_number());
  command
      ->add_option("--plan", options->plan,
                   "fixed: one filter for the whole program; per-leg: the filter of each leg follows what the limits "
                   "allow in its direction, where that is faster; profiles: every corner its own filter and speed, for "
                   "controllers that take a position every cycle (--samples, --stream); never slower than the others, "
                   "which are made beside it")
      ->check(one_of({"fixed", "per-leg", "profiles"}))
      ->capture_default_str();
  command
      ->add_option(
          "--feeds", options->feeds,
          "choose: F is an upper bound, feeds and steps of feed inside blocks are chosen; keep: every block at "
          "its programmed feed")
      ->check(one_of({"choose", "keep"}))
      ->capture_default_str();
  add_output_option(*command, "--stream", options->stream,
                    "With --plan profiles: one line a cycle of positions, - for standard output");
  command->add_option("--tool-table", options->tool_table, "LinuxCNC's, for programs that rs274 has to run")
      ->type_name("FILE");
  command->add_option("--worst", options->worst, "How many corners to list by the use of their tolerance")
      ->check(CLI::Range(0, 10000))
      ->type_name("N")
      ->capture_default_str();
  command->add_flag("--per-leg", options->per_leg, "The same as --plan per-leg");
  command->add_flag(
      "--dwells-before-filter", options->dwells_before_filter,
      "Read G4 as --emit writes it: a delay of the command, without an exact stop unless G61.1 or M0 asks for one");
  command->add_flag("--filter-bound", options->filter_bound,
                    "Also say which time no filters that keep the acceleration limits, not longer than the blocks, can "
                    "undercut with any delays");
  command->add_flag("--rapid-stops", options->rapid_stops, "Stop wherever rapid and feed moves meet");
  command->callback([options, &context] { run(*options, context); });
}

}  // namespace accdec::cli
