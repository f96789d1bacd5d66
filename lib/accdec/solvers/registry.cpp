#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/solvers/registration.hpp>

namespace accdec::solvers {

const SolverList& registry() {
  static const SolverList list = [] {
    SolverList all;
    add_ipopt(all);
    return all;
  }();
  return list;
}

const Solver& find_solver(std::string_view name) {
  std::vector<std::string> known;
  for (const auto& solver : registry()) {
    if (solver->name() == name) return *solver;
    known.push_back(solver->name());
  }
  throw std::invalid_argument(fmt::format("unknown solver \"{}\"; known are {}", name, fmt::join(known, ", ")));
}

}  // namespace accdec::solvers
