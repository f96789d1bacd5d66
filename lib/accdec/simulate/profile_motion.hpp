#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <accdec/filter.hpp>
#include <accdec/simulate.hpp>
#include <accdec/simulate/profile_pieces.hpp>
#include <accdec/simulate/sample_smoother.hpp>

namespace accdec {

/// The motion of a chain along a toolpath, sample by sample, as a controller would request it: O(1) additional memory.
///
/// In continuous time, every leg consists of steady motion and constant accelerations, and every corner is a constant
/// acceleration. The motion is sampled at T. Only where it stops it waits for the next sample. Sampling keeps limits.
/// The second difference of the samples over T^2 is a weighted mean of the acceleration, and the third over T^3 is one
/// of the jerk. At the end the samples pass a filter; at rest they wait until it is empty.
///
/// `Motion` gives whole plans and names blocks. Planners and checks use this class, because they also need parts of a
/// chain, phases, places in corners, and the number of samples passed over.
class ProfileMotion {
 public:
  /// References are kept.
  ProfileMotion(const Toolpath& path, const ProfileChain& chain, double sample_period, const Filter& last);
  /// The motion of legs first_leg .. last_leg only, as if it rested before and ended before the corner at their end.
  /// @param first_sample  s after the start, in (0, T]: a part of a longer motion is sampled at any times
  ProfileMotion(const Toolpath& path, const ProfileChain& chain, double sample_period, const Filter& last,
                std::size_t first_leg, std::size_t last_leg, double first_sample);

  /// Advances by one sample; false if the motion is at rest at its end. The first call gives the first sample after the
  /// start.
  bool next();
  /// After next(): the samples that next() would give behind it, up to `most`, as far as they lie on the same piece and
  /// pass_steady() would pass over none.
  /// @param rows  of every axis, to be written, m  @param places_first  of every sample, to be written
  /// @returns their number
  std::int64_t next_run(const std::array<double*, program_axis_count>& rows, std::int64_t* places_first,
                        std::int64_t most);
  /// From now on records, for the present leg and every later one, the time from the beginning of the leg to its first
  /// sample. In s, one value per leg, kept by reference.
  void note_phases(std::vector<double>& phases);
  /// After next(): passes over samples at rest, or of steady motion, but for the last ones, and says how many. It must
  /// have rested or been steady for longer than its last filter and three differences see.
  std::int64_t pass_steady();
  /// m, one value a dimension.
  const double* position() const { return out_.data(); }
  /// The place of the sample: 2 b for leg b, 2 b + 1 for the corner after it. For the samples inside the filter, the
  /// first and the last place.
  std::int64_t place_first() const { return smoother_.oldest_place(place_); }
  std::int64_t place_last() const { return place_; }

 private:
  using Point = SampleSmoother::Point;

  Point start(std::size_t first_leg);
  void arrive(std::size_t c);
  void begin_leg(std::size_t b);
  double piece_end() const;
  std::int64_t seen() const { return smoother_.taps() + 4; }  // samples that the filter and three differences see
  bool raw();

  const Toolpath& path_;
  const ProfileChain& chain_;
  const double period_;
  ProfilePieces pieces_;  // of the leg or corner being driven
  std::size_t leg_ = 0;   // being driven, or before the corner being driven
  std::size_t last_leg_ = 0;
  bool in_corner_ = false;
  bool done_ = false;
  double time_ = 0.0;       // since the beginning of the piece, of the next sample
  std::int64_t rest_ = 0;   // samples still to rest
  std::int64_t stood_ = 0;  // samples at rest so far
  std::int64_t ran_ = 0;    // samples of the piece so far, if it is steady
  std::int64_t place_ = 0;
  std::size_t dwell_ = 0;  // next entry of the path's dwells
  std::vector<double>* phases_ = nullptr;
  Point raw_, out_;
  SampleSmoother smoother_;
};

/// Continuous time of the chain between its stops, without rounding to samples and without dwells, s.
double chain_time(const ProfileChain& chain);
/// The time of legs first .. end - 1 with the corners at their ends, without the corner before the first.
double chain_time(const ProfileChain& chain, std::size_t first, std::size_t end);

}  // namespace accdec
