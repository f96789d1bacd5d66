#pragma once

#include <string>

#include <accdec/plot/figure.hpp>
#include <accdec/plot/plot_program.hpp>
#include <accdec/plot/program_page.hpp>

#include "option_checks.hpp"

namespace accdec::cli {

/// The option --view of commands that draw programs.
inline void add_view_option(CLI::App& command, std::string& view) {
  command
      .add_option("--view", view,
                  "View of a program. auto: the plane of its feed moves (G17, G18, G19); iso: from the front, the "
                  "right and above. A program that only drills also shows its depth over time")
      ->check(one_of({"auto", "xy", "xz", "yz", "iso"}))
      ->capture_default_str();
}

/// The figure of a plan that `accdec program --figure` writes.
/// @param programmed  the path as the program has it  @param machine  the task's  @param type  see figure_format
/// @param from  where the program is seen from
inline std::string program_figure(const ProgramResult& result, const Toolpath& programmed, const Machine& machine,
                                  const std::string& type, ViewFrom from) {
  if (type == "html") return program_page(programmed, machine, result, from);
  const Figure figure = plot_program(result, programmed, machine, from);
  return convert_svg(render_svg(figure), type, figure.title);
}

}  // namespace accdec::cli
