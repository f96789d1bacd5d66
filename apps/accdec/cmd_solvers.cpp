#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/solver.hpp>

#include "command.hpp"

namespace accdec::cli {
namespace {

std::string accepts(const solvers::Capabilities& can) {
  std::vector<std::string> parts{can.linear_only ? "linear problems" : "nonlinear"};
  if (can.needs_finite_bounds) {
    parts.push_back("a box");
  } else if (can.bounds) {
    parts.push_back("bounds");
  }
  if (can.inequality_rows) parts.push_back("inequalities");
  if (can.equality_rows) parts.push_back("equalities");
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::string uses(const solvers::Capabilities& can) {
  if (can.linear_only) return "coefficients";
  if (can.uses_hessian) return "first, second derivatives";
  return can.uses_gradient || can.uses_jacobian ? "first derivatives" : "values";
}

}  // namespace

void add_solvers(CLI::App& app, Context& context) {
  CLI::App* command = app.add_subcommand(
      "solvers", "List the optimisation algorithms for design --solver, with versions and what each accepts");
  command->callback([&context] {
    if (context.quiet) return;
    constexpr const char* row = "{:<20} {:<13} {:<7} {:<14} {:<26} {}\n";
    fmt::print(row, "name", "library", "search", "repeats", "uses", "accepts");
    for (const auto& solver : solvers::registry()) {
      const solvers::Capabilities can = solver->capabilities();
      fmt::print(row, solver->name(), solver->library_version(), can.global ? "global" : "local",
                 can.seeded ? "by its seed" : "always", uses(can), accepts(can));
    }
    for (const auto& [module, reason] : solvers::missing_modules()) fmt::print("{}: {}\n", module, reason);
  });
}

}  // namespace accdec::cli
