#include <algorithm>
#include <map>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/files/suggestion.hpp>
#include <accdec/solvers/module.hpp>
#include <accdec/solvers/registration.hpp>

namespace accdec::solvers {

namespace {

/// The modules, in the order of the registry. The names of a module's solvers begin with the module's.
constexpr const char* modules[] = {
    "ipopt",  "nlopt", "ceres", "clp",
#ifdef ACCDEC_BONMIN_VERSION
    "bonmin",
#endif
};

struct Registry {
  SolverList list;
  std::map<std::string, std::string> missing;  // why a module was not loaded
};

Registry& loaded() {
  static Registry all = [] {
    Registry found;
    for (const char* module : modules) {
      try {
        module_function<decltype(accdec_add_solvers)>(module, "accdec_add_solvers")(found.list);
      } catch (const std::runtime_error& e) {
        found.missing[module] = e.what();
      }
    }
    return found;
  }();
  return all;
}

}  // namespace

const SolverList& registry() {
  return loaded().list;
}

const std::map<std::string, std::string>& missing_modules() {
  return loaded().missing;
}

std::vector<std::pair<std::string, std::string>> libraries() {
  return {
      {"Ipopt", ACCDEC_IPOPT_VERSION},   {"NLopt", ACCDEC_NLOPT_VERSION},
      {"Ceres", ACCDEC_CERES_VERSION},   {"Clp", ACCDEC_CLP_VERSION},
#ifdef ACCDEC_BONMIN_VERSION
      {"Bonmin", ACCDEC_BONMIN_VERSION},
#endif
  };
}

void register_solver(std::unique_ptr<Solver> solver) {
  for (const auto& known : registry()) {
    if (known->name() == solver->name())
      throw std::invalid_argument(fmt::format("a solver \"{}\" exists already", solver->name()));
  }
  loaded().list.push_back(std::move(solver));
}

const Solver& find_solver(std::string_view name) {
  std::vector<std::string> known;
  for (const auto& solver : registry()) {
    if (solver->name() == name) return *solver;
    known.push_back(solver->name());
  }
  for (const auto& [module, reason] : missing_modules()) {
    if (name.starts_with(module)) throw std::runtime_error(fmt::format("solver \"{}\": {}", name, reason));
  }
  throw std::invalid_argument(unknown_name("solver", name, known));
}

}  // namespace accdec::solvers
