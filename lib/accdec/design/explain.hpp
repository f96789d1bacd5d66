#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <accdec/design/design.hpp>
#include <accdec/design/explain_levers.hpp>

namespace accdec {

/// From this utilisation on a limit counts as used to the full.
inline constexpr double full_use = 0.999;
/// The smallest change that makes a task feasible is found to this share of the value (plus rounding it away from the
/// value as given, to four digits).
inline constexpr double remedy_tolerance = 1e-3;

/// Samples of one event at which a limit is used to the full by the design found. Another design of the same time may
/// use others.
struct Binding {
  LimitKind kind{};
  std::string axis, corner;  ///< empty where it belongs to none
  Event event = Event::none;
  std::vector<int> samples;  ///< k within the event, ascending; empty for vibration
  double bound = 0.0;        ///< SI
  double frequency = 0.0;    ///< Hz, vibration only
};

/// What more room for some limits saves, in s of what the task minimises, against the design found.
struct Gain {
  Room room;
  bool solved = false;      ///< false: follows from a larger room that gains nothing
  double gain = 0.0;        ///< s, >= 0: of a design that was verified by simulation
  double at_most = 0.0;     ///< s: nothing gains more, by the proof that was rechecked; infinite without one
  double objective = 0.0;   ///< s, with that room
  int order = 0;            ///< of the design with that room; of the design found where nothing is gained
  std::vector<int> delays;  ///< a corner each

  bool proved() const { return at_most <= gain + 1e-9 * objective; }
};

/// The smallest change, of one limit or of several by the same share, with which an infeasible task has a design.
struct Remedy {
  Room room;
  enum class Help { yes, no, unknown } help = Help::unknown;  ///< no: proved that no change is enough
  double share = 0.0;                                         ///< of every lever's scale
  std::vector<double> values;  ///< SI, of every lever: with them the task has a design, verified by simulation
  bool smallest = false;       ///< proved that a change smaller by `remedy_tolerance` is not enough
  double objective = 0.0;      ///< s, of the design with these values
};

struct ExplainOptions {
  DesignOptions design;           ///< of every single solve, its time limit in processor time; no progress is told
  double time_limit = unlimited;  ///< s, of all solves together; then what is known
  double share = 0.1;             ///< more room to try, 0 < share < 1
  /// Told before every solve but the first: how many are done, and how many there will be as far as is known.
  std::function<void(int done, int total)> progress;
};

/// What stands in the way of a shorter design, or of any.
struct Explanation {
  DesignResult base;              ///< the task's own design
  bool base_proved = false;       ///< its bound was rechecked: `optimal` is so
  double share = 0.0;             ///< of the options
  std::vector<Binding> bindings;  ///< where limits are used to the full
  std::vector<Gain> gains;        ///< largest first; of a task with a design
  std::vector<Lever> not_moved;   ///< limits whose value is 0: there is no share of it
  std::vector<Remedy> remedies;   ///< of an infeasible task: smallest change first, then those that do not help
  int solves = 0;
  bool complete = true;  ///< false: cancelled, or the time was over
};

/// Explains a task by solving it again with more room for its limits.
///
/// With a design: every limit, and every kind of limit on all axes or corners together, is relaxed by `share` and the
/// task designed anew; designs are verified by simulation, bounds rechecked. Utilisation only chooses what is solved
/// first: limits that the design uses little are relaxed all together, and if that gains nothing, none of them does.
///
/// Without one: every limit, feeds, the highest order and given delays are given all the room there is, and where that
/// is enough, the smallest change is found by doubling and bisection.
/// @throws std::invalid_argument unless 0 < share < 1
Explanation explain_task(const Task& task, const ExplainOptions& options = {});

/// Where a verified design uses limits to the full, from its simulated motion; first by corner, then in the order of
/// limits and events.
std::vector<Binding> find_bindings(const DesignResult& design);

}  // namespace accdec
