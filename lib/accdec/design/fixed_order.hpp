#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <accdec/design.hpp>
#include <accdec/design/formulation.hpp>
#include <accdec/files.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/solver.hpp>

namespace accdec {

/// A solver does not accept a problem, for example because of too many variables. The text is for the user.
class SolverRefuses : public std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// A message if a step of a local solver on the problems of this order may take longer than the time limit allows; else
/// empty. It is estimated as about a microsecond for each number in the rows, and more with many corners, as measured
/// with ipopt.
std::string step_too_long(const Task& task, int order, double time_limit);

/// The two smooth problems, solved by one solver at one order after another. Rows on vibration bands and on the blend's
/// limits depend on the answer, so they are refined from solve to solve. Keeps the clock, the counts and the
/// frequencies found.
class FixedOrderDesigner {
 public:
  /// Problem (b): delays, instants and filter at one order.
  struct Relaxed {
    double cost = 0.0;                     ///< the task's objective, samples
    std::vector<double> delays, instants;  ///< per corner; instant -1 without an error bound
    std::optional<Filter> filter;
    /// The limits on the blend hold only with parted legs. Then `cost` counts `parting_delays`, and `delays` are those
    /// that the errors alone need.
    bool parted = false;
  };

  /// Keeps references: both arguments must outlive the object.
  FixedOrderDesigner(const Task& task, const DesignOptions& options);

  /// Problem (b); empty if it has no feasible point, or the solver finds none. Solved once per order.
  const std::optional<Relaxed>& relaxed(int order);
  /// Problem (a) at integer delays, the error of corner j first bounded at sample samples[j]: a filter, or nothing.
  std::optional<Filter> largest_margin(int order, const std::vector<int>& delays, const Filter& start,
                                       std::vector<int> samples);

  std::vector<double> guess_delays(const Filter& filter) const;
  /// Continuous delays rounded up to integers, at most those at which the legs part; given delays are kept.
  std::vector<int> rounded_up(const std::vector<double>& delays, int order) const;
  /// Delays from which on nothing changes, because the legs no longer overlap; given delays are kept.
  std::vector<int> parting_delays(int order) const;

  /// Mean delay of the response behind its first tap, samples.
  double lag() const;

  bool stopped() const {
    return elapsed() > options_.time_limit || (options_.cancel != nullptr && options_.cancel->load());
  }
  /// The stop reason if the search ends now.
  StopReason stop_reason() const {
    if (options_.cancel != nullptr && options_.cancel->load()) return StopReason::interrupted;
    return stopped() ? StopReason::time_limit : StopReason::finished;
  }
  double elapsed() const { return seconds_since(began_); }
  void tell(const std::string& line) const {
    if (options_.progress) options_.progress(line);
  }
  double filter_cost() const { return filter_cost_; }  ///< of each of the N + 1 taps, see LinearCost
  const std::string& last_message() const { return last_message_; }
  const nlp::Counts& counts() const { return counts_; }  ///< of all solves so far
  SolverReport report() const;

 private:
  using Clock = std::chrono::steady_clock;
  solvers::Result solve(const nlp::Problem& problem, const std::vector<double>& start);
  FormulationOptions formulation(int order, std::vector<int> blend_delays);
  /// Use of a mode of an axis by the fastest of its starts and stops, or by a blend with its delay.
  LimitUse worst_residual(const Filter& filter, const Mode& mode, const std::vector<int>& delays) const;
  /// Adds the frequencies at which a filter breaks its bands. False if it breaks none.
  /// @param delays  of the blends; empty: these are left out
  bool refine_bands(const Filter& filter, const std::vector<int>& delays = {});
  int nearest_sample(const Filter& filter, std::size_t corner, int delay) const;
  /// The filter of the motion, as if all axes had the slowest servo.
  Filter motion(const Filter& filter) const { return response_.motion(filter); }
  std::vector<double> contour_times(const Filter& filter, const std::vector<int>& delays) const;
  std::optional<Relaxed> relax(int order);
  /// @throws BuildStopped
  void relax(int order, std::optional<Relaxed>& best);
  void enlarge_margin(int order, const std::vector<int>& delays, Filter from, std::vector<int> samples,
                      std::optional<Filter>& found);

  const Task& task_;
  const DesignOptions& options_;
  const solvers::Solver& solver_;
  Clock::time_point began_ = Clock::now();
  bool reduced_ = false, coupled_ = false;
  Response response_;  // of the slowest servo, without negative taps
  double filter_cost_ = 0.0;
  std::map<int, std::optional<Relaxed>> relaxed_;
  std::vector<std::vector<double>> extra_frequencies_;  // per mode
  nlp::Counts counts_;
  double wall_time_ = 0.0;
  std::string claimed_, last_message_;
};

}  // namespace accdec
