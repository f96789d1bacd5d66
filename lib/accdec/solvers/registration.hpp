#pragma once

#include <memory>
#include <vector>

#include <accdec/solver.hpp>

namespace accdec::solvers {

using SolverList = std::vector<std::unique_ptr<Solver>>;

}  // namespace accdec::solvers

/// Every module of a solver library defines this one, in the library's file. registry.cpp calls it.
extern "C" void accdec_add_solvers(accdec::solvers::SolverList& list);
