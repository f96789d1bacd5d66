// Design of filter and delays, and which limits prevent a better one.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <accdec/machine.hpp>
#include <accdec/result.hpp>
#include <accdec/solver.hpp>
#include <accdec/task.hpp>

namespace accdec {

enum class Method {
  exact,  ///< branch on (N, d, k) with linear programs: proves the shortest corner
  nlp     ///< smooth relaxation, rounding and repair with any registered solver: verified, nothing proved
};

struct DesignOptions {
  Method method = Method::exact;
  double time_limit = 600.0;                         ///< s, for the whole design
  const std::atomic<bool>* cancel = nullptr;         ///< ends the search early with the best verified design so far
  std::function<void(const std::string&)> progress;  ///< one line per step; may be empty

  struct Exact {
    double gap = 0.0;         ///< ends once (best - bound)/best is at most this
    bool certificate = true;  ///< keep the proof in the result
    int threads = 1;          ///< for the proof of several corners; the answer does not depend on it
  };
  Exact exact;  ///< for Method::exact

  /// A task with limits that the exact method does not know is designed by these, too.
  struct Nlp {
    std::string solver = "ipopt";  ///< registry name
    solvers::Options options;      ///< tolerance, seed, native options of every single solve
    std::optional<Filter> start;   ///< the start at its order; otherwise a trapezoid
    std::optional<bool> reduced;   ///< substitute positions into their bounds; else only where the solver needs it
    /// Called with every verified design that is shorter than the one before, and the counts so far.
    std::function<void(double objective, const nlp::Counts& so_far)> improved;
  };
  Nlp nlp;  ///< for Method::nlp
};

/// Chooses what the task leaves open (filter, order, delays) for the least cycle time within all limits.
/// The result is verified by simulation, or its status is infeasible or failed and it carries no filter.
/// @throws std::invalid_argument for an unknown solver or native option.
DesignResult design_task(const Task& task, const DesignOptions& options = {});

/// For a given filter and free delays (given ones are kept): for every corner the smallest delay at which its error
/// bound and all limits hold. All delays from the smallest one that the corner error allows are tried, so the result is
/// the optimum.
DesignResult design_delays(const Task& task, const DesignOptions& options = {});

/// Filter and delays by nonlinear programming, see Method::nlp.
DesignResult design_nlp(const Task& task, const DesignOptions& options = {});

/// A number of a task that restricts a design: the bound of a limit, a feed, the highest order, a given delay.
struct Lever {
  std::string name;                                  ///< "acceleration x", "corner error A", "feed in A"
  std::string key;                                   ///< of a task file, as in studies: "axis.x.jerk_max_mm_s3"
  std::string unit;                                  ///< for people
  double per_si = 1.0;                               ///< value in `unit` = per_si * value in SI
  std::optional<LimitKind> kind;                     ///< none: not a limit of the machine or the corner
  std::string axis, corner;                          ///< empty if it belongs to none
  double frequency_low = 0.0, frequency_high = 0.0;  ///< Hz, of vibration
  double value = 0.0;                                ///< SI, the task's value
  double end = unlimited;                            ///< SI, the value that gives all the room there is
  double scale = 0.0;                                ///< SI, > 0: shares are parts of this: the value, or if it is 0: 1
                                                     ///< um, 0.1 % of residual, one sample
  bool upper = true;                                 ///< a larger value gives more room
  bool whole = false;                                ///< whole numbers only
  std::function<void(Task&, double)> set;            ///< SI

  /// The value with a share of more room: value (1 +- share), not beyond `end`. Whole numbers change by at least one.
  double moved(double share) const;
  /// Whether this is a use of the lever's limit.
  bool concerns(const LimitUse& use) const;
};

/// Levers that are moved together by the same share: a single one, the same limit on all axes or at all corners, or
/// all.
struct Room {
  std::string name;  ///< "jerk x", "jerk of all axes"
  std::string key;   ///< "axis.*.jerk_max_mm_s3"; empty if no single key sets them all
  std::vector<Lever> levers;

