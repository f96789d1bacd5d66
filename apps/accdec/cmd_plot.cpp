#include <cstdio>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <accdec/files/output_files.hpp>
#include <accdec/files/shown_text.hpp>
#include <accdec/files/text_file.hpp>
#include <accdec/plan/record/program_record.hpp>
#include <accdec/plan/run/fastest_plan.hpp>
#include <accdec/plot/figure.hpp>
#include <accdec/plot/html_result.hpp>
#include <accdec/plot/plot_program.hpp>
#include <accdec/plot/plot_result.hpp>
#include <accdec/result.hpp>

#include "output.hpp"
#include "program_figure.hpp"
#include "verify_program.hpp"

namespace accdec::cli {

namespace {

struct PlotArguments {
  std::string result, out, corner, view = "auto";
};

/// Draws what `accdec program --figure` draws, which needs the program as it was read. If the program is gone, draws
/// what the commands alone show.
std::string draw_program(const std::string& text, const PlotArguments& options, const std::string& format) {
  if (!options.corner.empty())
    throw std::invalid_argument("--corner goes with results of evaluate and design: a program is drawn whole");
  const ProgramRecord record = parse_program_record(text, options.result);
  const bool plan_again = record.schema == ProgramSchema::profiles_1;
  if (!plan_again && !record.commands) {
    throw std::invalid_argument(
        fmt::format("{}: holds no commands to draw (accdec keeps them up to {} moves); accdec program --figure draws "
                    "any",
                    options.result, recorded_blocks_max));
  }
  std::string why = changed_inputs(record.inputs);
  std::vector<std::string> reasons;
  const std::optional<Toolpath> programmed = why.empty() ? read_again(record, reasons) : std::nullopt;
  if (why.empty() && !programmed) why = "the program was run by rs274, which is not installed";
  if (programmed && plan_again) {
    if (record.result.status != Status::feasible) throw std::invalid_argument("the result is failed: no plan to draw");
    const ProgramResult planned = plan_profiles_of({record.inputs.program, *programmed, record.task});
    return program_figure(planned, *programmed, record.task.machine, format, view_from(options.view));
  }
  if (programmed)
    return program_figure(record.result, *programmed, record.task.machine, format, view_from(options.view));
  if (plan_again) throw std::invalid_argument(options.result + ": holds no commands to draw, and " + why);
  std::fprintf(stderr, "%s: drawn without speed over time and without the time that corners cost: %s\n",
               printable(options.result).c_str(), printable(why).c_str());
  const Figure figure = plot_program(record.result, view_from(options.view));
  return convert_svg(render_svg(figure), format, figure.title);
}

}  // namespace

void add_plot(CLI::App& app, Context& context) {
  const auto options = std::make_shared<PlotArguments>();
  CLI::App* command = app.add_subcommand("plot", "Draw the motion, path, taps and frequency response of a result");
  command->add_option("result", options->result, "Result file")->required()->type_name("RESULT.json");
  add_output_option(*command, "--out", options->out, "Drawing to write, .svg, .png, .pdf or .html")->required();
  command->add_option("--corner", options->corner, "Corner to draw (default: the first)")->type_name("NAME");
  add_view_option(*command, options->view);
  command->callback([options, &context] {
    const std::string format = figure_format(options->out);
    const std::string text = read_text_file(options->result, result_file_limit);
    require_outputs({options->out}, {options->result});
    std::string drawn;
    if (schema_of_program(text)) {
      drawn = draw_program(text, *options, format);
    } else {
      const DesignResult result = parse_result(text, options->result);
      const Figure figure = plot_result(result, options->corner);
      const std::string svg = render_svg(figure);
      drawn = format == "html" ? html_result_page(result, figure, svg) : convert_svg(svg, format, figure.title);
    }
    write_file(options->out, drawn);
    context.exit_code = exit_ok;
  });
}

}  // namespace accdec::cli
