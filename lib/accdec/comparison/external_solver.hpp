#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <accdec/solver.hpp>

namespace accdec::comparison {

/// A solver that is a program of the user: [[external]] of a suite.
struct External {
  std::string name;
  std::string command;  ///< words; {nl}, {mps}, {cbf} or {dat-s}, {answer}, {seconds} and {suite} are replaced
  std::string reads;    ///< nl, mps, cbf or dat-s
  std::string answer;   ///< sol: AMPL's solution file; values: a word, then one number for each variable; names
  std::string folder;   ///< of the suite, for {suite}
  int memory_max = 0;   ///< MB that every process of it may have; 0: no limit
  double grace = 1.0;   ///< s after the time limit, which {seconds} says, until it is killed: `kill_after_s` of a suite
};

/// The words of a command. Spaces outside of quotes ('..' or "..") split it. {name} is replaced by the value of the
/// place with this name; {{ and }} are braces of the command itself.
/// @throws std::invalid_argument if a {name} is no place, a brace or quote stands alone, or a word without quotes is an
/// operator of a shell
std::vector<std::string> command_words(const std::string& command, const std::map<std::string, std::string>& places);

/// Hashes of the files that a command names; answers of an earlier run hold for the same files only. A name is a word,
/// or a part of one between spaces, quotes and the signs =,;:|&<>(), or a word of a shell's command in it. It is an
/// absolute path, or that of a program in PATH. A folder with a __main__.py, which Python runs, counts with its first
/// 1000 files. Files that these load do not count. In program_state.cpp.
std::string program_state(const External& external);

/// The end of a program's run, beside its answer.
struct ProgramEnd {
  bool killed = false;                 ///< it broke a limit of time, output or files
  bool crashed = false;                ///< a signal ended it
  std::optional<solvers::Claim> late;  ///< the claim of an answer after the time limit
};

/// Runs it for every problem in a folder of its own, with the limits of `run_limited`. It is killed
/// `grace` after the time limit of the options, so that a program that keeps {seconds} can still write its answer. An
/// answer after the limit claims no more than "time limit"; `ProgramEnd` has its own claim. Its answer is judged like
/// every other. It gets problems in sparse form only.
class ExternalSolver final : public solvers::Solver {
 public:
  /// @param ended  told the end of each run
  explicit ExternalSolver(External external, std::function<void(const ProgramEnd&)> ended = {})
      : external_(std::move(external)), ended_(std::move(ended)) {}
  std::string name() const override { return external_.name; }
  std::string library_version() const override { return "command: " + external_.command; }
  solvers::Capabilities capabilities() const override;
  const External& external() const { return external_; }

 protected:
  solvers::Result do_solve(const nlp::Problem& problem, std::span<const double> start,
                           const solvers::Options& options) const override;

 private:
  void tell(const ProgramEnd& end) const;

  External external_;
  std::function<void(const ProgramEnd&)> ended_;
};

}  // namespace accdec::comparison
