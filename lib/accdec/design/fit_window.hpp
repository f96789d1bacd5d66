#pragma once

#include <vector>

#include <Eigen/Core>

#include <accdec/design/logged_command.hpp>
#include <accdec/filter.hpp>

// Internal to the room: how well a filter explains a log.

namespace accdec {

/// One fit of a command behind a filter to a log.
struct CommandFit {
  double squares = 0.0;           ///< m^2, sum of squared differences, each times its axis' weight
  std::vector<int> first, count;  ///< of each leg, samples
  /// Start, then ways of the legs' full steps, then those of their last steps if these may be shorter, by rows, m; axes
  /// by columns.
  Eigen::MatrixXd coefficients;
};

/// The samples of a log that a filter decides: around starts and stops. Keeps references.
class FitWindow {
 public:
  /// @param order_max  of the filters to be fitted
  /// @param smoothing  taps of the control's own, behind every filter; empty: none
  FitWindow(const MotionLog& log, const LoggedCommand& command, int order_max, const std::vector<double>& smoothing);

  /// Whether a leg may end with a step of its own: what is left where its way is no whole number of steps.
  void allow_last_steps(bool allow) { last_steps_ = allow; }
  /// The best fit over commands near those that the constant speeds say: legs begin on a sample and last whole samples.
  /// @param around  how many samples each number may be off
  CommandFit fit(const Filter& filter, int around) const;
  /// Position of every sample, by axis, m.
  std::vector<std::vector<double>> model(const Filter& filter, const CommandFit& fit) const;
  /// Any taps >= 0 of this order, by least squares; the command as of a fit.
  Filter free_taps(const CommandFit& fit, int order) const;
  /// The same command, with the ways that fit this filter best.
  CommandFit refit(const Filter& filter, const CommandFit& fit) const;
  /// Values that are compared.
  long values() const { return static_cast<long>(rows_.size()) * command_.axes(); }

 private:
  CommandFit fit_at(const std::vector<double>& reached, const std::vector<int>& first,
                    const std::vector<int>& count) const;
  const MotionLog& log_;
  const LoggedCommand& command_;
  Filter smoothing_;
  bool last_steps_ = false;
  std::vector<int> rows_;  // samples that are compared
  Eigen::MatrixXd at_;     // m, of these; axes by columns
};

}  // namespace accdec
