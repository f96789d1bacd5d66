#pragma once

#include <memory>
#include <vector>

#include <accdec/solvers/solver.hpp>

namespace accdec::solvers {

using SolverList = std::vector<std::unique_ptr<Solver>>;

// One function a library, each in its own file; registry.cpp calls them in this order.
void add_ipopt(SolverList& list);
void add_nlopt(SolverList& list);
void add_ceres(SolverList& list);
void add_clp(SolverList& list);

}  // namespace accdec::solvers
