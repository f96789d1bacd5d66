#include <accdec/program/motion_buffer.hpp>

#include <algorithm>
#include <array>

#include <accdec/program/add_scaled.hpp>
#include <accdec/program/move.hpp>

namespace accdec {
namespace {
constexpr std::size_t margin = 8;  // zeros around the taps, for steps filtered together
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
  for (const Filter& filter : filters_) {
    std::vector<double>& taps = taps_.emplace_back(margin, 0.0);
    taps.insert(taps.end(), filter.taps().begin(), filter.taps().end());
    taps.insert(taps.end(), margin, 0.0);
  }
  for (std::size_t a = 0; a < dimensions; ++a) {
    axes_[a].command.assign(size, 0.0);
    axes_[a].acceleration.assign(size + static_cast<std::size_t>(order_) + 1 + margin, 0.0);
    axes_[a].velocity.assign(size, 0.0);
    axes_[a].position.assign(size, 0.0);
    axes_[a].position[0] = start[a];
  }
}

void MotionBuffer::change(const double* u, std::size_t f) {
  const auto step = [&](AxisMotion& axis, std::size_t filter, double by) {
    axis.steps.push_back({pos_, filter, by});
    settled_ = std::max<std::int64_t>(settled_, sample() + filters_[filter].order() + 1);
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
  for (std::int64_t k = pos_; k < pos_ + count; ++k) filter_of_[static_cast<std::size_t>(k)] = static_cast<std::uint16_t>(filter_);
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    double* command = axes_[a].command.data() + pos_;
    const double now = axes_[a].now;
    for (std::int64_t k = 0; k < count; ++k) command[k] = now;
    if (count == left) command_end_[a] = end[a];
  }
  pos_ += count;
}

void MotionBuffer::apply(AxisMotion& axis) {
  const std::vector<Step>& steps = axis.steps;
  for (std::size_t i = 0; i < steps.size();) {
    const Step& first = steps[i];
    double by[4] = {first.by, 0.0, 0.0, 0.0};
    std::size_t next = i + 1;
    for (; next < steps.size() && steps[next].index < first.index + 4 && steps[next].filter == first.filter; ++next) {
      by[steps[next].index - first.index] += steps[next].by;
    }
    const double* taps = taps_[first.filter].data() + margin;
    const std::int64_t count = filters_[first.filter].order() + 1;
    double* at = axis.acceleration.data() + first.index;
    if (next == i + 1) {
      add_scaled(at, by[0], taps, count);
    } else {
      add_scaled4(at, by, taps, count + 3);
    }
    i = next;
  }
  axis.steps.clear();
}

template <std::size_t count>
void MotionBuffer::integrate(std::size_t axis) {
  std::array<const double*, count> acceleration;
  std::array<double*, count> velocity, position;
  std::array<double, count> v, s;
  for (std::size_t a = 0; a < count; ++a) {
    AxisMotion& motion = axes_[axis + a];
    acceleration[a] = motion.acceleration.data();
    velocity[a] = motion.velocity.data();
    position[a] = motion.position.data();
    v[a] = velocity[a][seen_ - 1];
    s[a] = position[a][seen_ - 1];
  }
  for (std::int64_t k = seen_; k < pos_; ++k) {
    for (std::size_t a = 0; a < count; ++a) {
      velocity[a][k] = v[a] += acceleration[a][k];
      position[a][k] = s[a] += v[a];
    }
  }
}

void MotionBuffer::make() {
  for (AxisMotion& axis : axes_) apply(axis);
  std::size_t a = 0;
  for (; a + 3 <= axes_.size(); a += 3) integrate<3>(a);
  if (a + 2 == axes_.size()) integrate<2>(a);
  if (a + 1 == axes_.size()) integrate<1>(a);
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
