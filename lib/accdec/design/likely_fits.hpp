#pragma once

#include <vector>

#include <accdec/design/fitted_families.hpp>
#include <accdec/design/identify.hpp>
#include <accdec/design/logged_command.hpp>

// Internal to the room: which of the members that were fitted to a log are listed, and how likely each is.

namespace accdec {

inline constexpr double fastest_move = 20.0;  // m/s; no axis of a machine tool comes near it

/// The command of a fit, leg by leg.
std::vector<LoggedMove> moves_of(const CommandFit& fit);

/// The members that are listed, and the command of the first.
struct LikelyFits {
  std::vector<FittedFilter> fits;
  CommandFit first;
};

/// A log with the members that were fitted to it. Keeps references.
class FitList {
 public:
  FitList(const MotionLog& log, const Task& task, const IdentifyOptions& options, const LoggedCommand& command,
          const FitWindow& window)
      : log_(log), task_(task), options_(options), command_(command), window_(window) {}

  /// Those within `options.sigmas` of the best, the one with the fewest numbers that explains the log first. Members
  /// with the same taps are one fit with several names.
  /// @param noise  m
  /// @throws std::invalid_argument if none has the given feed
  LikelyFits likely(std::vector<FamilyFit> members, double noise) const;

 private:
  /// Orders the members: more numbers must explain more, by the Bayesian criterion.
  double cost(const FamilyFit& member, double noise) const;
  /// Whether the control may have moved so fast.
  bool possible(const std::vector<LoggedMove>& moves) const;

  const MotionLog& log_;
  const Task& task_;
  const IdentifyOptions& options_;
  const LoggedCommand& command_;
  const FitWindow& window_;
};

}  // namespace accdec
