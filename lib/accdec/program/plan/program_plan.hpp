#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <accdec/program/read/toolpath.hpp>
#include <accdec/program/simulate/leg_filters.hpp>
#include <accdec/program/simulate/simulate.hpp>

namespace accdec {

/// Which delays are asked for.
enum class DelayRule {
  smallest,    ///< what the tolerances ask for
  exact_stop,  ///< an exact stop at every joint but those inside arcs
  none         ///< none but where the program stops
};

struct PairwiseDelays {
  std::vector<int> delays;              ///< samples, one a block; 0 for the last
  bool limits_possible = true;          ///< false if some joint breaks an axis limit even where its legs do not overlap
  std::vector<std::size_t> impossible;  ///< these joints, ascending
};

/// Smallest delay of every joint as if it were alone: of a corner the smallest with corner error (at samples) within
/// its tolerance, of a smooth joint the smallest with which the path passes within it, of a stop the filter's exact
/// stop; each then lengthened until the axis limits hold while the legs overlap. O(1) to O(log N) a joint, O(N^2) where
/// limits bind.
/// @param machine  as many axes as the path, or without axes
PairwiseDelays pairwise_delays(const Toolpath& path, const LegFilters& filters, double sample_period,
                               const Machine& machine = {}, DelayRule rule = DelayRule::smallest);

/// How many joints have a longer delay than they would need alone, as moves overlap or the program asked for it.
/// @param delays  samples, one a block
std::size_t raised_delays(const Toolpath& path, const LegFilters& filters, double sample_period, const Machine& machine,
                          const std::vector<int>& delays);

/// Smallest d >= 0 with which the path through the samples passes a lone joint within `error_max`: the polyline error
/// never grows with d.
/// @param cos_interior       cos(theta), see Corner
/// @param step_in, step_out  full-speed steps v T of both legs, m
int smallest_path_delay(const Filter& filter, double cos_interior, double step_in, double step_out, double error_max,
                        int stop_delay);

/// Whether an error found by simulation is within its bound; see verification_tolerance and position_floor.
bool holds(double error, double bound);

/// Blocks slowed because at their programmed feed the filter breaks one axis limit at a start or stop, however long the
/// delay.
struct SlowedFeeds {
  std::string limit;       ///< "jerk x"
  std::size_t blocks = 0;  ///< how many
  double factor = 1.0;     ///< what is left of the feed of the block slowed most
  std::uint32_t line = 0;  ///< of that block
};

/// Delays for a whole program and the simulation that verified them.
struct ProgramPlan {
  std::vector<int> delays;            ///< samples, one a block
  std::vector<double> errors;         ///< m, on the simulated path, one a block
  Simulation simulation;              ///< of the whole program with these delays, every sample
  std::size_t slowed = 0;             ///< blocks whose feed had to be lowered
  std::vector<SlowedFeeds> too_fast;  ///< of these, those that start or stop too fast for the filter; one entry a limit
  int rounds = 0;                     ///< of repair
  bool errors_hold = false;           ///< every joint within its tolerance
};

/// Whether every joint holds its tolerance and every axis limit is held.
bool all_holds(const ProgramPlan& plan);

/// Delays with which every joint holds its tolerance on the simulated path. Starts from the pairwise delays; where
/// joints closer than the filter is long break their bound nevertheless, or moves together break an axis limit that
/// each alone holds, delays of corners are raised and feeds on curves lowered there, round by round, until all hold;
/// then each delay raised is lowered again as far as its surroundings allow. With delays longer than the filter every
/// joint is alone; a block that even then breaks a limit, because its own start and stop overlap, is slowed, so this
/// ends. Feeds at which the filter cannot start or stop a block within the limits are lowered first, see limit_feeds.
/// Curves whose joints need delays or lower feeds are planned again and again from feeds around those at which they
/// would need neither (curve_feeds), and each keeps what is fastest; the whole plan is never slower than the first.
/// @param path     durations of blocks that have to be slowed grow
/// @param machine  as many axes as the path, or without axes
/// @param tune_curves  whether curves are planned again and again
ProgramPlan plan_program(Toolpath& path, const LegFilters& filters, double sample_period, const Machine& machine,
                         bool tune_curves = true);

/// Slows rapid moves to speeds that the filter starts from rest and stops within the axis limits; programmed feeds are
/// left alone.
void limit_rapids(Toolpath& path, const Filter& filter, double sample_period, const Machine& machine);

/// Lowers the feeds at both ends of the program, and at those joints that hold no axis limit with any delay, to what
/// the filter starts from rest and stops within the limits: of every block within a filter's length of the stop. Feeds
/// inside legs and at joints passed at speed stay.
/// @param delays  of the path; found again when feeds change
/// @param ramps   where feeds change inside a leg, lower them to what passes that joint instead; true of each joint
/// alone
/// @return one entry a limit. In slow_blocks.cpp.
std::vector<SlowedFeeds> limit_feeds(Toolpath& path, const LegFilters& filters, double sample_period,
                                     const Machine& machine, PairwiseDelays& delays, bool ramps);

/// Lowers by at most 1e-7 the durations of whole legs that exceed whole samples by no more, whatever the limits: the
/// plan has to be simulated. More would move steps of the feed that just follow each other into each other's window.
void snap_legs(Toolpath& path, double sample_period);

/// Lowers by at most 1e-6 the durations that exceed whole samples by no more: coordinates rounded by whoever wrote the
/// program would else cost every leg a sample. Only where that keeps the axis limits.
void snap_durations(Toolpath& path, const Filter& filter, double sample_period, const Machine& machine);

/// Simulates given delays and says whether they hold.
ProgramPlan check_program(const Toolpath& path, const LegFilters& filters, double sample_period, const Machine& machine,
                          std::vector<int> delays);

}  // namespace accdec
