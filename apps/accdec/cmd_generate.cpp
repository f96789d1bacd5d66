#include <iostream>
#include <memory>
#include <string>

#include <accdec/files/output_file.hpp>
#include <accdec/gcode/generate.hpp>

#include "option_checks.hpp"
#include "output.hpp"

namespace accdec::cli {

void add_generate(CLI::App& app, Context&) {
  struct GenerateArguments {
    std::string kind, out = "-";
    GenerateOptions generate;
  };
  const auto options = std::make_shared<GenerateArguments>();
  CLI::App* command = app.add_subcommand("generate", "Write a test program of any length");
  command
      ->add_option("kind", options->kind,
                   "pocket | zigzag | trochoid | engraving | raster | star | hilbert | relief | spiral")
      ->required()
      ->type_name("KIND")
      ->check(one_of({"pocket", "zigzag", "trochoid", "engraving", "raster", "star", "hilbert", "relief", "spiral"}));
  command->add_option("--blocks", options->generate.blocks, "Approximate number of blocks")
      ->check(CLI::Range(10L, 1000000000L))
      ->capture_default_str();
  command->add_option("--feed", options->generate.feed, "Programmed feed, mm/min")
      ->check(number_between(1e-3, 1e8))
      ->capture_default_str();
  command->add_option("--tolerance", options->generate.tolerance, "Tolerance of G64 P, mm")
      ->check(number_between(1e-6, 1e3))
      ->capture_default_str();
  add_output_option(*command, "--out", options->out, "File to write, - for standard output")->capture_default_str();
  command->callback([options] {
    OutputFile file(options->out);
    generate_program(*generated_program_from_string(options->kind), options->generate, file.stream());
    file.commit();
  });
}

}  // namespace accdec::cli
