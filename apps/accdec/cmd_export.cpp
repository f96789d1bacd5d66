#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <accdec/files/atomic_file.hpp>
#include <accdec/formats/result_json.hpp>
#include <accdec/formats/taps_export.hpp>

#include "command.hpp"

namespace accdec::cli {

void add_export(CLI::App& app, Context& context) {
  struct Arguments {
    std::string result, format, out = "-";
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("export", "Write a result's taps for a controller or another tool");
  command->add_option("result", arguments->result, "Result file of evaluate or design")
      ->required()
      ->type_name("RESULT.json");
  command->add_option("--format", arguments->format, "csv, c, json, npy, or cascade (lengths of moving averages)")
      ->required()
      ->check(CLI::IsMember(std::vector<std::string>(std::begin(taps_formats), std::end(taps_formats))));
  command->add_option("--out", arguments->out, "Write to FILE; - is standard output, the default")->type_name("FILE");
  command->callback([arguments, &context] {
    const DesignResult result = read_result(arguments->result);
    if (!result.filter) {
      fmt::print(stderr, "{}: the result is {} and has no filter to export\n", arguments->result,
                 to_string(result.status));
      context.exit_code = exit_no_answer;
      return;
    }
    write_file(arguments->out, export_taps(result, arguments->format));
  });
}

}  // namespace accdec::cli
