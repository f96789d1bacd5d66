#include <algorithm>
#include <memory>
#include <string>

#include <fmt/format.h>

#include <accdec/design.hpp>
#include <accdec/files/output_files.hpp>
#include <accdec/formats/explanation.hpp>
#include <accdec/task.hpp>

#include "interrupt.hpp"
#include "option_checks.hpp"
#include "output.hpp"
#include "status_line.hpp"

namespace accdec::cli {
namespace {

struct ExplainArguments {
  std::string task, json, by = "10 %";
  double time_limit = 300.0, design_time_limit = 10.0;
  bool verbose = false;
};

void run(const ExplainArguments& arguments, Context& context) {
  const Task task = read_task(arguments.task, {.response = Considered::all});
  warn(task, arguments.task, context);
  require_outputs({arguments.json}, {arguments.task});
  ExplainOptions options;
  options.share = fraction(arguments.by).value_or(0.1);
  options.time_limit = arguments.time_limit;
  options.design.time_limit = arguments.design_time_limit;
  options.design.cancel = &Interrupt::asked();
  const Interrupt interrupt;
  const Explanation explanation = [&] {
    StatusLine line(context.quiet, StatusLine::Lines::none, arguments.time_limit);
    line.tell("the task as it is");
    options.progress = [&line](int done, int total) {
      const double left = line.seconds() / done * std::max(0, total - done);
      line.tell(fmt::format("{} of about {} designs, {} left", done, total, clock_text(left)));
    };
    return explain_task(task, options);
  }();

  if (!arguments.json.empty()) write_file(arguments.json, explanation_to_json(explanation));
  if (arguments.json != "-" && !context.quiet) fmt::print("{}", explanation_text(explanation, arguments.verbose));
  context.exit_code = explanation.base.filter ? exit_ok : exit_no_answer;
}

}  // namespace

void add_explain(CLI::App& app, Context& context) {
  auto arguments = std::make_shared<ExplainArguments>();
  CLI::App* command =
      app.add_subcommand("explain", "Show which limits bind, and what more room for each saves or makes possible");
  command->add_option("task", arguments->task, "Task file")->required()->type_name("TASK.toml");
  add_json_option(*command, arguments->json);
  command->add_option("--by", arguments->by, "How far to relax each limit, for example 10% or 0.1 (default 10 %)")
      ->check([](const std::string& text) {
        const auto share = fraction(text);
        return share && *share > 0.0 ? std::string() : "must be above 0 and below 100 %, as 10% or 0.1, got " + text;
      });
  command->add_flag("--verbose", arguments->verbose, "Name the samples at which limits are used to the full");
  command
      ->add_option("--time-limit", arguments->time_limit,
                   "Seconds for the whole command (default 300); then the answers so far are printed")
      ->type_name("SECONDS")
      ->check(positive_number());
  command
      ->add_option("--design-time-limit", arguments->design_time_limit,
                   "Seconds of processor time for each single design (default 10)")
      ->type_name("SECONDS")
      ->check(positive_number());
  command->callback([arguments, &context] { run(*arguments, context); });
}

}  // namespace accdec::cli
