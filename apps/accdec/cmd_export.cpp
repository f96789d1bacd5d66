#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <accdec/files/output_files.hpp>
#include <accdec/files/text_file.hpp>
#include <accdec/plan/record/program_record.hpp>
#include <accdec/result.hpp>

#include "option_checks.hpp"
#include "output.hpp"

namespace accdec::cli {

void add_export(CLI::App& app, Context& context) {
  struct ExportArguments {
    std::string result, format, out = "-";
  };
  auto arguments = std::make_shared<ExportArguments>();
  CLI::App* command = app.add_subcommand("export", "Write a result's taps and delays for a controller or another tool");
  command->add_option("result", arguments->result, "Result file of evaluate, design or program")
      ->required()
      ->type_name("RESULT.json");
  command
      ->add_option("--format", arguments->format,
                   "csv, c, json, npy, cascade (lengths of moving averages), m (MATLAB, Octave), st (Structured "
                   "Text), linuxcnc-comp, klipper, q15 or q31 (whole numbers in C)")
      ->required()
      ->check(one_of(std::vector<std::string>(std::begin(taps_formats), std::end(taps_formats))));
  command->footer(
      "npy holds three arrays: taps, delays in samples, a JSON text with all else. numpy.load of the path reads the "
      "taps. All three: with open(\"taps.npy\", \"rb\") as f: taps, delays, about = [numpy.load(f) for _ in range(3)]");
  add_output_option(*command, "--out", arguments->out, "Write to FILE; - is standard output, the default");
  command->callback([arguments, &context] {
    const std::string text = read_text_file(arguments->result, result_file_limit);
    const bool program = schema_of_program(text).has_value();
    ProgramRecord record;
    if (program) record = parse_program_record(text, arguments->result);
    if (record.filters && !context.quiet)
      fmt::print(stderr, "{}: has a filter for every leg; what is exported is the one they are made from\n",
                 arguments->result);
    if (program && !record.commands && !context.quiet)
      fmt::print(stderr, "{}: does not hold its plan, so no delays are exported\n", arguments->result);
    const DesignResult result = program ? filter_of(record, arguments->result) : parse_result(text, arguments->result);
    if (!result.filter) {
      fmt::print(stderr, "{}: the result is {} and has no filter to export\n", arguments->result,
                 to_string(result.status));
      context.exit_code = exit_no_answer;
      return;
    }
    require_outputs({arguments->out}, {arguments->result});
    write_file(arguments->out, export_taps(result, arguments->format));
  });
}

}  // namespace accdec::cli
