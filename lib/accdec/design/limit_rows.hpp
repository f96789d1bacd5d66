#pragma once

#include <functional>
#include <string>
#include <vector>

#include <accdec/design/cumulative_variables.hpp>
#include <accdec/task.hpp>

namespace accdec {

/// The options of a formulation at one order, besides the task.
struct FormulationOptions {
  int order = 0;                  ///< N >= 0
  std::vector<int> blend_delays;  ///< per corner: the integer delay at which limits on the blend are imposed, >= 0
  /// Per mode: the frequencies (Hz) at which its bound is imposed. A band needs a grid, which the caller refines.
  std::vector<std::vector<double>> mode_frequencies;
  /// Per corner: when the path leaves leg 1's strip for leg 2's, in samples, not always whole. For that time a contour
  /// bound is linear. Empty: contour bounds are left out.
  std::vector<double> contour_times;
  /// Whether blends bound what they leave of modes of axes. That is for given delays only: each has its own phase.
  bool mode_blends = false;
  double margin = 1e-7;  ///< relative distance kept from every limit, so that a solver's tolerance does not break it
  bool reduced =
      false;  ///< no equality rows: positions and responses are substituted into their bounds (dense rows, no Hessian)
  std::function<bool()> stop = nullptr;  ///< when to give the problem up with BuildStopped
};

/// Adds every limit of the task except the corner errors. Taps are >= 0 and below the acceleration bound. Start, blend
/// and stop have rows for jerk, force, power and regeneration. There are also rows for the smallest tangential speed,
/// residual vibration and symmetry. Rows are scaled to a bound of 1 and named like "force x, stop, k = 7". Rows that
/// others imply for every filter are left out. Behind a servo, most samples of its tail have none. There are O(N) rows
/// of O(1) entries, and two dense linear rows per vibration frequency (or, when reduced, one dense quadratic row).
/// Limits at constant speed are not rows: see `contradictions`.
void add_limit_rows(QuadraticProblem& problem, const CumulativeVariables& b, const Task& task,
                    const FormulationOptions& options);

/// The part of these rows that depends on delays: blend and smallest speed of one corner.
void add_blend_rows(QuadraticProblem& problem, const CumulativeVariables& b, const Task& task,
                    const FormulationOptions& options, std::size_t corner);
/// The other part.
void add_common_rows(QuadraticProblem& problem, const CumulativeVariables& b, const Task& task,
                     const FormulationOptions& options);

/// Why these rows are narrower than the task, in words; empty if they are not. The sample at which an axis reverses is
/// not known, so its dry friction counts against the limits both ways.
std::string friction_both_ways(const Task& task);

/// When the path is as far from leg 1 as from leg 2, see FormulationOptions::contour_times.
/// @param motion  the filter of the motion
double contour_time(const Filter& motion, const Corner& corner, int delay);

/// The fastest leg of an axis in any start or stop, m/s.
double fastest_leg(const Task& task, int axis);

/// A first grid for the bound of each mode's band: the ends, and points half of the response's shortest ripple apart.
std::vector<std::vector<double>> initial_frequencies(const Task& task, int order);

}  // namespace accdec
