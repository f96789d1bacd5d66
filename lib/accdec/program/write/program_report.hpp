#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include <accdec/program/plan/corner_bound.hpp>
#include <accdec/program/plan/plan_time.hpp>
#include <accdec/program/plan/program_plan.hpp>
#include <accdec/program/read/toolpath.hpp>
#include <accdec/program/simulate/leg_filters.hpp>
#include <accdec/task/result.hpp>
#include <accdec/task/task.hpp>

namespace accdec {

/// What becomes of programmed feeds.
enum class Feeds {
  keep,        ///< commanded as they are, but for blocks that would break a limit
  choose,      ///< upper bounds: feeds and steps of feed inside blocks are chosen, see schedule_feeds
  choose_only  ///< as choose, but without the plan that keeps them beside it
};

/// What `accdec program` answers; `accdec.program/1` in JSON.
struct ProgramResult {
  std::string program;  ///< the file
  Status status = Status::failed;
  Filter filter{{1.0}};               ///< the given or designed one
  LegFilters legs{Filter{{1.0}}};     ///< those the legs pass through: `filter` alone, or its shape in several lengths
  double sample_period = 0.0;         ///< s
  Machine task_machine;               ///< the task's
  std::size_t programmed_blocks = 0;  ///< of the program; those of the path are more where it steps its feeds
  bool feeds_chosen = false;          ///< the plan chose feeds and steps of feed
  Toolpath path;                      ///< with lowered feeds, where the plan lowered any
  ProgramPlan plan;
  std::size_t corners = 0;         ///< joints that turn or stop
  std::size_t delayed = 0;         ///< of these with a delay
  std::size_t exact_stops = 0;     ///< of these with the delay of an exact stop
  std::size_t raised = 0;          ///< joints with a longer delay than they would need alone
  double worst_error = 0.0;        ///< m, over joints that have a tolerance
  double worst_utilisation = 0.0;  ///< error/tolerance, and its line
  std::uint32_t worst_line = 0;
  std::size_t worst_shown = 5;            ///< corners that JSON and the summary list, see worst_corners
  double cycle_time = 0.0;                ///< s, samples of the simulation times T
  std::optional<double> cycle_time_kept;  ///< s, planned at the programmed feeds; not for programs of more than 200 000
                                          ///< blocks
  double cycle_time_one_filter = 0.0;     ///< s, planned with `filter` for every leg
  double cycle_time_exact_stop = 0.0;  ///< s, with an exact stop after every block (the chords of an arc are one block)
  std::string exact_stop_breaks;       ///< the limit that this nevertheless breaks most; empty: it holds all
  double cycle_time_no_delay = 0.0;    ///< s, no delay but where the program stops
  double lower_bound =
      0.0;  ///< s, see program_lower_bound; at the programmed feeds, rapid moves at their axes' largest velocity
  std::optional<double> filter_bound;       ///< s, see filter_lower_bound; at the programmed feeds, where asked for
  std::optional<CornerBound> corner_bound;  ///< by whoever asks for it
  std::int64_t peak_memory = 0;             ///< bytes of the process, by whoever runs it; 0: not asked for
  double delay_total = 0.0;                 ///< s, delays of this plan
  std::vector<PlanTime> candidates;         ///< plans that were made beside this one
  VerificationReport verification;
  SolverReport solver;
  std::string message;
};

/// Plans and verifies a program with a given filter, or, where that is faster, with one of its shape for every leg.
/// `feasible` only if every joint holds its tolerance and every axis limit and vibration bound is held over the whole
/// program, else `failed` with the worst in the message.
/// With Feeds::choose the plan at the programmed feeds is a candidate, so that what comes is never slower than it.
ProgramResult run_program(const std::string& name, Toolpath path, const Filter& filter, const Task& task,
                          bool per_leg = false, bool filter_bound = false, Feeds feeds = Feeds::keep);

/// Fills in what follows from the delays, errors and uses of the axis limits in `plan`, and from the filters: counts
/// and the worst of the joints, vibration, whether all holds.
/// @param machine  as many axes as the path
void judge_program(ProgramResult& result, const Machine& machine);

/// Largest distance by which points of arcs were moved out, m, see compensate_arcs.
double widest(const Toolpath& path);

/// A joint and how much of its tolerance it uses.
struct CornerUse {
  std::uint32_t line = 0;    ///< of the block that ends in it
  double error = 0.0;        ///< m
  double tolerance = 0.0;    ///< m
  double utilisation = 0.0;  ///< of the tolerance
  int delay = 0;             ///< samples
};
/// The joints with the largest errors against their tolerances, worst first, at most `count`; in the order of the
/// program where equal. Of the chords of an arc, and whatever else ends in one line after another, the worst only.
std::vector<CornerUse> worst_corners(const ProgramResult& result, std::size_t count);

/// Ends with a line feed. In program_report_json.cpp.
std::string program_to_json(const ProgramResult& result);
/// line,delay_samples,corner_error_m,error_max_m; one row a joint that turns, stops or has a delay. The last is empty
/// without bound.
std::string delays_to_csv(const ProgramResult& result);
/// The table for people. In program_summary.cpp.
std::string program_summary(const ProgramResult& result);

/// The program with what realises the plan on a controller that filters its commands: after a delayed joint a dwell of
/// the delay (G4 P, seconds), which must act before the filter and without an exact stop; feeds where the plan lowered
/// them; the path mode of every joint (G61.1, G61, G64 P). Arcs are written as their chords, in mm and absolute. Words
/// of the program that are not about motion, its stops and dwells are kept in place. Read again with
/// ToolpathOptions::dwells_before_filter it plans to the same motion, but for the way to where it begins. In emit.cpp.
void emit_program(const ProgramResult& result, std::ostream& out);

}  // namespace accdec
