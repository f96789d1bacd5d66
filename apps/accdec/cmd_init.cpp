#include <algorithm>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <accdec/files.hpp>
#include <accdec/files/output_files.hpp>
#include <accdec/files/shown_text.hpp>
#include <accdec/files/suggestion.hpp>
#include <accdec/formats/design_report.hpp>

#include "machines.hpp"
#include "option_checks.hpp"
#include "output.hpp"

namespace accdec::cli {
namespace {

struct InitArguments {
  std::string machine{first_machine}, out = "-";
  bool list = false, force = false;
};

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const MachineFile& file : machine_files()) all.emplace_back(file.name);
  return all;
}

/// The first line of a file, a comment that says what it is.
std::string summary(std::string_view text) {
  const std::string_view line = text.substr(0, text.find('\n'));
  return std::string(line.substr(std::min(line.find_first_not_of("# "), line.size())));
}

void print_machines() {
  TextTable table({"machine", "what it is"});
  table.left(1);
  for (const MachineFile& file : machine_files()) table.add({std::string(file.name), summary(file.text)});
  fmt::print("{}", table.str());
}

void run(const InitArguments& arguments, const Context& context) {
  if (arguments.list) {
    print_machines();
    return;
  }
  const bool to_file = arguments.out != "-";
  // Somebody's own numbers may stand in it.
  if (to_file && !arguments.force && std::filesystem::exists(arguments.out))
    throw OutputError(arguments.out + ": there is a file already; --force replaces it");
  require_outputs({arguments.out}, {});
  write_file(arguments.out, machine_file(arguments.machine).text);
  if (to_file && !context.quiet)
    fmt::print("{} is written. Put in the numbers of your machine, then: accdec design {}\n", printable(arguments.out),
               shell_quoted(arguments.out));
}

}  // namespace

const MachineFile& machine_file(std::string_view name) {
  for (const MachineFile& file : machine_files()) {
    if (file.name == name) return file;
  }
  throw std::out_of_range(std::string(name));
}

void add_init(CLI::App& app, Context& context) {
  auto arguments = std::make_shared<InitArguments>();
  CLI::App* command = app.add_subcommand("init", "Write a commented task to start from");
  command->add_option("--machine", arguments->machine, "Kind of machine, see --list (default mill)")
      ->check(one_of(names()));
  add_output_option(*command, "--out", arguments->out, "Write to FILE; - is standard output, the default");
  command->add_flag("--list", arguments->list, "List the kinds of machines and write nothing");
  command->add_flag("--force", arguments->force, "Replace an existing file");
  command->callback([arguments, &context] { run(*arguments, context); });
}

}  // namespace accdec::cli
