// Planning and verification of whole programs.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include <accdec/files.hpp>
#include <accdec/machine.hpp>
#include <accdec/result.hpp>
#include <accdec/simulate.hpp>
#include <accdec/task.hpp>

namespace accdec {

/// Programs of more blocks are planned in one way only, as several would take many times as long. Plan fixed also keeps
/// their feeds if that may be faster.
inline constexpr std::size_t several_plans_max = 200'000;

/// Another plan that was made to find the fastest plan that holds.
struct PlanTime {
  std::string plan;       ///< "fixed", "profiles" or "free"
  double time = 0.0;      ///< s, simulated
  bool verified = false;  ///< every sample, all bounds
  std::string broken{};   ///< else the worst of what it breaks
};

/// The findings of a check of every sample of a motion.
struct SampleCheck {
  std::int64_t samples = 0;      ///< from the last at rest to the first at rest (the first whose velocity is 0 again)
  std::vector<LimitUse> limits;  ///< worst use of every finite limit of every axis
  bool limits_hold = true;
  bool errors_hold = true;
};

/// Multipliers that prove a bound for any motion from one stop to the next. THEORY.md, "Weights of a whole motion", has
/// K, M and p.
struct MotionProof {
  struct Leg {
    std::size_t last = 0;                                 ///< its last block
    double time = 0.0;                                    ///< s, a guess
    std::vector<double> shares;                           ///< ends of its pieces, 0 to 1
    std::vector<std::vector<double>> acceleration, jerk;  ///< K and M at every share, a value for every axis
    std::vector<std::vector<double>> way;                 ///< p of every piece, a value for every axis
  };
  std::size_t first = 0;  ///< block
  std::vector<Leg> legs;  ///< up to the next stop
};

/// A lower bound on the time of motions that are sums of monotone legs, one a block. It holds if no other leg moves
/// when the motion is fastest on a leg that counts. A free motion may be faster, see `any_motion`.
struct CornerBound {
  double time = 0.0;                ///< s
  double any_motion = 0.0;          ///< s, that of any motion within the tolerances; 0: not asked for
  bool any_motion_complete = true;  ///< as `complete`
  std::size_t corners = 0;          ///< joints that turn
  std::size_t counted = 0;  ///< of these, joints whose legs are longer than cutting their corners needs; the others
                            ///< cost nothing
  std::size_t classes = 0;  ///< linear programs solved
  bool complete = true;     ///< false if programs or time ran out: further corners cost nothing
  double proved = 0.0;      ///< s, of `any_motion`, by `proofs`
  std::vector<MotionProof> proofs;  ///< of sections between stops; others count 0
};

/// Blocks slowed because the filter breaks one axis limit at a start or stop at their programmed feed, with any delay.
struct SlowedFeeds {
  std::string limit;       ///< "jerk x"
  std::size_t blocks = 0;  ///< how many
  double factor = 1.0;     ///< remaining part of the feed of the block slowed most
  std::uint32_t line = 0;  ///< line of that block
};

/// A plan when the operator overrides the feed: every F of the emitted program counts so many times. Filter, delays (in
/// samples), dwells and G0 stay.
struct FeedOverride {
  double factor = 1.0;             ///< on the feeds
  double worst_error = 0.0;        ///< m, over joints that have a tolerance
  double worst_utilisation = 0.0;  ///< error/tolerance, and its line
  std::uint32_t worst_line = 0;
  double limit_utilisation = 0.0;  ///< the largest use of an axis limit
  std::string limit;               ///< which: "jerk x"; empty without limits
};

/// Settings of a control for one program. The kinds of the chosen settings are those of every block's end.
struct ProgramSettings {
  ChosenSettings chosen;
  double width = 0.0;                     ///< m, the in-position width that was planned with; 0: none
  long members = 0, tried = 0;            ///< settings that the families have; of these planned
  long guessed = 0;                       ///< of these guessed from corners by themselves; most of those planned, too
  bool complete = false;                  ///< none of the others can be faster
  bool is_today = false;                  ///< the task's own setting is the fastest
  std::optional<double> search_limit{};   ///< s, that ended the search; none: complete, or the caller's time ended it
  std::optional<ChosenSettings> today{};  ///< the task's own setting; none: it names none that can be set
  std::string breaks{};                   ///< as `today_breaks`, of these: blocks are slowed for it
  std::string today_not_had{};            ///< a sentence: why the control has no such setting; empty: it has
  /// s, of the fastest plan found with free taps and delays of any number of samples. None is looked for in programs of
  /// more than `several_plans_max` blocks, or after the deadline.
  std::optional<double> free_taps{};
  std::optional<double> free_taps_limit{};              ///< s, by the clock, that the search for these taps had at most
  std::shared_ptr<const ControllerSettings> control{};  ///< whose they are; null: not known
};

/// The treatment of programmed feeds.
enum class Feeds {
  keep,           ///< commanded as they are, except in blocks that would break a limit
  choose,         ///< upper bounds: feeds and steps of feed inside blocks are chosen
  choose_only,    ///< as choose, but without the additional plan that keeps them
  choose_fitting  ///< as choose, with a filter that was designed for chosen feeds: the plan that keeps them is only
                  ///< refined if it comes near
};

/// A number that the planner of another control works with.
struct ControlParameter {
  std::string name;  ///< as its settings name it: "square_corner_velocity"
  std::string unit;  ///< "mm/s"; may be empty
  double value = 0.0;
  std::string from;  ///< "task"; "default", of the control; "given", by the caller
};

/// The time that another control would need. An estimate: nothing in it is proved.
struct ControlEstimate {
  std::string control;  ///< one of estimated_controls()
  double time = 0.0;    ///< s, from the first motion to the last rest, dwells included
  std::vector<ControlParameter> parameters;
  std::vector<std::string> unknown;  ///< what the task or the program asks for and this control does not know
};

/// The force of an axis over a whole program, dwells and rests included. Behind a servo, the axis still moves after the
/// last sample of the program: peak and mean count that motion, too. The mean is over the program's time, as in a
/// program that is repeated without a pause.
struct AxisLoad {
  std::string axis;
  double peak = 0.0;           ///< N, largest |F|
  double rms = 0.0;            ///< N, root of the mean of F^2: what heats the drive
  double rms_max = unlimited;  ///< N, the axis' rating
};

/// The point of an arc that uses most of what the motion may be off it.
struct ArcError {
  double error = 0.0, tolerance = 0.0;  ///< m
  std::uint32_t line = 0;
};

/// The largest distance of a motion from the line of a straight leg, while no other leg is felt. About 1e-4 of the
/// motion along legs before is left then, and the command of the next one has not begun.
struct LegError {
  double error = 0.0;      ///< m
  std::uint32_t line = 0;  ///< where the leg begins
};

/// The motion behind the servo, where it is not the command.
struct ServoReport {
  double settling = 0.0;           ///< s, from the end of the command until the motion stays within `within` of its end
  double within = 0.0;             ///< m, the least tolerance of a joint; 1 um without
  double stop_error = 0.0;         ///< m, the largest error of a stop, where the control waits for the command
  std::optional<LegError> legs{};  ///< where servos of axes differ; none: every leg still feels another
};

/// The program and the task of a result: the same for every plan.
struct ProgramSubject {
  std::string program;                ///< the file
  ToolpathOptions reading;            ///< of the plan's path, by run_program_file
  double sample_period = 0.0;         ///< s
  Machine task_machine;               ///< the task's
  std::size_t programmed_blocks = 0;  ///< that move
  std::size_t programmed_moves = 0;   ///< straight moves of the program, chords of its arcs one by one; the plan's path
                                      ///< has more where it steps its feeds
};

/// The answer of `accdec program`, whatever the plan; `accdec.program/2` in JSON.
struct ProgramResult : ProgramSubject {
  Status status = Status::failed;
  Plan plan;
  std::vector<double> errors;         ///< m, of the joint at the end of every block of the plan's path
  SampleCheck check;                  ///< of every sample; vibration bounds stand last among its limits
  bool feeds_chosen = false;          ///< the plan chose feeds and steps of feed
  std::size_t slowed = 0;             ///< blocks whose feed had to be lowered
  std::vector<SlowedFeeds> too_fast;  ///< of these, those too fast for the contour, or to start or stop
  int rounds = 0;                     ///< of repair
  std::size_t corners = 0;            ///< joints that turn or stop, those inside arcs left out
  std::size_t delayed = 0;            ///< of these with a delay
  std::size_t at_rest = 0;            ///< of these passed at rest
  std::size_t raised = 0;             ///< joints with a longer delay than they would need alone
  double worst_error = 0.0;           ///< m, over joints that have a tolerance
  double worst_utilisation = 0.0;     ///< error/tolerance, and its line
  std::uint32_t worst_line = 0;
  std::optional<ArcError> arcs;           ///< of programs with arcs of up to `several_plans_max` blocks
  std::size_t worst_shown = 5;            ///< corners that JSON and the summary list
  double cycle_time = 0.0;                ///< s, samples of the motion times T
  double delay_total = 0.0;               ///< s, of all delays
  std::optional<double> cycle_time_kept;  ///< s, planned at the programmed feeds; none where no such plan holds, nor
                                          ///< above `several_plans_max` blocks if that is clearly slower
  bool kept_same_filter = false;  ///< that plan has this one's filter, which was chosen for other feeds; else its own
  std::optional<double> cycle_time_exact_stop;  ///< s, of a command: with an exact stop after every block (the chords
                                                ///< of an arc are one block), as the plan at the programmed feeds
  std::string exact_stop_breaks;                ///< the limit that this nevertheless breaks most; empty: it holds all
  std::optional<double> cycle_time_no_delay;    ///< s, of a command: no delay but where the program stops
  double lower_bound = 0.0;  ///< s, of any motion; at the programmed feeds, rapid moves at their axes' largest velocity
  std::optional<double> filter_bound;       ///< s, of filters and delays; at the programmed feeds, where asked for
  std::optional<CornerBound> corner_bound;  ///< by whoever asks for it
  std::int64_t peak_memory = 0;             ///< bytes of the process, by whoever runs it; 0: not asked for
  std::vector<PlanTime> candidates;         ///< plans that were made beside this one
  std::optional<ProgramSettings> settings;  ///< of a control, where the task asks for them
  std::optional<double> today;              ///< s, of the program with today's setting of the control, if that was
                                            ///< planned, too; unlimited: no plan with it holds all limits
  std::string today_breaks;                 ///< "jerk x in line 3": what that breaks at programmed feeds that are kept
  std::string taps_control;                ///< for a control of taps: the task's filter in words, or "taps"; else empty
  std::string compensation;                ///< why arcs that were to be widened are not; empty: nothing to say
  std::vector<AxisLoad> loads;             ///< of the axes that have a mass or damping; of programs of up to
                                           ///< `several_plans_max` blocks
  std::optional<ServoReport> servo;        ///< behind a servo, of programs of up to `several_plans_max` blocks
  std::vector<FeedOverride> overrides;     ///< of programs of up to `several_plans_max` blocks
  std::vector<ControlEstimate> estimates;  ///< of other controls' times, by whoever asks for them
  VerificationReport verification;
  SolverReport solver;
  std::string message;
};

/// "klipper", "grbl" and "linuxcnc-2.9".
const std::vector<std::string>& estimated_controls();

/// The names of the parameters of a control, in the order of ControlEstimate::parameters.
/// @throws std::invalid_argument for another control
std::vector<std::string> parameters_of_control(std::string_view control);

/// Runs the rules of a control's planner on a program, with its look-ahead always full. The page estimates.md
/// has the sources.
/// @param path     as it was read
/// @param machine  the task's; axes are found by their names
/// @param given    parameters by their names, in the units of ControlParameter
/// @throws std::invalid_argument for an unknown control or parameter, a value out of its range, an axis other than X Y
///         Z (of linuxcnc-2.9: none), and for a moving axis without acceleration limit
ControlEstimate estimate_time(const Toolpath& path, const Machine& machine, std::string_view control,
                              const std::map<std::string, double>& given = {});

/// One estimate a control.
/// @param given  each belongs to one of the controls at least
/// @throws std::invalid_argument as estimate_time
std::vector<ControlEstimate> estimate_times(const Toolpath& path, const Machine& machine,
                                            const std::vector<std::string>& controls,
                                            const std::map<std::string, double>& given = {});

/// "klipper would take 12.34 s: an estimate with ..", and what the control does not know. Each line ends with a line
/// feed. @param plan_time  s, of accdec's plan; 0: there is none
std::string estimate_text(const ControlEstimate& estimate, double plan_time);

/// A plan at programmed feeds, made again with its path and filter: two values a block, or none.
struct KnownPlan {
  std::vector<double> duration;  ///< s
  std::vector<int> delays;       ///< samples
  std::size_t slowed = 0;        ///< blocks below their programmed feed
};

/// A path to plan, and what is asked of the plan.
struct PlanningProblem {
  std::string program;  ///< the file
  Toolpath path;
  Task task;
  Feeds feeds = Feeds::keep;  ///< plan profiles always chooses them
  Deadline deadline{};        ///< ends the planning: the fastest plan so far is the answer; `failed` if none holds
  bool filter_bound = false;  ///< see FixedOptions
};

/// Plans and verifies a program with a given filter. `feasible` only if every joint holds its tolerance and every axis
/// limit and vibration bound is held over the whole program, else `failed` with the worst in the message. With
/// Feeds::choose the plan at the programmed feeds is a candidate, so that the answer is never slower than it.
/// @param known  a plan that held: it is a candidate if the deadline is over
ProgramResult run_program(PlanningProblem problem, const Filter& filter, const KnownPlan& known = {});

/// Plans profiles, samples and verifies them. The bounds are left to whoever asks for them.
/// @throws std::invalid_argument for vibration bounds that no last filter holds, and for delays that the program brings
///         along: they belong to a filter that this plan does not have
ProgramResult run_profiles(PlanningProblem problem);

/// Ends with a line feed.
std::string program_to_json(const ProgramResult& result);
/// The delays of a plan fixed: line,delay_samples,corner_error_m,error_max_m; one row a joint that turns, stops or has
/// a delay. The last is empty without bound.
std::string delays_to_csv(const ProgramResult& result);
/// The table for people.
std::string program_summary(const ProgramResult& result);

/// Writes a plan fixed as a program for a controller that filters its commands. A delayed joint is followed by a dwell
/// of the delay (G4 P, seconds), which must act before the filter and without an exact stop. Lowered feeds and the path
/// mode of every joint (G61.1, G61, G64 P) are written, too. Arcs become their chords, in mm and absolute. Stops,
/// dwells and words that are not about motion stay in place. Read with ToolpathOptions::dwells_before_filter, the
/// program plans to the same motion, except for the way to where it begins. For a named controller the words are those
/// of its file; only its in-position, exact-stop and continuous corners then stand in the program.
/// @throws std::invalid_argument if the controller's file has no words for what the plan needs
void emit_program(const ProgramResult& result, std::ostream& out);

/// The plans of a program.
///
/// fixed: one filter for all of it.
///
/// profiles: a filter and a speed at every corner, or one filter or a motion along the arcs if that is faster.
///
/// free: a position for every sample.
enum class PlanKind { fixed, profiles, free };

/// Their names, in this order.
const std::vector<std::string>& plan_names();

/// @throws std::invalid_argument unless it is one of these names
PlanKind plan_kind(std::string_view name);

/// Options of plan fixed.
struct FixedOptions {
  Feeds feeds = Feeds::choose;
  bool filter_bound = false;          ///< also the bound on filters and delays, by linear programs
  bool compensate_arcs = false;       ///< the commanded radius is widened by the radius error of the filter
  bool dwells_before_filter = false;  ///< see ToolpathOptions
};

/// How far planner `free` is.
struct FreeProgress {
  std::string stage;    ///< "bounds", "sweep 2 over the samples"
  double gained = 0.0;  ///< s, by all sweeps so far
  double share = 0.0;   ///< of the sweep
};

/// Options of plan free. Its answer depends on the time limit only.
struct FreeOptions {
  int threads = 1;                                    ///< that shorten the motion
  int sweeps = 10;                                    ///< over all samples, at most
  std::function<void(const FreeProgress&)> progress;  ///< told at every stage and part of a sweep, one at a time
  void tell(const char* stage) const {
    if (progress) progress({.stage = stage});
  }
};

/// How a program file is read and planned. Unset options follow from the task and the feeds.
struct ProgramFileOptions {
  PlanKind plan = PlanKind::fixed;
  std::optional<double> arc_tolerance;  ///< m, largest distance of a chord from its arc; none: chord_tolerance, 2 um
                                        ///< where feeds are kept, which does not see accelerations along an arc
  ProgramTools tools;                   ///< for programs that rs274 has to run
  bool rapid_stops = false;             ///< see ToolpathOptions
  FixedOptions fixed;
  FreeOptions free;
  std::optional<double> time_limit;  ///< s, for all: a filter gets half of it; none: a filter 2 s and 5 ms a block, at
                                     ///< most 60, and planning as long as it takes
  Deadline deadline;                 ///< of `time_limit`, from when the command began
};

/// A program as read.
struct ProgramFile {
  std::string name;  ///< where it is
  Toolpath path;
  ToolpathOptions reading{};
  bool interpreted = false;  ///< by rs274
};

/// The toolpath by our own reader, or through rs274 if only an interpreter of the whole language understands the
/// program.
/// @param tell  called with text that a user should know about this; may be empty
/// @throws std::invalid_argument  "file:line:column: ..", where the program is not understood
ProgramFile read_program_file(const std::string& file, const Task& task, const ProgramFileOptions& options,
                              const std::function<void(const std::string&)>& tell);

/// Plans and verifies what was read, as `accdec program` does, with the bounds of any motion.
///
/// * fixed: the filter is the task's, the one in a program that --emit wrote, or one designed for the program. If none
///   holds, the result has no plan and says why.
/// * profiles: programs of up to `several_plans_max` blocks are also planned with one filter, and arcs by a motion
///   along them (plan free). The answer is the fastest of the plans that hold all limits, with the times of the others
///   as its candidates. If none holds, it is the plan
///   profiles with a message.
/// * free: the fastest of these plans, shortened sample by sample. If nothing is gained, it is the answer.
/// @param file  it may be read again with longer chords for arcs; see ProgramResult::reading
/// @param tell  one line a step, may be empty
/// @throws std::invalid_argument  for a limit or an option that the plan does not keep, by name
ProgramResult run_program_file(ProgramFile file, const Task& task, const ProgramFileOptions& options,
                               const std::function<void(const std::string&)>& tell);

}  // namespace accdec
