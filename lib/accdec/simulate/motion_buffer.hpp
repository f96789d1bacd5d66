#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include <accdec/filter.hpp>
#include <accdec/simulate/simulate.hpp>

namespace accdec {

/// The filtered motion of a window of samples. All values are in m and samples: velocity in m per sample, acceleration
/// in m per sample squared.
class MotionBuffer {
 public:
  /// At rest in `start`, which is sample 0. Refers to the filters. @param filters  one for all axes, or one an axis
  MotionBuffer(std::span<const Filter> filters, std::size_t dimensions, const double* start);

  /// Number of the last sample made.
  std::int64_t sample() const { return base_ + pos_ - 1; }
  std::int64_t room() const { return capacity_ - pos_; }
  /// Index of the next sample; samples seen_begin() .. index() - 1 are new since seen().
  std::int64_t index() const { return pos_; }
  std::int64_t seen_begin() const { return seen_; }
  std::int64_t number(std::int64_t index) const { return base_ + index; }
  void seen() { seen_ = pos_; }

  /// Adds `count` <= room() samples, in the first of which the command moves by u0, in the others by u. They can be
  /// read after make().
  /// @tparam axes  their number; 0: only known at run time
  template <std::size_t axes>
  void append(const AxisRow<axes>& u0, const AxisRow<axes>& u, std::int64_t count) {
    for (std::size_t a = 0; a < (axes > 0 ? axes : axes_.size()); ++a) {
      double* command = axes_[a].command.data() + pos_;
      // Most moves of dense programs take a few samples; values written in excess are overwritten.
      command[0] = u0[a];
      for (int k = 1; k < overrun; ++k) command[k] = u[a];
      for (std::int64_t k = overrun; k < count; ++k) command[k] = u[a];
    }
    pos_ += count;
  }
  /// Makes the motion of the samples added. It is fastest for thousands of samples at a time. Then close changes of the
  /// command are filtered as a whole, and the sums of all axes run in parallel.
  void make();
  /// After sample settled() the motion does not change further; known for the part made so far.
  std::int64_t settled() const { return settled_; }
  /// Skips `count` samples of steady motion by u, after which `left` remain to `end`. The content of the buffer is
  /// lost.
  void pass_over(std::int64_t count, const double* u, const double* end, std::int64_t left);
  /// Makes room; the last 2 N + 8 samples stay. @param at  position that the command has reached, one value per axis
  void shift(const double* at);
  /// Passes the new samples on.
  void deliver(const SampleSink& sink) const;

  /// Position of an axis by sample number. As many more values as least_squared may read are readable.
  const double* positions(std::size_t axis) const { return axes_[axis].position.data() - base_; }
  /// Values of the new samples, with `before` more in front.
  Eigen::Map<const Eigen::ArrayXd> velocity(std::size_t axis) const { return view(axes_[axis].velocity, 0); }
  Eigen::Map<const Eigen::ArrayXd> acceleration(std::size_t axis) const { return view(axes_[axis].acceleration, 0); }
  Eigen::Map<const Eigen::ArrayXd> acceleration_before(std::size_t axis) const {
    return view(axes_[axis].acceleration, 1);
  }

 private:
  static constexpr int overrun = 4;
  struct AxisMotion {
    const Filter* filter = nullptr;
    std::vector<double> taps;          // with zeros after them, as many for every axis
    std::vector<double> command;       // u of every sample
    std::vector<double> acceleration;  // with N + 1 samples of the future
    std::vector<double> velocity, position;
  };
  /// Filters the changes of the command at samples from .. to - 1.
  void apply(AxisMotion& axis, std::int64_t from, std::int64_t to);
  void step(AxisMotion& axis, std::int64_t index, double by);
  template <std::size_t count>
  void integrate(std::size_t axis);

  Eigen::Map<const Eigen::ArrayXd> view(const std::vector<double>& values, std::int64_t earlier) const {
    return {values.data() + seen_ - earlier, pos_ - seen_};
  }

  std::int64_t order_, keep_, capacity_;  // the largest order
  std::int64_t settled_ = 0;
  std::int64_t base_ = 0, pos_ = 1, seen_ = 1;
  std::vector<AxisMotion> axes_;
  std::vector<double> changes_;      // of the command, between zeros
  std::vector<std::uint8_t> count_;  // of changes in every window
};

}  // namespace accdec
