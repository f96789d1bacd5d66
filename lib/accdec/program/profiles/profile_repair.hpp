#pragma once

#include <cstdint>
#include <vector>

#include <accdec/program/profiles/chain_maker.hpp>
#include <accdec/program/profiles/sample_check.hpp>

namespace accdec {

/// Legs first .. last of a program.
struct LegRange {
  std::size_t first = 0, last = 0;
};

/// Lowers the shares of places where samples broke something, once each round of samples, and remembers which.
class ProfileRepair {
 public:
  /// References are kept. @param range  legs that are sampled; no share beside them changes  @param round  from 0
  ProfileRepair(const Toolpath& path, const AvailableAcceleration& available, ProfileShares& shares, LegRange range,
                int round);

  /// See SampleChecker::Broken.
  void limit(std::int64_t first, std::int64_t last, LimitKind kind, double ratio);
  /// Corners among those of legs first .. last whose error is too large; with a last filter their neighbours within it,
  /// too.
  void errors(const ProfileChain& chain, const std::vector<double>& errors, LegRange judged);
  /// Legs beside which something was lowered, ascending, those that touch as one.
  std::vector<LegRange> touched() const;

 private:
  double lowering(double ratio) const;
  void lower_speed(const ProfileChain& chain, std::size_t c, double factor);

  const Toolpath& path_;
  const AvailableAcceleration& available_;
  ProfileShares& shares_;
  const LegRange range_;
  const std::vector<float> old_acceleration_, old_speed_;  // of the range, before the round
  std::vector<LegRange> touched_;
  const int round_;
  double jerk_floor_ = unlimited;
};

/// Repairs the surroundings of every touched place by themselves, in rounds: their part of the chain is made again
/// between the speeds at its ends, sampled as the whole motion is and judged, and what still breaks something is
/// lowered and comes up in the next round. A part ends whole samples later than before, so that the samples after it
/// stay what they were.
/// @param phases  of every leg, see ProfileMotion; kept up to date
/// @param touched  see ProfileRepair  @param errors  of every block, written where judged
void repair_parts(const Toolpath& path, const Machine& machine, const AvailableAcceleration& available,
                  ProfileShares& shares, ChainMaker& maker, std::vector<double>& errors, std::vector<double>& phases,
                  std::vector<LegRange> touched, int round);

}  // namespace accdec
