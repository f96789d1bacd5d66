#pragma once

#include <CLI/CLI.hpp>

namespace accdec::cli {

/// Exit codes of every subcommand.
enum ExitCode {
  exit_ok = 0,         ///< done and verified
  exit_no_answer = 1,  ///< infeasible, failed, or verification failed
  exit_bad_input = 2   ///< usage or input; nothing was written
};

/// State that main and the subcommands share. A subcommand stores its exit code here from its CLI11 callback;
/// exceptions of type InputError and std::invalid_argument become exit_bad_input in main, all others exit_no_answer.
struct Context {
  bool quiet = false;
  int exit_code = exit_ok;
};

// One file a subcommand, cmd_NAME.cpp, each with one function that registers it.
void add_evaluate(CLI::App& app, Context& context);
void add_init(CLI::App& app, Context& context);
void add_explain(CLI::App& app, Context& context);
void add_explore(CLI::App& app, Context& context);
void add_completion(CLI::App& app, Context& context);
void add_design(CLI::App& app, Context& context);
void add_verify(CLI::App& app, Context& context);
void add_export(CLI::App& app, Context& context);
void add_paper(CLI::App& app, Context& context);
void add_plot(CLI::App& app, Context& context);
void add_schema(CLI::App& app, Context& context);
void add_controllers(CLI::App& app, Context& context);
void add_identify(CLI::App& app, Context& context);
void add_modes(CLI::App& app, Context& context);
void add_solvers(CLI::App& app, Context& context);
void add_program(CLI::App& app, Context& context);
void add_generate(CLI::App& app, Context& context);
void add_instances(CLI::App& app, Context& context);
void add_optima(CLI::App& app, Context& context);
void add_study(CLI::App& app, Context& context);
void add_compare(CLI::App& app, Context& context);

}  // namespace accdec::cli
