#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include <accdec/program/leg_filters.hpp>
#include <accdec/program/simulate.hpp>

namespace accdec {

/// The filtered motion of a window of samples. All in m and samples: velocity in m a sample, acceleration in m a sample squared.
class MotionBuffer {
 public:
  /// At rest in `start`, which is sample 0. Keeps a reference to the filters.
  MotionBuffer(const LegFilters& filters, std::size_t dimensions, const double* start);

  /// Number of the last sample made.
  std::int64_t sample() const { return base_ + pos_ - 1; }
  std::int64_t room() const { return capacity_ - pos_; }
  /// Index of the next sample; samples seen_begin() .. index() - 1 are new since seen().
  std::int64_t index() const { return pos_; }
  std::int64_t seen_begin() const { return seen_; }
  std::int64_t number(std::int64_t index) const { return base_ + index; }
  void seen() { seen_ = pos_; }

  /// From the next sample on the command moves by u a sample, through filter f: what moved before stops through its own filter.
  /// The motion is settled where it is not changed further after sample settled().
  void change(const double* u, std::size_t f);
  std::int64_t settled() const { return settled_; }
  /// Adds `count` <= room() samples; the command reaches `end` after `left` samples. They can be read after make().
  void advance(std::int64_t count, std::int64_t left, const double* end);
  /// Makes the motion of the samples added. Done in one go for thousands of samples, for steps of the command that follow each other
  /// closely are then filtered four at a time, and the sums of all axes run side by side.
  void make();
  /// Passes over `count` samples of steady motion, after which `left` remain to `end`. What is in the buffer is lost.
  void pass_over(std::int64_t count, const double* u, const double* end, std::int64_t left);
  /// Makes room; the last 2 N + 8 samples stay. The command will reach `end` after `left` samples.
  void shift(const double* end, std::int64_t left);
  /// Hands the new samples on.
  void deliver(const SampleSink& sink) const;

  /// Position of an axis by sample number.
  const double* positions(std::size_t axis) const { return axes_[axis].position.data() - base_; }
  /// Values of the new samples, with `before` more in front.
  Eigen::Map<const Eigen::ArrayXd> velocity(std::size_t axis) const { return view(axes_[axis].velocity, 0); }
  Eigen::Map<const Eigen::ArrayXd> acceleration(std::size_t axis) const { return view(axes_[axis].acceleration, 0); }
  Eigen::Map<const Eigen::ArrayXd> acceleration_before(std::size_t axis) const { return view(axes_[axis].acceleration, 1); }
  const std::vector<double>& command_end() const { return command_end_; }

 private:
  struct Step {
    std::int64_t index;
    std::size_t filter;
    double by;  // m a sample
  };
  struct AxisMotion {
    std::vector<Step> steps;           // of the command, not yet filtered
    std::vector<double> command;       // u of every sample
    std::vector<double> acceleration;  // with N + 1 samples of the future
    std::vector<double> velocity, position;
    double now = 0.0;  // u
  };
  void apply(AxisMotion& axis);
  template <std::size_t count>
  void integrate(std::size_t axis);

  Eigen::Map<const Eigen::ArrayXd> view(const std::vector<double>& values, std::int64_t earlier) const {
    return {values.data() + seen_ - earlier, pos_ - seen_};
  }

  std::span<const Filter> filters_;
  std::vector<std::vector<double>> taps_;  // of every filter, between zeros
  std::int64_t order_, keep_, capacity_;  // order of the longest filter
  std::size_t filter_ = 0;                // of the command now
  std::vector<std::uint16_t> filter_of_;  // of every sample of the command
  std::int64_t settled_ = 0;
  std::int64_t base_ = 0, pos_ = 1, seen_ = 1;
  std::vector<AxisMotion> axes_;
  std::vector<double> command_end_;
};

}  // namespace accdec
