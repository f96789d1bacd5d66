#pragma once

#include <cstdint>
#include <vector>

#include <accdec/files.hpp>
#include <accdec/plan/trajectory/chain_maker.hpp>
#include <accdec/simulate/sample_check.hpp>

namespace accdec {

/// Legs first .. last of a program.
struct LegRange {
  std::size_t first = 0, last = 0;
};

/// Lowers the shares of places where samples broke a limit or tolerance, once per round of samples, and remembers the
/// places.
class ProfileRepair {
 public:
  /// References are kept. @param range  legs that are sampled; no share outside changes
  ProfileRepair(const Toolpath& path, const AvailableAcceleration& available, ProfileShares& shares, LegRange range,
                int round);

  /// See SampleChecker::Broken.
  void limit(std::int64_t first, std::int64_t last, LimitKind kind, double ratio);
  /// Corners of legs first .. last whose error is too large. With a last filter, also their neighbours within its
  /// length.
  void errors(const ProfileChain& chain, const std::vector<double>& errors, LegRange judged);
  /// Legs near a lowered place, sorted, with touching ones merged.
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

/// Repairs the surroundings of every touched place separately, in rounds. Their part of the chain is made again between
/// the speeds at its ends. It is sampled and judged like the whole motion. Places that still break a limit are lowered
/// and come up in the next round. A part ends whole samples later than before, so that the samples after it do not
/// change.
/// @param phases  of every leg, see ProfileMotion; updated
/// @param touched  see ProfileRepair  @param errors  of every block, written where judged
void repair_parts(const Toolpath& path, const Machine& machine, const AvailableAcceleration& available,
                  ProfileShares& shares, ChainMaker& maker, std::vector<double>& errors, std::vector<double>& phases,
                  std::vector<LegRange> touched, int round, const Deadline& deadline = {});

}  // namespace accdec
