#include <accdec/program/motion_buffer.hpp>

#include <algorithm>
#include <array>

#include <accdec/program/add_scaled.hpp>
#include <accdec/program/move.hpp>

namespace accdec {
namespace {
constexpr std::int64_t chunk = 2048;  // samples between two shifts; three arrays a few axes long stay in the first-level cache
}

MotionBuffer::MotionBuffer(const Filter& filter, std::size_t dimensions, const double* start)
    : mean_delay_(filter.mean_delay()),
      order_(filter.order()),
      keep_(2 * order_ + 8),
      capacity_(keep_ + chunk),
      axes_(dimensions),
      command_end_(start, start + dimensions) {
  taps_.resize(order_ + 1);
  remaining_.resize(order_ + 1);
  for (int i = 0; i <= filter.order(); ++i) {
    taps_[i] = filter.tap(i);
    remaining_[i] = filter.remaining(i + 1);
  }
  const auto size = static_cast<std::size_t>(capacity_);
  for (std::size_t a = 0; a < dimensions; ++a) {
    axes_[a].command.assign(size, 0.0);
    axes_[a].acceleration.assign(size + static_cast<std::size_t>(order_) + 1, 0.0);
    axes_[a].velocity.assign(size, 0.0);
    axes_[a].position.assign(size, 0.0);
    axes_[a].position[0] = start[a];
  }
}

void MotionBuffer::change(const double* u) {
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    AxisMotion& axis = axes_[a];
    const double step = u[a] - axis.now;
    if (step == 0.0) continue;
    add_scaled(axis.acceleration.data() + pos_, step, taps_.data(), order_ + 1);
    axis.now = u[a];
  }
}

void MotionBuffer::advance(std::int64_t count, std::int64_t left, const double* end) {
  const auto first = static_cast<std::size_t>(pos_), last = static_cast<std::size_t>(pos_ + count);
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    AxisMotion& axis = axes_[a];
    std::fill(axis.command.begin() + pos_, axis.command.begin() + pos_ + count, axis.now);
    double v = axis.velocity[first - 1], s = axis.position[first - 1];
    for (std::size_t k = first; k < last; ++k) {
      v += axis.acceleration[k];
      s += v;
      axis.velocity[k] = v;
      axis.position[k] = s;
    }
    if (count == left) command_end_[a] = end[a];
  }
  pos_ += count;
}

void MotionBuffer::pass_over(std::int64_t count, const double* u, const double* end, std::int64_t left) {
  base_ = sample() + count;
  pos_ = seen_ = 1;
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    AxisMotion& axis = axes_[a];
    std::fill(axis.acceleration.begin(), axis.acceleration.end(), 0.0);
    axis.command[0] = axis.velocity[0] = u[a];
    axis.position[0] = end[a] - (static_cast<double>(left) + mean_delay_) * u[a];
  }
}

void MotionBuffer::shift(const double* end, std::int64_t left) {
  const std::int64_t from = pos_ - keep_;
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    AxisMotion& axis = axes_[a];
    // Velocity and position of the last sample straight from the command: V = sum b_i u[k-i], S = c[k] - sum_i B'_i u[k-i].
    double v = 0.0, lag = 0.0;
    const double* u = axis.command.data() + pos_ - 1;
    for (std::int64_t i = 0; i <= order_; ++i) {
      v += taps_[i] * u[-i];
      lag += remaining_[i] * u[-i];
    }
    axis.velocity[static_cast<std::size_t>(pos_ - 1)] = v;
    axis.position[static_cast<std::size_t>(pos_ - 1)] = end[a] - static_cast<double>(left) * axis.now - lag;
    for (std::vector<double>* values : {&axis.command, &axis.velocity, &axis.position}) {
      std::copy(values->begin() + from, values->begin() + pos_, values->begin());
    }
    std::vector<double>& acceleration = axis.acceleration;
    const auto tail = std::copy(acceleration.begin() + from, acceleration.end(), acceleration.begin());
    std::fill(tail, acceleration.end(), 0.0);
  }
  base_ += from;
  seen_ -= from;
  pos_ = keep_;
}

void MotionBuffer::deliver(const SampleSink& sink) const {
  std::array<const double*, program_axis_count> position{}, velocity{};
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    position[a] = axes_[a].position.data() + seen_;
    velocity[a] = axes_[a].velocity.data() + seen_;
  }
  if (pos_ > seen_) sink(number(seen_), pos_ - seen_, position.data(), velocity.data());
}

}  // namespace accdec
