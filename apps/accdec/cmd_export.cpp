#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <accdec/files/output_files.hpp>
#include <accdec/files/text_file.hpp>
#include <accdec/formats/program_record.hpp>
#include <accdec/formats/result_json.hpp>
#include <accdec/formats/taps_export.hpp>

#include "option_checks.hpp"
#include "output.hpp"

namespace accdec::cli {

void add_export(CLI::App& app, Context& context) {
  struct Arguments {
    std::string result, format, out = "-";
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("export", "Write a result's taps for a controller or another tool");
  command->add_option("result", arguments->result, "Result file of evaluate, design or program")
      ->required()
      ->type_name("RESULT.json");
  command->add_option("--format", arguments->format, "csv, c, json, npy, or cascade (lengths of moving averages)")
      ->required()
      ->check(one_of(std::vector<std::string>(std::begin(taps_formats), std::end(taps_formats))));
  add_output_option(*command, "--out", arguments->out, "Write to FILE; - is standard output, the default");
  command->callback([arguments, &context] {
    const std::string text = read_text_file(arguments->result, result_file_limit);
    refuse_profiles(text, arguments->result);
    const bool program = is_program_result(text);
    ProgramRecord record;
    if (program) record = parse_program_record(text, arguments->result);
    if (!record.result.legs.single() && !context.quiet)
      fmt::print(stderr, "{}: has a filter for every leg; what is exported is the one they are made from\n",
                 arguments->result);
    const DesignResult result = program ? filter_of(record) : parse_result(text, arguments->result);
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
