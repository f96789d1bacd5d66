#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <accdec/machine.hpp>
#include <accdec/program.hpp>
#include <accdec/simulate.hpp>
#include <accdec/simulate/profile_motion.hpp>
#include <accdec/simulate/sample_batch.hpp>

namespace accdec {

/// Whether an error found by simulation is within its bound; see verification_tolerance and position_floor.
bool holds(double error, double bound);

/// Follows a motion only by its positions, without any formula of a planner.
///
/// Velocity, acceleration and jerk of an axis are the first three differences of its samples over T, T^2, T^3. Force,
/// power and regeneration follow from the first two, as for every other plan. The possible rounding of such a position
/// to a double is subtracted first. The error of a joint is the distance of the polyline through the samples from the
/// joint, while the motion is on the legs beside it. Samples are looked at in batches.
class SampleChecker {
 public:
  /// A limit used `ratio` > 1 times by samples that lie between two places (see ProfileMotion).
  using Broken = std::function<void(std::int64_t place_first, std::int64_t place_last, LimitKind kind, double ratio)>;

  /// @param machine  as many axes as the path, or none  @param errors  of every block, see ProgramPlan; written
  SampleChecker(const Toolpath& path, const Machine& machine, double sample_period, std::span<double> errors,
                Broken broken);
  /// Only for legs first .. last. The first `unseen` samples, which fill filters and differences, have no limits.
  SampleChecker(const Toolpath& path, const Machine& machine, double sample_period, std::span<double> errors,
                Broken broken, std::size_t first, std::size_t last, int unseen);
  SampleChecker(const SampleChecker&) = delete;
  SampleChecker& operator=(const SampleChecker&) = delete;

  /// The next sample after the start, m. The places say which joints it may be measured against.
  void look(const double* position, std::int64_t place_first, std::int64_t place_last);
  /// So many more samples, at which it rests or goes straight on as before. @param position  of the last of them, m
  void pass(std::int64_t count, const double* position);
  /// The next samples of a motion at once: up to the end of a piece, and those passed over behind it.
  /// @returns how many were looked at; 0: it is at rest at its end
  std::int64_t look_on(ProfileMotion& motion);
  SampleCheck finish();
  /// For a part: computes the errors of its joints. @param at_rest  it ends where the program does
  void finish_part(bool at_rest);

 private:
  struct Worst {
    LimitKind kind{};
    std::size_t axis = 0;
    double bound = 0.0, value = 0.0;
    std::int64_t sample = 0, place = 0;
    double dv = 0.0, da = 0.0, dj = 0.0;  ///< possible rounding of velocity, acceleration, jerk
  };
  void look_at_batch();
  void look_limits();
  void look_limit(Worst& worst, std::int64_t begin);
  template <class Value>
  void look_values(Worst& worst, std::int64_t begin, const Value& value_of);
  void look_joints();
  std::int64_t first_joint(std::int64_t i) const;
  std::int64_t last_joint(std::int64_t i) const;
  void settle();
  void take_roots();

  const Toolpath& path_;
  const Machine& machine_;
  const double rate_;  // of samples, 1/s
  const std::size_t n_;
  std::span<double> errors_;
  Broken broken_;
  std::vector<Worst> worst_;
  SampleBatch batch_;
  std::int64_t sample_ = 0;
  std::int64_t unseen_ = 0;
  std::size_t first_ = 0, last_ = 0;  // legs
};

/// Distance of a point from the segment a to b, all of n values, squared.
inline double segment_distance2(const double* a, const double* b, const double* point, std::size_t n) {
  double along = 0.0, length2 = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double d = b[i] - a[i];
    along += (point[i] - a[i]) * d;
    length2 += d * d;
  }
  double distance2 = 0.0;
  if (!(along > 0.0) || along >= length2) {  // nearest to an end: most are
    const double* const end = along > 0.0 ? b : a;
    for (std::size_t i = 0; i < n; ++i) distance2 += (end[i] - point[i]) * (end[i] - point[i]);
    return distance2;
  }
  const double t = along / length2;
  for (std::size_t i = 0; i < n; ++i) {
    const double d = a[i] + t * (b[i] - a[i]) - point[i];
    distance2 += d * d;
  }
  return distance2;
}

}  // namespace accdec