  Task given_to(const Task& task, double share) const;
  /// The task with every lever at its end.
  Task all_given_to(const Task& task) const;
};

/// Every limit that a task has, in the order of axes, corners and modes.
std::vector<Lever> limit_levers(const Task& task);

/// Other numbers than limits that can prevent a design: feeds (a pair of levers for every corner), the highest order,
/// given delays. Tasks with a given filter have no choice of order. With many corners, only the feeds of all corners
/// together are asked about.
std::vector<Room> other_rooms(const Task& task);
/// The highest order, as in `other_rooms`.
Lever order_lever(const Task& task);

/// With more corners than this, only all together are asked about, not each one: every question takes a design.
inline constexpr std::size_t corners_apart_max = 1000;

/// One room for each lever. If a kind has several levers, a room that holds them all comes first.
std::vector<Room> rooms_of(const std::vector<Lever>& levers);

/// A limit with this utilisation or more counts as used to the full.
inline constexpr double full_use = 0.999;
/// The smallest change that makes a task feasible is found to this part of the value. It is then rounded to four
/// digits, away from the given value.
inline constexpr double remedy_tolerance = 1e-3;

/// Samples of one event at which the design found uses a limit to the full. Another design of the same time may use
/// other limits.
struct Binding {
  LimitKind kind{};
  std::string axis, corner;  ///< empty where it belongs to none
  Event event = Event::none;
  std::vector<int> samples;  ///< k within the event, ascending; empty for vibration
  double bound = 0.0;        ///< SI
  double frequency = 0.0;    ///< Hz, vibration only
  double damping = 0.0;      ///< damping ratio, vibration only
};

/// Saving by more room for some limits, in s of the objective, compared with the design found.
struct Gain {
  Room room;
  bool solved = false;      ///< false: follows from more room for a larger set that gains nothing
  double gain = 0.0;        ///< s, >= 0: saving of a design that was verified by simulation
  double at_most = 0.0;     ///< s: upper bound on the gain, by a rechecked proof; infinite without one
  double objective = 0.0;   ///< s, with that room
  int order = 0;            ///< of the design with that room; if nothing is gained, of the design found
  std::vector<int> delays;  ///< one per corner

  bool proved() const { return at_most <= gain + 1e-9 * objective; }
};

/// The smallest change with which an infeasible task has a design: of one limit, or of several by the same share.
struct Remedy {
  Room room;
  enum class Help { yes, no, unknown } help = Help::unknown;  ///< no: it is proved that no change is enough
  double share = 0.0;                                         ///< part of every lever's scale
  std::vector<double> values;  ///< SI, of every lever: with them the task has a design, verified by simulation
  bool smallest = false;       ///< it is proved that a change smaller by `remedy_tolerance` is not enough
  double objective = 0.0;      ///< s, of the design with these values
};

struct ExplainOptions {
  DesignOptions design;  ///< for every single solve, its time limit in processor time; no progress is reported.
                         ///< If nothing can be proved, as of servos that differ, all solves share that time
  double time_limit = unlimited;  ///< s, for all solves together; after it the answer is what is known by then
  double share = 0.1;             ///< more room to try, 0 < share < 1
  /// Called before every solve except the first: number of solves done, and their expected total.
  std::function<void(int done, int total)> progress;
};

/// The limits that prevent a shorter design, or any design.
struct Explanation {
  DesignResult base;              ///< the task's own design
  bool base_proved = false;       ///< its bound was rechecked: `optimal` is confirmed
  double share = 0.0;             ///< of the options
  std::vector<Binding> bindings;  ///< where limits are used to the full
  std::vector<Gain> gains;        ///< largest first; for a task with a design
  std::vector<Lever> not_moved;   ///< limits whose value is 0: a share of it does not exist
  std::vector<Remedy> remedies;   ///< for an infeasible task: smallest change first, then those that do not help
  int solves = 0;
  double shared = 0.0;   ///< s, that all solves shared because nothing can be proved; 0: each had its own time
  bool complete = true;  ///< false: cancelled or out of time
};

/// Explains a task by solving it again with more room for its limits.
///
/// With a design: every limit is relaxed by `share` and the task designed again, and so is every kind of limit on all
/// axes or corners together. Designs are verified by simulation, bounds are rechecked. Utilisation only decides what is
/// solved first. Limits that the design uses little are relaxed all together; if that gains nothing, none of them gains
/// anything alone.
///
/// Without a design: every limit, the feeds, the highest order and given delays get all possible room. If that is
/// enough, doubling and bisection find the smallest change.
/// @throws std::invalid_argument unless 0 < share < 1
Explanation explain_task(const Task& task, const ExplainOptions& options = {});

/// The places where a verified design uses limits to the full, from its simulated motion. They are sorted by corner,
/// then in the order of limits and events.
std::vector<Binding> find_bindings(const DesignResult& design);

}  // namespace accdec
