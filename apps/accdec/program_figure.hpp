#pragma once

#include <string>

#include <accdec/plot/figure.hpp>
#include <accdec/plot/plot_program.hpp>
#include <accdec/plot/program_page.hpp>

namespace accdec::cli {

/// What `accdec program --figure` writes of a plan.
/// @param programmed  the path as the program has it  @param machine  the task's  @param type  see figure_format
template <class Result>
std::string program_figure(const Result& result, const Toolpath& programmed, const Machine& machine,
                           const std::string& type) {
  if (type == "html") return program_page(programmed, machine, result);
  const Figure figure = plot_program(result, programmed, machine);
  return convert_svg(render_svg(figure), type, figure.title);
}

}  // namespace accdec::cli
