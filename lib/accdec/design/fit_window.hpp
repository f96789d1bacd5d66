#pragma once

#include <vector>

#include <Eigen/Core>

#include <accdec/design/logged_command.hpp>
#include <accdec/filter.hpp>

// Internal to the room: how well a filter explains a log.

namespace accdec {

/// Which steps at the ends of a leg may move less than its others.
enum class Ends {
  whole,    ///< none
  between,  ///< samples of the log lie between those of the command: every leg begins with a part and ends with the
            ///< rest
  last,     ///< the last of each leg
  both      ///< the first and the last of each leg
};
/// Numbers of a fit more than with whole steps.
constexpr int numbers_of(Ends ends, int legs) {
  return ends == Ends::whole ? 0 : ends == Ends::between ? 1 : ends == Ends::last ? legs : 2 * legs;
}

/// A command to be fitted.
struct Reading {
  Ends ends = Ends::whole;
  int samples = 0;  ///< of every leg; 0: as the parts at constant speed say
};

/// One fit of a command behind a filter to a log.
struct CommandFit {
  double squares = 0.0;           ///< m^2, sum of squared differences, each times its axis' weight
  std::vector<int> first, count;  ///< of each leg, samples
  Ends ends = Ends::whole;
  Eigen::MatrixXd parts;         ///< of a full step, 0 .. 1, by what the ends add, and leg
  Eigen::MatrixXd coefficients;  ///< start, then ways of the legs' full steps, by rows, m; axes by columns
};

class ComparedSamples;

/// The samples of a log that a filter decides: around starts and stops. Keeps references.
class FitWindow {
 public:
  /// @param order_max  of the filters to be fitted
  /// @param smoothing  taps of the control's own, behind every filter; empty: none
  FitWindow(const MotionLog& log, const LoggedCommand& command, int order_max, const std::vector<double>& smoothing);

  /// The best fit over commands near those that the constant speeds say.
  /// @param around  how many samples each number may be off
  CommandFit fit(const Filter& filter, int around, const Reading& reading = {}) const;
  /// Position of every sample, by axis, m.
  std::vector<std::vector<double>> model(const Filter& filter, const CommandFit& fit) const;
  /// Any taps >= 0 of this order with start and ways, by least squares.
  /// @param fit  a command, of whose ways the taps are found first, then ways with the taps, and so on
  Filter free_taps(CommandFit& fit, int order) const;
  /// m, root of the mean square of a fit's differences in the samples in which the filter acts: between rest and
  /// full speed. The numbers of the command are fitted to all samples alike.
  /// @param parameters  numbers of the filter that were fitted
  double figure(const Filter& filter, const CommandFit& fit, int parameters) const;
  /// Values that are compared.
  long values() const { return static_cast<long>(rows_.size()) * command_.axes(); }

 private:
  CommandFit fit_at(ComparedSamples& samples, const std::vector<int>& first, const std::vector<int>& count, Ends ends,
                    double slack) const;
  /// Parts of a full step that the ends of a fit move, of its normal equations. @param alike  all legs have one
  /// @param slack  by which they may be less than 0 or more than 1
  Eigen::MatrixXd parts_of(const Eigen::MatrixXd& normal, const Eigen::MatrixXd& right, Eigen::Index legs,
                           Eigen::Index kinds, bool alike, double slack) const;
  /// The same command, with the ways that fit this filter best.
  CommandFit refit(const Filter& filter, const CommandFit& fit) const;
  /// With the ways of a fit, and any start.
  Filter taps_for(const CommandFit& fit, int order) const;
  const MotionLog& log_;
  const LoggedCommand& command_;
  Filter smoothing_;
  std::vector<int> rows_;  // samples that are compared
  Eigen::MatrixXd at_;     // m, of these; axes by columns
};

}  // namespace accdec
