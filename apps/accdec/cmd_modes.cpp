#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <accdec/design.hpp>
#include <accdec/design/find_modes.hpp>
#include <accdec/files/output_files.hpp>
#include <accdec/formats/vibration_log_file.hpp>
#include <accdec/plot/figure.hpp>
#include <accdec/task.hpp>

#include "interrupt.hpp"
#include "option_checks.hpp"
#include "output.hpp"
#include "status_line.hpp"

namespace accdec::cli {
namespace {

struct ModesArguments {
  std::string log, task, out = "-", figure;
  double frequency_min = 5.0, frequency_max = 200.0, residual = 0.05, time_limit = 10.0;
  int most = 3;
};

/// Energy by frequency of every axis, and the bands of its modes.
Figure figure_of(const VibrationLog& log, const std::vector<FoundMode>& modes, double most, const std::string& name) {
  Figure figure;
  figure.title = name;
  constexpr int cells = 400;
  for (std::size_t a = 0; a < log.axes.size(); ++a) {
    Panel panel;
    panel.title = "vibration of axis " + log.axes[a];
    panel.x.label = "frequency / Hz";
    panel.y.label = "energy, of the largest";
    panel.y.log = true;
    const std::vector<double> sums = summed_power(power_spectrum(log.acceleration[a], log.period), most, cells);
    const double largest = std::max(*std::max_element(sums.begin(), sums.end()), 1e-300);
    Series energy{.label = "", .x = {}, .y = {}, .mark = Mark::line, .style = 0, .solid = true};
    for (int i = 0; i < cells; ++i) {
      energy.x.push_back((i + 0.5) * most / cells);
      energy.y.push_back(std::max(sums[static_cast<std::size_t>(i)] / largest, 1e-8));
    }
    panel.series.push_back(std::move(energy));
    for (const FoundMode& mode : modes) {
      if (mode.axis != log.axes[a]) continue;
      const std::vector<Mode> held = bounded_modes({mode}, 1.0);
      if (held.empty()) continue;
      panel.bands.push_back({held.front().frequency_low, held.front().frequency_high,
                             fmt::format("{:.4g} Hz, damping {:.3g}", mode.frequency, mode.damping)});
    }
    panel.x.min = 0.0, panel.x.max = most;
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

/// The cost to a task of each bound on the modes found, beside its own modes.
std::vector<ModeCost> costs_of(const Task& task, const std::vector<FoundMode>& modes, const ModesArguments& arguments,
                               Context& context) {
  DesignOptions options;
  options.time_limit = arguments.time_limit;
  options.cancel = &Interrupt::asked();
  const Interrupt interrupt;
  StatusLine line(context.quiet, StatusLine::Lines::none, 5.0 * arguments.time_limit);
  line.tell("the task as it is");
  const DesignResult base = design_task(task, options);
  std::vector<ModeCost> costs;
  std::vector<double> residuals{0.2, 0.1, 0.05, 0.02};
  if (std::find(residuals.begin(), residuals.end(), arguments.residual) == residuals.end())
    residuals.push_back(arguments.residual);
  std::sort(residuals.rbegin(), residuals.rend());
  for (const double residual : residuals) {
    line.tell(fmt::format("vibrations held below {:g}", residual));
    Task held = task;
    for (const Mode& mode : bounded_modes(modes, residual)) held.machine.modes.push_back(mode);
    const DesignResult result = design_task(held, options);
    ModeCost cost{residual, {}, base.status == Status::optimal && result.status == Status::optimal};
    if (base.filter && result.filter) cost.more = result.objective() - base.objective();
    costs.push_back(cost);
  }
  return costs;
}

void run(const ModesArguments& arguments, Context& context) {
  const std::string type = arguments.figure.empty() ? "" : figure_format(arguments.figure);
  std::optional<Task> task;
  if (!arguments.task.empty())
    task = read_task(arguments.task, {.require_corners = false, .response = Considered::all});
  require_outputs({arguments.out, arguments.figure}, {arguments.log, arguments.task});
  const VibrationLog log = read_vibration_log(arguments.log);
  FindModesOptions options;
  options.frequency_min = arguments.frequency_min;
  options.frequency_max = arguments.frequency_max;
  options.most = static_cast<std::size_t>(arguments.most);
  std::vector<FoundMode> modes;
  try {
    modes = find_modes(log, options);
  } catch (const std::invalid_argument& reason) {
    throw std::invalid_argument(fmt::format("{}: {}", arguments.log, reason.what()));
  }
  std::vector<ModeCost> costs;
  const bool corners = task && !task->corners.empty();
  const bool some = std::ranges::any_of(modes, &FoundMode::certain);
  if (corners && some) costs = costs_of(*task, modes, arguments, context);
  OutputFiles files;
  std::string tables = modes_to_toml(modes, log, costs, arguments.residual, arguments.log);
  if (task && !corners)
    tables += fmt::format("\n# {} has no [[corner]]; add one to see what the bounds cost there\n", arguments.task);
  files.add(arguments.out, std::move(tables));
  if (!type.empty()) {
    const double most = std::min(1.2 * arguments.frequency_max, 0.5 / log.period);
    files.add(arguments.figure,
              convert_svg(render_svg(figure_of(log, modes, most, arguments.log)), type, arguments.log));
  }
  files.commit();
  context.exit_code = some ? exit_ok : exit_no_answer;
}

}  // namespace

void add_modes(CLI::App& app, Context& context) {
  const auto arguments = std::make_shared<ModesArguments>();
  CLI::App* command = app.add_subcommand("modes", "Find vibrations in a log of accelerations, as [[mode]] tables");
  command->add_option("log", arguments->log, "Table of times and accelerations (or positions) of the axes")
      ->required()
      ->type_name("LOG.csv");
  command->add_option("--task", arguments->task, "Also say how much time limits on these modes add to this task")
      ->type_name("TASK.toml");
  add_output_option(*command, "--out", arguments->out, "Write [[mode]] to FILE; - is standard output, the default");
  add_output_option(*command, "--figure", arguments->figure, "Draw spectrum and modes: .svg, .png, .pdf or .html");
  command->add_option("--from-hz", arguments->frequency_min, "Lowest frequency of a mode (default 5)")
      ->check(number_between(0.01, 1e5))
      ->type_name("HZ");
  command->add_option("--to-hz", arguments->frequency_max, "Highest frequency of a mode (default 200)")
      ->check(number_between(0.02, 1e6))
      ->type_name("HZ");
  command->add_option("--most", arguments->most, "Largest number of modes for each axis (default 3)")
      ->check(CLI::Range(1, 10))
      ->type_name("N");
  command->add_option("--residual-max", arguments->residual, "residual_max of the tables (default 0.05)")
      ->check(number_between(0.0, 1.0))
      ->type_name("R");
  command->add_option("--design-time-limit", arguments->time_limit, "Seconds for each design of --task (default 10)")
      ->check(positive_number())
      ->type_name("S");
  command->callback([arguments, &context] { run(*arguments, context); });
}

}  // namespace accdec::cli
