#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <accdec/files/errors.hpp>
#include <accdec/files/output_files.hpp>
#include <accdec/files/suggestion.hpp>
#include <accdec/formats/design_report.hpp>

#include "machines.hpp"
#include "option_checks.hpp"
#include "output.hpp"

namespace accdec::cli {
namespace {

struct Arguments {
  std::string machine = "mill", out = "-";
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

void print_list() {
  TextTable table({"machine", "what it is"});
  table.left(1);
  for (const MachineFile& file : machine_files()) table.add({std::string(file.name), summary(file.text)});
  fmt::print("{}", table.str());
}

void run(const Arguments& arguments, const Context& context) {
  if (arguments.list) {
    print_list();
    return;
  }
  const auto files = machine_files();
  const auto file =
      std::find_if(files.begin(), files.end(), [&](const MachineFile& f) { return f.name == arguments.machine; });
  const bool to_file = arguments.out != "-";
  // Somebody's own numbers may stand in it.
  if (to_file && !arguments.force && std::filesystem::exists(arguments.out))
    throw OutputError(arguments.out + ": there is a file already; --force replaces it");
  require_outputs({arguments.out}, {});
  write_file(arguments.out, file->text);
  if (to_file && !context.quiet)
    fmt::print("{} is written. Put in the numbers of your machine, then: accdec design {}\n", arguments.out,
               arguments.out);
}

}  // namespace

void add_init(CLI::App& app, Context& context) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("init", "Write a commented task to start from");
  command->add_option("--machine", arguments->machine, "kind of machine, see --list (default mill)")
      ->check(one_of(names()));
  add_output_option(*command, "--out", arguments->out, "Write to FILE; - is standard output, the default");
  command->add_flag("--list", arguments->list, "say which machines there are, and write nothing");
  command->add_flag("--force", arguments->force, "replace a file that is there");
  command->callback([arguments, &context] { run(*arguments, context); });
}

}  // namespace accdec::cli
