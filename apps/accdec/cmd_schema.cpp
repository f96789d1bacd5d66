#include <array>
#include <memory>
#include <string>

#include <fmt/format.h>

#include <accdec/comparison/suite_keys.hpp>
#include <accdec/formats/controller_file.hpp>
#include <accdec/formats/result_keys.hpp>
#include <accdec/formats/schema_document.hpp>
#include <accdec/formats/task_keys.hpp>
#include <accdec/study/study_keys.hpp>

#include "command.hpp"
#include "option_checks.hpp"

namespace accdec::cli {

void add_schema(CLI::App& app, Context&) {
  struct SchemaArguments {
    std::string kind;
    bool markdown = false;
  };
  auto options = std::make_shared<SchemaArguments>();
  CLI::App* command = app.add_subcommand("schema", "Print the keys of a kind of file as a JSON Schema (draft 2020-12)");
  command->add_option("kind", options->kind, "task, study, suite, result or controller")
      ->type_name("KIND")
      ->required()
      ->check(one_of({"task", "study", "suite", "result", "controller"}));
  command->add_flag("--markdown", options->markdown, "Print a Markdown table instead");
  command->callback([options] {
    for (const FileKind* file :
         std::array{&task_file(), &study_file(), &suite_file(), &result_file(), &controller_file()}) {
      if (file->name == options->kind) fmt::print("{}", options->markdown ? key_table(*file) : json_schema(*file));
    }
  });
}

}  // namespace accdec::cli
