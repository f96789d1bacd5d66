#pragma once

#include <cstdint>
#include <vector>

#include <accdec/files.hpp>
#include <accdec/filter.hpp>
#include <accdec/plan/command/slow_blocks.hpp>
#include <accdec/plan/delays/pairwise_delays.hpp>
#include <accdec/simulate.hpp>
#include <accdec/simulate/simulate.hpp>

namespace accdec {

/// Delays for a whole program and the simulation that verified them.
struct ProgramPlan {
  std::vector<int> delays;            ///< samples, one a block
  std::vector<double> errors;         ///< m, least on the simulated path, one per block
  Simulation simulation;              ///< of the whole program with these delays, every sample
  std::size_t slowed = 0;             ///< blocks whose feed had to be lowered
  std::vector<SlowedFeeds> too_fast;  ///< of these, blocks too fast for the contour, or to start or stop; one entry
                                      ///< per limit
  std::vector<int> alone;             ///< delays of joints alone, see pairwise_delays; empty: not known
  int rounds = 0;                     ///< of repair
  bool errors_hold = false;           ///< every joint within its tolerance
  bool delays_had = true;             ///< the control can give all delays, see command_delays
};

/// Whether every joint holds its tolerance, every axis limit is held, and the control can give the delays.
bool all_holds(const ProgramPlan& plan);

/// Delays with which every joint holds its tolerance on the simulated path. It starts from the pairwise delays. Joints
/// closer than the filter's length may still break their bound. Moves together may break an axis limit that each alone
/// holds. There delays of corners are raised and feeds on curves lowered, round by round, until all hold. Then each
/// raised delay is lowered again as far as its surroundings allow. With delays longer than the filter, every joint is
/// alone. A block that still breaks a limit, because its own start and stop overlap, is slowed; so this ends. Feeds at
/// which the filter cannot start or stop a block within the limits are lowered first, see limit_feeds. Curves whose
/// joints need delays or lower feeds are planned repeatedly. Their feeds are near those at which they would need
/// neither (curve_feeds), and each keeps the fastest plan. The whole plan is never slower than the first.
/// @param path     durations of blocks that have to be slowed grow
/// @param machine  as many axes as the path, or without axes
/// @param tune_curves  whether curves are planned again and again
/// @param deadline  ends repair and tuning: what is returned then may not hold
ProgramPlan plan_program(Toolpath& path, const Filter& filter, double sample_period, const Machine& machine,
                         bool tune_curves = true, const Deadline& deadline = {});

/// Slows rapid moves to speeds that the filter can start from rest and stop within the axis limits. Programmed feeds do
/// not change.
void limit_rapids(Toolpath& path, const Filter& filter, double sample_period, const Machine& machine);

/// Lowers by at most 1e-7 the durations of whole runs (see CommandTiming) that exceed whole samples by no more, without
/// regard to limits: the plan must be simulated again. More would move steps of the feed that just follow each other
/// into one window. @return whether any was lowered
bool snap_runs(Toolpath& path, double sample_period, const std::vector<int>& delays);

/// Lowers by at most 1e-6 the durations that exceed whole samples by no more. Otherwise coordinates rounded by the
/// program's author would cost every leg a sample. This is done only if it keeps the axis limits.
void snap_durations(Toolpath& path, const Filter& filter, double sample_period, const Machine& machine);

/// All that is done to the feeds of a program before its delays are known: limit_rapids, snap_durations, hold_contour.
void ready_feeds(Toolpath& path, const Filter& filter, double sample_period, const Machine& machine);

/// If the control has not all delays, gives the joints those that they get, and simulates the plan again.
void settle_delays(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine,
                   ProgramPlan& plan);

/// Simulates given delays and says whether they hold.
/// @param least  else errors within the tolerances need not be the least of their windows, which takes less time
ProgramPlan check_program(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine,
                          std::vector<int> delays, bool least = true);

}  // namespace accdec
