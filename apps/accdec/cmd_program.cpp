#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>

#include <sys/resource.h>

#include <accdec/files/atomic_file.hpp>
#include <accdec/files/stream_file.hpp>
#include <accdec/formats/task_reader.hpp>
#include <accdec/plot/figure.hpp>
#include <accdec/plot/plot_program.hpp>
#include <accdec/program/plan/design_program.hpp>
#include <accdec/program/write/report.hpp>

#include "command.hpp"

namespace accdec::cli {
namespace {

struct Options {
  std::string program, task, json, delays, samples, emit, figure;
  double arc_tolerance_um = 2.0, time_limit = 60.0;
  std::size_t worst = 5;
  bool rapid_stops = false, dwells_before_filter = false, per_leg = false, filter_bound = false;
};

void run(const Options& options, Context& context) {
  const std::string figure_type = options.figure.empty() ? "" : figure_format(options.figure);
  const Task task = read_task(options.task, {.require_corners = false, .axes = static_cast<int>(program_axis_count)});
  for (const std::string& path : {options.json, options.delays, options.samples, options.emit, options.figure}) {
    if (path.empty()) continue;
    std::error_code none;
    for (const std::string& input : {options.program, options.task}) {
      // Everything is written beside its target first.
      if (std::filesystem::equivalent(path, input, none) || std::filesystem::equivalent(path + ".part", input, none))
        throw std::invalid_argument(path + " is an input: write to another file");
    }
    require_writable(path);
  }
  LineSource source{std::filesystem::path(options.program)};
  ToolpathOptions reading;
  reading.read.arc_tolerance = options.arc_tolerance_um * 1e-6;
  reading.error_max = task.program_error_max;
  reading.rapid_stops = options.rapid_stops;
  reading.dwells_before_filter = options.dwells_before_filter;
  Toolpath path = read_toolpath(source, task.machine, reading);

  ProgramFilter choice;
  if (task.filter) {
    choice.filter = make_filter(*task.filter);
    choice.solver.method = "given";
  } else {
    choice = design_program_filter(path, task, options.time_limit, [&](const std::string& line) {
      if (!context.quiet) std::fprintf(stderr, "%s\n", line.c_str());
    });
    if (!choice.filter) {
      std::fprintf(stderr, "%s\n", choice.message.c_str());
      context.exit_code = exit_no_answer;
      return;
    }
  }
  ProgramResult result =
      run_program(options.program, std::move(path), *choice.filter, task, options.per_leg, options.filter_bound);
  result.worst_shown = options.worst;
  choice.solver.wall_time += result.solver.wall_time;
  result.solver = choice.solver;
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) == 0) result.peak_memory = static_cast<std::int64_t>(usage.ru_maxrss) * 1024;
  // The large ones first, beside their targets; everything gets its name only when all is written.
  StreamFile samples, emitted;
  if (!options.samples.empty()) {
    samples.open(options.samples);
    write_samples(result, samples.stream());
    samples.close();
  }
  if (!options.emit.empty()) {
    emitted.open(options.emit);
    emit_program(result, emitted.stream());
    emitted.close();
  }
  OutputFiles files;
  if (!options.json.empty()) files.add(options.json, program_to_json(result));
  if (!options.delays.empty()) files.add(options.delays, delays_to_csv(result));
  if (!options.figure.empty()) {
    const Figure figure = plot_program(result);
    files.add(options.figure, convert_svg(render_svg(figure), figure_type, figure.title));
  }
  files.commit();
  samples.commit();
  emitted.commit();

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
  command->add_option("--json", options->json, "Write the result to FILE, - for standard output")->type_name("FILE");
  command->add_option("--delays", options->delays, "Write the delay and error of every corner as CSV")
      ->type_name("FILE");
  command->add_option("--samples", options->samples, "Write the sampled motion as CSV")->type_name("FILE");
  command
      ->add_option("--emit", options->emit,
                   "Write the program back with the feeds, dwells and path modes that realise the plan; its G4 must "
                   "act before the filter")
      ->type_name("FILE");
  command
      ->add_option("--figure", options->figure,
                   "Draw the path by its errors and a histogram of the delays, .svg, .png, .pdf or .html")
      ->type_name("FILE");
  command->add_option("--arc-tolerance-um", options->arc_tolerance_um, "Largest distance of a chord from its arc")
      ->type_name("UM")
      ->check(CLI::Range(1e-3, 1e4))
      ->capture_default_str();
  command->add_option("--time-limit", options->time_limit, "s, for the design of a filter where the task has none")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--worst", options->worst, "How many corners to list by the use of their tolerance")
      ->check(CLI::Range(0, 10000))
      ->type_name("N")
      ->capture_default_str();
  command->add_flag(
      "--per-leg", options->per_leg,
      "Let the filter of each leg follow what the axis limits allow in its direction: the given or designed filter's "
      "shape, for "
      "every leg in the length that makes the program shortest; where one filter for all is as fast, that is kept");
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
