#include <memory>
#include <string>

#include <fmt/format.h>

#include <accdec/files/shown_text.hpp>
#include <accdec/formats/controller_file.hpp>
#include <accdec/formats/design_report.hpp>

#include "command.hpp"

namespace accdec::cli {
namespace {

template <class Enum>
std::string joined(const std::vector<Enum>& list) {
  std::string text;
  for (const Enum one : list) text += fmt::format("{}{}", text.empty() ? "" : ", ", to_string(one));
  return text;
}

std::string times_of(const Controller& controller) {
  std::string text;
  for (const ControllerStage& stage : controller.stages) text += (text.empty() ? "" : "; ") + stage.time.name;
  return text;
}

void print_controllers() {
  TextTable table({"controller", "what it is", "family", "times"});
  for (const std::size_t column : {1, 2, 3}) table.left(column);
  for (const Controller& controller : controllers())
    table.add({controller.name, controller.title, joined(controller.families), times_of(controller)});
  fmt::print("{}", table.str());
}

void print_stage(const ControllerStage& stage) {
  const SettableStage& time = stage.time;
  std::string range;
  const auto add = [&](const std::string& part) { range += (range.empty() ? "" : ", ") + part; };
  if (time.length_step > 0.0) add(fmt::format("steps of {:.6g} ms", 1e3 * time.length_step));
  if (time.length_max > 0.0) add(fmt::format("up to {:.6g} ms", 1e3 * time.length_max));
  if (stage.length_max_samples > 0) add(fmt::format("up to {} cycles", stage.length_max_samples));
  for (const double value : time.length_set)
    range += fmt::format("{}{:.6g}", range.empty() ? "one of " : ", ", 1e3 * value);
  if (!time.length_set.empty()) range += " ms";
  fmt::print("parameter   {}, in {}: {}\n", printable(time.name), printable(time.unit),
             range.empty() ? "step and cap not known" : range);
}

void print_controller(const Controller& controller) {
  fmt::print("{}\n", printable(controller.title));
  fmt::print("family      {}\n", joined(controller.families));
  for (const ControllerStage& stage : controller.stages) print_stage(stage);
  fmt::print("delays      {}\n", controller.delays.empty() ? "not known" : joined(controller.delays));
  if (!controller.note.empty()) fmt::print("note        {}\n", printable(controller.note));
  for (const std::string& what : controller.unknown) fmt::print("not found   {}\n", printable(what));
  for (const std::string& what : controller.assumed) fmt::print("assumed     {}\n", printable(what));
  for (const ControllerSource& source : controller.sources)
    fmt::print("source      {}: {}\n", printable(source.fact), printable(source.where));
}

}  // namespace

void add_controllers(CLI::App& app, Context& context) {
  auto name = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("controllers", "List the controllers that a task can name, or show one");
  command->add_option("name", *name, "A controller of the list, or a file of your own")->type_name("NAME|FILE.toml");
  command->footer("In a task: [controller] name = \"NAME\", or file = \"FILE.toml\".");
  command->callback([name, &context] {
    if (context.quiet) return;
    if (name->empty())
      print_controllers();
    else
      print_controller(find_controller(*name));
  });
}

}  // namespace accdec::cli
