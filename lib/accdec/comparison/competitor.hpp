#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include <accdec/solver.hpp>

namespace accdec::comparison {

/// The entry of the exact method. It takes designs only.
inline constexpr const char* exact_name = "exact";

class ExternalSolver;

/// A solver in a comparison: the form of the problems it gets, and the options of its library.
struct Competitor {
  enum class Form { suited, sparse, reduced };  ///< `suited`: the form the suite gives all entries of this solver

  std::string name;    ///< in tables and figures, unique in a comparison
  std::string solver;  ///< registry name
  Form form = Form::suited;
  std::map<std::string, std::string> native;  ///< the library's own options
  /// A program of the user, or the exact method, instead of a registered solver.
  std::shared_ptr<const solvers::Solver> external;
  std::string state;  ///< `program_state` of a program when the suite was read

  bool is_exact() const { return solver == exact_name; }
  /// The program of the user; null for others.
  const ExternalSolver* program() const;

  /// @throws std::invalid_argument for a solver that is not registered.
  const solvers::Solver& registered() const { return external ? *external : solvers::find_solver(solver); }

  /// Solves a problem of one variable, so that the timed run does not include loading the library. Does nothing for a
  /// program.
  /// @throws std::invalid_argument for options that the library does not have.
  void warm_up() const;

  /// Whether it gets the reduced form: if it asks for it, takes no equality rows or only finite bounds, or is in
  /// `reduced`.
  bool wants_reduced(const std::vector<std::string>& reduced) const;
};

/// A competitor from an entry of a list of solvers: "exact", a registry name, or "NAME/sparse" or "NAME/reduced" for a
/// solver that takes equality rows.
Competitor competitor_from_entry(const std::string& entry);

/// Whether a solver takes both forms of a problem.
bool takes_both_forms(const solvers::Solver& solver);

}  // namespace accdec::comparison
