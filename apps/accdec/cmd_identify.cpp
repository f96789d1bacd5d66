#include <memory>
#include <string>

#include <fmt/format.h>

#include <accdec/design/identify.hpp>
#include <accdec/files/output_files.hpp>
#include <accdec/formats/motion_log_file.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/plot/figure.hpp>
#include <accdec/simulate.hpp>
#include <accdec/task.hpp>

#include "option_checks.hpp"
#include "output.hpp"

namespace accdec::cli {
namespace {

struct IdentifyArguments {
  std::string log, task, out = "-", figure, units;
  std::optional<double> noise_um, feed_mm_min;
  bool prefilter = false;
};

/// Differences of log and fit, and the speed of both.
Figure figure_of(const MotionLog& log, const Identification& found, double period, const std::string& name) {
  Figure figure;
  figure.title = name;
  Panel difference, speed;
  difference.title = "log less fit";
  difference.x.label = speed.x.label = "time / ms";
  difference.y.label = "difference / um";
  speed.title = "speed of every axis";
  speed.y.label = "speed / mm/s";
  for (std::size_t a = 0; a < log.axes.size(); ++a) {
    const int style = static_cast<int>(2 * a);
    Series off{.label = log.axes[a], .x = {}, .y = {}, .mark = Mark::points, .style = style};
    Series logged{.label = log.axes[a] + ", log", .x = {}, .y = {}, .mark = Mark::points, .style = style};
    Series fitted{.label = log.axes[a] + ", fit", .x = {}, .y = {}, .mark = Mark::line, .style = style + 1};
    const std::vector<double>&at = log.position[a], &model = found.modelled[a];
    for (std::size_t k = 0; k < at.size(); ++k) {
      const double time = 1e3 * static_cast<double>(k) * period;
      off.x.push_back(time), off.y.push_back(1e6 * (at[k] - model[k]));
      if (k == 0) continue;
      logged.x.push_back(time), logged.y.push_back(1e3 * (at[k] - at[k - 1]) / period);
      fitted.x.push_back(time), fitted.y.push_back(1e3 * (model[k] - model[k - 1]) / period);
    }
    difference.series.push_back(std::move(off));
    speed.series.push_back(std::move(logged));
    speed.series.push_back(std::move(fitted));
  }
  figure.panels = {std::move(speed), std::move(difference)};
  return figure;
}

/// Smoothing is considered; every other response is refused where it stands.
Task task_of(const std::string& path) {
  TaskOptions choices{.require_corners = false, .axes = static_cast<int>(program_axis_count)};
  choices.response = Considered::all;
  Task task = read_task(path, choices);
  Machine others = task.machine;
  others.prefilter_taps.clear();
  const bool servo = !Response(others, task.sample_period).ideal();
  choices.response = Considered::none;
  return servo || has_dry_friction(others) || limits_supply(others) ? read_task(path, choices) : task;
}

void run(const IdentifyArguments& options, Context& context) {
  const ColumnUnits units = options.units.empty() ? ColumnUnits{} : column_units(options.units);
  const std::string type = options.figure.empty() ? "" : figure_format(options.figure);
  Task task = task_of(options.task);
  // Otherwise the smoothing found would be one in front of the known one.
  if (options.prefilter) task.machine.prefilter_taps.clear();
  require_outputs({options.out, options.figure}, {options.log, options.task});
  const MotionLog log = read_motion_log(options.log, task.sample_period, units);
  IdentifyOptions choices;
  if (options.noise_um) choices.noise = 1e-6 * *options.noise_um;
  if (options.feed_mm_min) choices.feed = *options.feed_mm_min / 6e4;
  Identification found;
  try {
    found = identify(log, task, choices);
  } catch (const std::invalid_argument& reason) {
    throw std::invalid_argument(fmt::format("{}: {}", options.log, reason.what()));
  }
  OutputFiles files;
  files.add(options.out, identified_to_toml(found, log, task.sample_period, options.prefilter, options.log));
  if (!type.empty()) {
    const std::string svg = render_svg(figure_of(log, found, task.sample_period, options.log));
    files.add(options.figure, convert_svg(svg, type, options.log));
  }
  files.commit();
  context.exit_code = exit_ok;
}

}  // namespace

void add_identify(CLI::App& app, Context& context) {
  const auto options = std::make_shared<IdentifyArguments>();
  CLI::App* command = app.add_subcommand(
      "identify", "Find the filter of a controller or drive in a log of a straight move or a corner");
  command->add_option("log", options->log, "Table of times and positions of the axes, one row a sample period")
      ->required()
      ->type_name("LOG.csv");
  command
      ->add_option("--task", options->task,
                   "Task with the sample period. All families are tried, whatever it names. If it has [controller] "
                   "prefilter_taps, the filter found is the one in front of them")
      ->required()
      ->type_name("TASK.toml");
  command
      ->add_option("--units", options->units,
                   "Units of times and positions in columns whose names have none, such as s,mm for t,x,y")
      ->type_name("TIME,WAY");
  add_output_option(*command, "--out", options->out, "Write [filter] to FILE; - is standard output, the default");
  add_output_option(*command, "--figure", options->figure, "Draw log and fit: .svg, .png, .pdf or .html");
  command
      ->add_option("--noise-um", options->noise_um,
                   "Standard deviation of the positions. Default: what the best fit leaves")
      ->check(number_between(1e-9, 1e6))
      ->type_name("UM");
  command
      ->add_option("--feed-mm-min", options->feed_mm_min,
                   "Programmed feed of the move, or of the first leg. Default: any that explains the log")
      ->check(number_between(1e-3, 1e7))
      ->type_name("FEED");
  command->add_flag(
      "--prefilter", options->prefilter,
      "Write [controller] prefilter_taps, the control's own smoothing, instead of [filter]. Those of the task are "
      "ignored then");
  command->callback([options, &context] { run(*options, context); });
}

}  // namespace accdec::cli
