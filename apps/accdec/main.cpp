#include <algorithm>
#include <cstdio>
#include <exception>
#include <iostream>
#include <limits>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <malloc.h>

#include <fmt/format.h>

#include <accdec/files.hpp>
#include <accdec/files/process.hpp>
#include <accdec/files/shown_text.hpp>
#include <accdec/files/suggestion.hpp>
#include <accdec/files/temporaries.hpp>
#include <accdec/formats/manifest.hpp>
#include <accdec/solvers/module.hpp>

#include "command.hpp"
#include "explore/server.hpp"
#include "option_checks.hpp"

namespace accdec::cli {
namespace {

/// Every subcommand, in the order of --help.
void add_commands(CLI::App& app, Context& context) {
  add_init(app, context);
  add_evaluate(app, context);
  add_design(app, context);
  add_explain(app, context);
  add_explore(app, context);
  add_verify(app, context);
  add_export(app, context);
  add_plot(app, context);
  add_paper(app, context);
  add_optima(app, context);
  add_study(app, context);
  add_compare(app, context);
  add_instances(app, context);
  add_program(app, context);
  add_generate(app, context);
  add_controllers(app, context);
  add_identify(app, context);
  add_modes(app, context);
  add_solvers(app, context);
  add_completion(app, context);
  add_schema(app, context);
}

/// The version of uPlot, which the first line of its file names: "(v1.6.32)".
std::string uplot_version() {
  for (const explore::PageFile& file : explore::page_files()) {
    const std::size_t begin = file.text.find("(v");
    if (file.name == "uPlot.iife.min.js" && begin < file.text.find('\n'))
      return std::string(file.text.substr(begin + 2, file.text.find(')', begin) - begin - 2));
  }
  return "unknown";
}

std::string version_text() {
  std::string text = fmt::format("accdec {}\ncommit {}\n", ACCDEC_VERSION, source_commit());
  auto with = libraries();
  with.emplace_back("CLI11", CLI11_VERSION);
  try {
    using Version = decltype(explore::accdec_explore_http_version);
    with.emplace_back("cpp-httplib", solvers::module_function<Version>("explore", "accdec_explore_http_version")());
  } catch (const std::runtime_error&) {  // without its module nothing needs the library
  }
  with.emplace_back("uPlot", uplot_version());
  std::sort(with.begin(), with.end());
  for (const auto& [name, number] : with)
    text += fmt::format("{}{} {}", &name == &with.front().first ? "" : ", ", name, number);
  return text;
}

auto first_word(std::vector<std::string>& arguments) {
  return std::find_if(arguments.begin(), arguments.end(), [](const auto& a) { return !a.starts_with("-"); });
}

/// "help" and "help COMMAND" are "--help" and "COMMAND --help".
std::vector<std::string> arguments_of(int argc, char** argv) {
  std::vector<std::string> arguments(argv + 1, argv + argc);
  if (const auto word = first_word(arguments); word != arguments.end() && *word == "help") {
    arguments.erase(word);
    arguments.emplace_back("--help");
  }
  return arguments;
}

/// CLI11 would only say that a command is needed. @throws std::invalid_argument
void check_command(const CLI::App& app, std::vector<std::string>& arguments) {
  const auto word = first_word(arguments);
  if (word == arguments.end()) return;
  std::vector<std::string> known;
  for (const CLI::App* command : app.get_subcommands({})) known.push_back(command->get_name());
  if (std::find(known.begin(), known.end(), *word) == known.end())
    throw std::invalid_argument(unknown_name("command", *word, known));
}

int run(int argc, char** argv) {
  Context context;
  CLI::App app("Designs the Acc/Dec filter of CNC motion commands and the command delay of every corner.", "accdec");
  app.set_version_flag("--version", version_text, "Print the version, the commit and the libraries, and exit");
  app.add_flag("-q,--quiet", context.quiet, "No tables, progress or notes; results go to files and the exit code only");
  app.require_subcommand(1);
  app.fallthrough();
  app.footer(
      "Exit code 0: done and verified; 1: no acceptable answer; 2: bad usage or input, or an output that cannot be "
      "written.");
  add_commands(app, context);
  std::vector<std::string> arguments = arguments_of(argc, argv);
  check_command(app, arguments);
  std::reverse(arguments.begin(), arguments.end());  // as CLI11 takes them
  try {
    app.parse(std::move(arguments));
  } catch (const CLI::Success& success) {  // --help and --version
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    std::fprintf(stderr, "%s\n", printable(usage_message(app, error)).c_str());
    return exit_bad_input;
  }
  return context.exit_code;
}

}  // namespace
}  // namespace accdec::cli

int main(int argc, char** argv) {
  using namespace accdec;
  // Clp takes and returns its work areas with every linear program. Kept in the process rather than handed back to
  // the system each time, a study saves a sixth of its time.
  // The vectors of long programs follow one another, and new pages cost more than what is done with them.
  ::mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
  ::mallopt(M_TOP_PAD, 16 << 20);
  ::mallopt(M_MMAP_MAX, 0);
  const auto complain = [](const char* what, int code) {
    std::fflush(stdout);
    std::fprintf(stderr, "%s\n", printable(what).c_str());
    return code;
  };
  // The printed text must have been written, or the command fails.
  const auto printed = [&](int code) {
    std::cout.flush();
    const bool arrived = std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout.good();
    return arrived ? code : complain("standard output: cannot be written", cli::exit_bad_input);
  };
  remove_temporaries_on_signals();
  try {
    return printed(cli::run(argc, argv));
  } catch (const InputError& error) {
    return complain(error.what(), cli::exit_bad_input);
  } catch (const OutputError& error) {
    return complain(error.what(), cli::exit_bad_input);
  } catch (const std::invalid_argument& error) {
    return complain(error.what(), cli::exit_bad_input);
  } catch (const std::system_error& error) {  // a table that cannot be written
    return complain(error.what(), cli::exit_bad_input);
  } catch (const MissingProgram& error) {
    return complain(error.what(), cli::exit_bad_input);
  } catch (const std::bad_alloc&) {
    return complain("out of memory", cli::exit_no_answer);
  } catch (const std::exception& error) {
    return complain(error.what(), cli::exit_no_answer);
  }
}
