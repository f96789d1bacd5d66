#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <accdec/motion/filter.hpp>
#include <accdec/program/profiles/chain.hpp>
#include <accdec/program/read/toolpath.hpp>

namespace accdec {

/// The motion of a chain along a toolpath, sample by sample, as a controller would ask for it: O(1) memory beside both.
///
/// In continuous time every leg is steady motion and constant accelerations, every corner a constant acceleration; it
/// is sampled at T. Only where it comes to rest it waits for the next sample. Sampling keeps limits: the second
/// difference of the samples over T^2 is a weighted mean of the acceleration, the third over T^3 one of the jerk. At
/// last the samples pass a filter; at rest they wait until it is empty.
class ProfileMotion {
 public:
  /// References are kept.
  ProfileMotion(const Toolpath& path, const ProfileChain& chain, double sample_period, const Filter& last);
  /// Of legs first_leg .. last_leg only, as if it had stood still before and ended before the corner at their end.
  /// @param first_sample  s after the start, in (0, T]: a part of a longer motion is sampled at any times
  ProfileMotion(const Toolpath& path, const ProfileChain& chain, double sample_period, const Filter& last,
                std::size_t first_leg, std::size_t last_leg, double first_sample);

  /// Moves on by one sample; false if the motion is at rest at its end. The first call gives the first sample after the
  /// start.
  bool next();
  /// From now on writes, for every leg that it comes to and the one it is on, when after the beginning of the leg the
  /// first sample lies: s, one value a leg, kept by reference.
  void note_phases(std::vector<double>& phases);
  /// m, one value a dimension.
  const double* position() const { return out_.data(); }
  /// What the sample lies on: 2 b for leg b, 2 b + 1 for the corner after it; of the samples inside the filter the
  /// first and the last.
  std::int64_t place_first() const { return taps_ == 1 ? place_ : places_[slot_]; }
  std::int64_t place_last() const { return place_; }

 private:
  struct Piece {
    double duration = 0.0;
    std::array<double, program_axis_count> x{}, v{}, a{};
  };

  void leg_pieces(std::size_t b);
  void ramp_pieces(std::size_t b, double from, double to, double& way, const double* u);
  void corner_piece(std::size_t c);
  void arrive(std::size_t c);
  void begin_leg(std::size_t b);
  void direction(std::size_t b, double* u) const;
  void leg_piece(std::size_t b, double& way, double speed, double acceleration, double duration, const double* u);
  bool ends_at_stop() const;
  bool raw();
  void smooth();
  void convolve(std::size_t newest);

  const Toolpath& path_;
  const ProfileChain& chain_;
  const double period_;
  const Filter& last_;
  const int taps_;
  bool equal_ = true;  // taps
  const std::size_t n_;
  std::vector<Piece> pieces_;  // of the leg or corner being driven
  std::size_t piece_ = 0;
  std::size_t leg_ = 0;  // being driven, or before the corner being driven
  std::size_t last_leg_ = 0;
  bool in_corner_ = false;
  bool done_ = false;
  double time_ = 0.0;      // since the beginning of the piece, of the next sample
  std::int64_t rest_ = 0;  // samples still to rest
  std::int64_t place_ = 0;
  std::size_t dwell_ = 0;  // next entry of the path's dwells
  std::vector<double>* phases_ = nullptr;
  std::array<double, program_axis_count> raw_{}, out_{};
  // the last filter
  std::vector<double> ring_;  // taps rows
  std::vector<std::int64_t> places_;
  std::size_t slot_ = 0;
  std::array<long double, program_axis_count> sum_{};
};

/// Continuous time of the chain between its stops, without what rounding to samples and dwells add, s.
double chain_time(const ProfileChain& chain);
/// Of legs first .. end - 1, the corners at their ends included but the one before the first.
double chain_time(const ProfileChain& chain, std::size_t first, std::size_t end);

}  // namespace accdec
