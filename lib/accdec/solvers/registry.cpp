#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/files/suggestion.hpp>
#include <accdec/solvers/registration.hpp>

namespace accdec::solvers {

namespace {

SolverList& solvers() {
  static SolverList list = [] {
    SolverList all;
    add_ipopt(all);
    add_nlopt(all);
    add_ceres(all);
    add_clp(all);
    return all;
  }();
  return list;
}

}  // namespace

const SolverList& registry() {
  return solvers();
}

void register_solver(std::unique_ptr<Solver> solver) {
  for (const auto& known : solvers()) {
    if (known->name() == solver->name())
      throw std::invalid_argument(fmt::format("a solver \"{}\" exists already", solver->name()));
  }
  solvers().push_back(std::move(solver));
}

const Solver& find_solver(std::string_view name) {
  std::vector<std::string> known;
  for (const auto& solver : registry()) {
    if (solver->name() == name) return *solver;
    known.push_back(solver->name());
  }
  throw std::invalid_argument(unknown_name("solver", name, known));
}

}  // namespace accdec::solvers
