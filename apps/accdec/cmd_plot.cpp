#include <memory>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include <accdec/files/output_files.hpp>
#include <accdec/files/text_file.hpp>
#include <accdec/formats/program_record.hpp>
#include <accdec/formats/result_json.hpp>
#include <accdec/plot/figure.hpp>
#include <accdec/plot/html_result.hpp>
#include <accdec/plot/plot_program.hpp>
#include <accdec/plot/plot_result.hpp>

#include "output.hpp"

namespace accdec::cli {

namespace {

struct Options {
  std::string result, out, corner;
};

Figure program_figure(const std::string& text, const Options& options) {
  if (!options.corner.empty())
    throw std::invalid_argument("--corner goes with results of evaluate and design: a program is drawn whole");
  const ProgramRecord record = parse_program_record(text, options.result);
  if (!record.commands) {
    throw std::invalid_argument(
        fmt::format("{}: holds no commands to draw (accdec keeps them up to {} blocks); accdec program --figure draws "
                    "any",
                    options.result, recorded_blocks_max));
  }
  return plot_program(record.result);
}

}  // namespace

void add_plot(CLI::App& app, Context& context) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("plot", "Draws the motion, path, taps and frequency response of a result");
  command->add_option("result", options->result, "Result file")->required()->type_name("RESULT.json");
  add_output_option(*command, "--out", options->out, "Drawing to write, .svg, .png, .pdf or .html")->required();
  command->add_option("--corner", options->corner, "Corner to draw; the first unless given")->type_name("NAME");
  command->callback([options, &context] {
    const std::string format = figure_format(options->out);
    const std::string text = read_text_file(options->result, result_file_limit);
    require_outputs({options->out}, {options->result});
    refuse_profiles(text, options->result);
    std::string drawn;
    if (is_program_result(text)) {
      const Figure figure = program_figure(text, *options);
      drawn = convert_svg(render_svg(figure), format, figure.title);
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
