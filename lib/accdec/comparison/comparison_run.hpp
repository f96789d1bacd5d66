#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <accdec/batch/row_numbers.hpp>
#include <accdec/comparison/comparison_case.hpp>
#include <accdec/comparison/competitor.hpp>

namespace accdec::comparison {

/// Settings that are the same for every solver.
struct ComparisonSettings {
  std::string title, notes;
  std::vector<Competitor> solvers;
  std::vector<std::string>
      reduced;  ///< registry names of solvers that get the reduced form although they take equality rows
  int starts = 1, repeats = 5;
  std::uint64_t seed = 1;
  double time_limit = 5.0;   ///< s per run, told to the library and enforced at every evaluation
  double kill_after = 10.0;  ///< s until a run's process is killed
  std::int64_t evaluation_limit = 1'000'000;
  double tolerance = 1e-8;    ///< asked of the libraries
  double feasibility = 1e-7;  ///< absolute, on rows scaled to 1: used for judging
  double accuracy = 1e-4;     ///< of the objective, relative to max(1, reference): counts as reaching it
  std::vector<double> targets{1e-1, 1e-2, 1e-4};  ///< relative in the same way, for data profiles and runtime
                                                  ///< distributions
  double reference_time_limit = 30.0;             ///< s
};

/// One entry of the schedule.
struct ScheduledRun {
  bool reference = false;  ///< the case's reference value instead of a solver's run
  std::size_t case_index = 0, solver = 0;
  int start = 0, repeat = 0;
};

/// Cases x starts x solvers x repeats. References come first. Repeats are the outermost loop, and for every case, start
/// and repeat the solvers are shuffled again (seeded). So slow drifts of the machine, and other programs, affect all
/// solvers alike.
class Comparison {
 public:
  /// @throws std::invalid_argument for an unknown solver, no cases, no targets or counts below 1.
  Comparison(ComparisonSettings settings, std::vector<CaseSpec> cases);

  const ComparisonSettings& settings() const { return settings_; }
  const std::vector<CaseSpec>& cases() const { return cases_; }
  std::size_t size() const { return cases_.size() + per_repeat() * static_cast<std::size_t>(settings_.repeats); }
  std::size_t per_repeat() const {
    return cases_.size() * static_cast<std::size_t>(settings_.starts) * settings_.solvers.size();
  }
  /// @throws std::out_of_range
  ScheduledRun at(std::size_t index) const;
  /// Limits of an entry, s: until its evaluator ends it, and until its process is killed. The difference is that of the
  /// suite's own limits.
  double time_limit(const ScheduledRun& run) const;
  double kill_after(std::size_t index) const;
  /// A key of everything that an entry's line depends on, except the program's version: equal keys mean equal work.
  /// Empty for a case without identity.
  std::string key(std::size_t index) const;
  /// The same run's index in another repeat.
  std::size_t index_of(const ScheduledRun& run, int repeat) const;

  /// First line of the raw data: settings, and solvers with their versions and capabilities.
  batch::Row header() const;
  /// Runs an entry and returns its line of the raw data. Exceptions are recorded, not passed on.
  batch::Row run(std::size_t index) const;
  /// The line of an entry whose process was killed by the timer or crashed.
  batch::Row lost(std::size_t index, const std::string& reason) const;

 private:
  batch::Row beginning_of_run(const ScheduledRun& entry) const;
  batch::Row beginning_of_reference(std::size_t case_index, const ComparisonCase& subject) const;
  batch::Row reference_row(const ScheduledRun& entry) const;
  batch::Row run_row(const ScheduledRun& entry) const;
  /// The order of the solvers for a case, start and repeat.
  std::vector<std::size_t> order_of_solvers(std::size_t case_index, std::size_t start, std::size_t repeat) const;
  /// These two in comparison_solve.cpp.
  solvers::Options solver_options(const ScheduledRun& entry) const;
  void solve_into(batch::Row& row, const ScheduledRun& entry) const;
  /// The rest in comparison_design.cpp. @param task  of the case's order
  void design_into(batch::Row& row, const ScheduledRun& entry) const;
  void exact_into(batch::Row& row, const ScheduledRun& entry, const Task& task) const;
  void choice_into(batch::Row& row, const ScheduledRun& entry, const ComparisonCase& subject, const Task& task) const;

  ComparisonSettings settings_;
  /// Every entry builds its own case: a process that holds all cases takes three times as long to fork.
  std::vector<CaseSpec> cases_;
};

}  // namespace accdec::comparison
