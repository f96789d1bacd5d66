#include <accdec/program/motion_buffer.hpp>

#include <algorithm>
#include <array>

#include <accdec/program/add_scaled.hpp>
#include <accdec/program/move.hpp>

namespace accdec {
namespace {
constexpr std::int64_t chunk = 2048;  // samples between two shifts; three arrays a few axes long stay in the first-level cache
}

MotionBuffer::MotionBuffer(const LegFilters& filters, std::size_t dimensions, const double* start)
    : filters_(filters.filters()),
      order_(filters.order_max()),
      keep_(2 * order_ + 8),
      capacity_(keep_ + chunk),
      axes_(dimensions),
      command_end_(start, start + dimensions) {
  const auto size = static_cast<std::size_t>(capacity_);
  filter_of_.assign(size, 0);
  for (std::size_t a = 0; a < dimensions; ++a) {
    axes_[a].command.assign(size, 0.0);
    axes_[a].acceleration.assign(size + static_cast<std::size_t>(order_) + 1, 0.0);
    axes_[a].velocity.assign(size, 0.0);
    axes_[a].position.assign(size, 0.0);
    axes_[a].position[0] = start[a];
  }
}

void MotionBuffer::change(const double* u, std::size_t f) {
  const auto step = [&](AxisMotion& axis, std::size_t filter, double by) {
    const std::span<const double> taps = filters_[filter].taps();
    add_scaled(axis.acceleration.data() + pos_, by, taps.data(), static_cast<std::int64_t>(taps.size()));
    settled_ = std::max(settled_, sample() + static_cast<std::int64_t>(taps.size()));
  };
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    AxisMotion& axis = axes_[a];
    if (f == filter_) {
      if (u[a] != axis.now) step(axis, f, u[a] - axis.now);
    } else {
      if (axis.now != 0.0) step(axis, filter_, -axis.now);
      if (u[a] != 0.0) step(axis, f, u[a]);
    }
    axis.now = u[a];
  }
  filter_ = f;
}

void MotionBuffer::advance(std::int64_t count, std::int64_t left, const double* end) {
  const auto first = static_cast<std::size_t>(pos_), last = static_cast<std::size_t>(pos_ + count);
  std::fill(filter_of_.begin() + pos_, filter_of_.begin() + pos_ + count, static_cast<std::uint16_t>(filter_));
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
  filter_of_[0] = static_cast<std::uint16_t>(filter_);
  const double lag = static_cast<double>(left) + filters_[filter_].mean_delay();
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    AxisMotion& axis = axes_[a];
    std::fill(axis.acceleration.begin(), axis.acceleration.end(), 0.0);
    axis.command[0] = axis.velocity[0] = u[a];
    axis.position[0] = end[a] - lag * u[a];
  }
}

void MotionBuffer::shift(const double* end, std::int64_t left) {
  const std::int64_t from = pos_ - keep_;
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    AxisMotion& axis = axes_[a];
    // Velocity and position of the last sample straight from the command: V = sum b_i u[k-i], S = c[k] - sum_i B'_i u[k-i].
    double v = 0.0, lag = 0.0;
    const double* u = axis.command.data() + pos_ - 1;
    for (int i = 0; i <= order_; ++i) {
      const Filter& filter = filters_[filter_of_[static_cast<std::size_t>(pos_ - 1 - i)]];
      v += filter.tap(i) * u[-i];
      lag += filter.remaining(i + 1) * u[-i];
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
  std::copy(filter_of_.begin() + from, filter_of_.begin() + pos_, filter_of_.begin());
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
