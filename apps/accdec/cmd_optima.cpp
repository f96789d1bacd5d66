#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/files/output_files.hpp>
#include <accdec/files/results_folder.hpp>
#include <accdec/files/shown_text.hpp>
#include <accdec/formats/manifest.hpp>
#include <accdec/plot/figure.hpp>
#include <accdec/study/optima_report.hpp>
#include <accdec/task.hpp>

#include "command.hpp"
#include "option_checks.hpp"
#include "status_line.hpp"

namespace accdec::cli {
namespace {

struct OptimaArguments {
  std::vector<std::string> tasks;
  std::string out, growth;
  int halvings = 5;
  double time_limit = 120.0;
};

void run(const OptimaArguments& arguments, Context& context) {
  // Everything is read before anything is computed: a bad tenth file must not cost the time of the first nine.
  std::vector<Task> tasks;
  for (const std::string& path : arguments.tasks) tasks.push_back(read_task(path, {.response = Considered::all}));
  Task finer;
  if (!arguments.growth.empty()) {
    finer = read_task(arguments.growth, {.response = Considered::all});
    if (finer.corners.size() != 1)
      throw std::invalid_argument(arguments.growth + ": --growth takes a task with one corner");
  }
  require_results_folder(arguments.out, {"accdec.optima/1", "command", "table of optima", "accdec optima "});
  require_drawing("png");

  DesignOptions options;
  options.time_limit = arguments.time_limit;
  std::vector<study::Optimum> optima, growth;
  StatusLine status(context.quiet);
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    status.tell(arguments.tasks[i]);
    optima.push_back(study::find_optimum(std::filesystem::path(arguments.tasks[i]).stem().string(), tasks[i], options));
  }
  for (int i = 0; !arguments.growth.empty() && i <= arguments.halvings; ++i) {
    status.tell(fmt::format("{} at {:g} ms", arguments.growth, 1e3 * finer.sample_period));
    growth.push_back(study::find_optimum(fmt::format("{:g} ms", 1e3 * finer.sample_period), finer, options, false));
    finer.sample_period /= 2.0;
    finer.design.order_max *= 2;
  }

  std::string command = "accdec optima";
  for (const std::string& task : arguments.tasks) command += " " + shell_quoted(task);
  command += fmt::format(" --out {} --time-limit {:g}", shell_quoted(arguments.out), arguments.time_limit);
  if (!arguments.growth.empty())
    command += fmt::format(" --growth {} --halvings {}", shell_quoted(arguments.growth), arguments.halvings);
  nlohmann::ordered_json manifest;
  manifest["schema"] = "accdec.optima/1";
  manifest["command"] = command;
  add_environment(manifest, ACCDEC_VERSION);
  // The manifest comes first, so that the folder is recognised even if this ends between two files.
  OutputFiles output;
  std::vector<std::string> names{(std::filesystem::path(arguments.out) / "manifest.json").string()},
      inputs = arguments.tasks;
  output.add(names.front(), manifest.dump(2) + "\n");
  inputs.push_back(arguments.growth);
  for (auto& [name, content] : optima_documents(optima, growth)) {
    names.push_back((std::filesystem::path(arguments.out) / name).string());
    output.add(names.back(), std::move(content));
  }
  create_results_folder(arguments.out);
  require_outputs(names, inputs);
  output.commit();

  if (!context.quiet) std::fputs(optima_text(optima).c_str(), stdout);
  optima.insert(optima.end(), growth.begin(), growth.end());
  for (const study::Optimum& o : optima) {
    if (o.accepted && o.design.status != Status::failed) continue;
    fmt::print(stderr, "{}: {}\n", o.name, o.accepted ? o.design.message : "rejected by the recheck: " + o.objection);
    context.exit_code = exit_no_answer;
  }
}

}  // namespace

void add_optima(CLI::App& app, Context& context) {
  const auto arguments = std::make_shared<OptimaArguments>();
  CLI::App* command = app.add_subcommand(
      "optima", "Compute proved optima of many tasks, beside the best filters that controllers have");
  command->add_option("tasks", arguments->tasks, "Task files; a [filter] in them is ignored")
      ->required()
      ->type_name("TASK.toml...");
  command
      ->add_option("--out", arguments->out,
                   "Folder for optima.csv, .md, .svg, .png, TASK-filters.svg, .png and manifest.json")
      ->required()
      ->type_name("DIR");
  command->add_option("--time-limit", arguments->time_limit, "Seconds for each design")
      ->check(positive_number())
      ->capture_default_str();
  command
      ->add_option("--growth", arguments->growth,
                   "Also solve this single-corner task at shorter and shorter sample periods")
      ->type_name("TASK.toml");
  command->add_option("--halvings", arguments->halvings, "How often --growth halves the sample period")
      ->check(CLI::Range(0, 10))
      ->capture_default_str();
  command->callback([arguments, &context] { run(*arguments, context); });
}

}  // namespace accdec::cli
