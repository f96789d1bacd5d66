#include <memory>
#include <string>

#include <fmt/format.h>

#include <accdec/comparison/suite_instances.hpp>
#include <accdec/files/shown_text.hpp>

#include "command.hpp"
#include "option_checks.hpp"
#include "status_line.hpp"

namespace accdec::cli {
namespace {

struct Options {
  std::string suite;
  bool without_optima = false;
  comparison::InstanceOptions write;
};

void run(Options& options, Context& context) {
  const Suite suite = read_suite(options.suite);
  StatusLine status(context.quiet);
  options.write.optima = !options.without_optima;
  options.write.command = fmt::format("accdec instances {} --out {} --format {}{}", shell_quoted(options.suite),
                                      shell_quoted(options.write.out), options.write.format,
                                      options.without_optima ? " --without-optima" : "");
  options.write.version = ACCDEC_VERSION;
  options.write.tell = [&](const std::string& name) { status.tell(fmt::format("problem \"{}\"", name)); };
  const comparison::InstanceSummary s = comparison::write_instances(suite, options.write);
  if (context.quiet) return;
  fmt::print("{} instances written to {}, {} problems left out (see manifest.json)\n", s.written, options.write.out,
             s.left_out);
  if (options.write.optima) fmt::print("{} of {} optima proved\n", s.proved, s.written + s.left_out);
}

}  // namespace

void add_instances(CLI::App& app, Context& context) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("instances", "Write the problems of a suite as files for other solvers");
  command->add_option("suite", options->suite, "Suite file")->type_name("SUITE.toml")->required();
  command->add_option("--out", options->write.out, "Folder for the instances and manifest.json")
      ->type_name("DIR")
      ->required();
  command
      ->add_option("--format", options->write.format,
                   "nl (AMPL; every problem), mps (linear; cones by tangents), cbf (cones), dat-s (semidefinite)")
      ->check(one_of({"nl", "mps", "cbf", "dat-s"}))
      ->required();
  command->add_flag("--without-optima", options->without_optima,
                    "Leave out the proved optima, which take up to reference_time_limit_s for each problem");
  command->callback([options, &context] { run(*options, context); });
}

}  // namespace accdec::cli
