#include <memory>
#include <string>

#include <accdec/files/output_files.hpp>
#include <accdec/formats/result_json.hpp>
#include <accdec/plot/figure.hpp>
#include <accdec/plot/plot_result.hpp>

#include "output.hpp"

namespace accdec::cli {

void add_plot(CLI::App& app, Context& context) {
  struct Options {
    std::string result, out, corner;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("plot", "Draws the motion, path, taps and frequency response of a result");
  command->add_option("result", options->result, "Result file")->required()->type_name("RESULT.json");
  add_output_option(*command, "--out", options->out, "Drawing to write, .svg, .png, .pdf or .html")->required();
  command->add_option("--corner", options->corner, "Corner to draw; the first unless given")->type_name("NAME");
  command->callback([options, &context] {
    const std::string format = figure_format(options->out);
    const DesignResult result = read_result(options->result);
    require_outputs({options->out}, {options->result});
    const Figure figure = plot_result(result, options->corner);
    write_file(options->out, convert_svg(render_svg(figure), format, figure.title));
    context.exit_code = exit_ok;
  });
}

}  // namespace accdec::cli
