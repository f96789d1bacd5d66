#include <memory>

#include <accdec/files/output_files.hpp>
#include <accdec/formats/task_reader.hpp>
#include <accdec/task/verifier.hpp>

#include "output.hpp"

namespace accdec::cli {

void add_evaluate(CLI::App& app, Context& context) {
  struct Options {
    std::string task, json;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("evaluate", "Errors, times and limit use of a fixed filter and fixed delays");
  command->add_option("task", options->task, "Task file with a [filter] and delay_samples in every corner")
      ->required()
      ->type_name("TASK.toml");
  add_json_option(*command, options->json);
  command->callback([options, &context] {
    const Task task = read_task(options->task, {.require_choices = true});
    require_outputs({options->json}, {options->task});
    context.exit_code = deliver(evaluate_task(task), options->json, context);
  });
}

}  // namespace accdec::cli
