#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <sys/resource.h>

#include <accdec/files/output_files.hpp>
#include <accdec/formats/task_reader.hpp>
#include <accdec/plot/figure.hpp>
#include <accdec/plot/plot_program.hpp>
#include <accdec/program/plan/design_program.hpp>
#include <accdec/program/read/interpreter.hpp>
#include <accdec/program/read/read_error.hpp>
#include <accdec/program/write/report.hpp>

#include "output.hpp"
#include "program_profiles.hpp"

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

/// By our own reader, or where only an interpreter of the whole language understands the program, through rs274.
Toolpath read(const Options& options, const Task& task, const ToolpathOptions& reading) {
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
  const auto progress = [&](const std::string& line) {
    if (!context.quiet) std::fprintf(stderr, "%s\n", line.c_str());
  };
  // Small programs are not worth a minute.
  const double limit = options.time_limit.value_or(std::min(60.0, 2.0 + 5e-3 * static_cast<double>(path.blocks())));
  return feeds == Feeds::keep ? design_program_filter(path, task, options.time_limit.value_or(60.0), progress)
                              : design_filter_for_feeds(path, task, limit, progress);
}

void check_outputs(const Options& options) {
  const bool profiles = options.plan == "profiles";
  const auto refuse = [&](const std::string& value, bool belongs, const char* name, const char* which) {
    if (!value.empty() && !belongs) throw std::invalid_argument(std::string(name) + " needs --plan " + which);
  };
  refuse(options.delays, !profiles, "--delays", "fixed or per-leg");
  refuse(options.emit, !profiles, "--emit", "fixed or per-leg");
  refuse(options.figure, !profiles, "--figure", "fixed or per-leg");
  refuse(options.stream, profiles, "--stream", "profiles");
}

/// The path may be off a chord's end by the tolerance, and the chord off its arc by more: room for that.
void leave_room_for_arcs(Toolpath& path, double arc_tolerance) {
  const auto inside = [&](std::size_t b) { return path.inside_arc[b] != 0; };
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    const double tolerance = path.tolerance[b];
    const bool arc = inside(b) || (b > 0 && inside(b - 1)) || (b + 1 < path.blocks() && inside(b + 1));
    if (arc) path.tolerance[b] = std::max(0.5 * tolerance, tolerance - arc_tolerance);
  }
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
  Toolpath path = read(options, task, reading);
  if (options.plan == "profiles") {
    leave_room_for_arcs(path, reading.read.arc_tolerance);
    constexpr double bound_time = 10.0;  // s, for the bound by linear programmes
    write_profiles(run_profiles(options.program, std::move(path), task, bound_time),
                   {options.json, options.samples, options.stream}, context);
    return;
  }
  const ProgramFilter choice = choose_filter(options, context, path, task, feeds);
  if (!choice.filter) {
    std::fprintf(stderr, "%s\n", choice.message.c_str());
    context.exit_code = exit_no_answer;
    return;
  }
  ProgramResult result =
      run_program(options.program, std::move(path), *choice.filter, task, per_leg, options.filter_bound, feeds);
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
  if (!options.json.empty()) files.add(options.json, program_to_json(result));
  if (!options.delays.empty()) files.add(options.delays, delays_to_csv(result));
  if (!options.figure.empty()) {
    const Figure figure = plot_program(result);
    files.add(options.figure, convert_svg(render_svg(figure), figure_type, figure.title));
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
                    "Draw the path by its errors and a histogram of the delays, .svg, .png, .pdf or .html");
  command->add_option("--arc-tolerance-um", options->arc_tolerance_um, "Largest distance of a chord from its arc")
      ->type_name("UM")
      ->check(CLI::Range(1e-3, 1e4))
      ->capture_default_str();
  command
      ->add_option("--time-limit", options->time_limit,
                   "s, for the design of a filter where the task has none; default 2 s and 5 ms a block, at most 60 "
                   "(60 with --feeds keep)")
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--plan", options->plan,
                   "fixed: one filter for the whole program; per-leg: the filter of each leg follows what the limits "
                   "allow in its direction, where that is faster; profiles: every corner its own filter and speed, for "
                   "controllers that take a position every cycle (--samples, --stream)")
      ->check(CLI::IsMember({"fixed", "per-leg", "profiles"}))
      ->capture_default_str();
  command
      ->add_option(
          "--feeds", options->feeds,
          "choose: F is an upper bound, feeds and steps of feed inside blocks are chosen; keep: every block at "
          "its programmed feed")
      ->check(CLI::IsMember({"choose", "keep"}))
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
