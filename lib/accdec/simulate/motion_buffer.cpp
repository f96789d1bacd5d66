#include <algorithm>
#include <array>

#include <accdec/simulate.hpp>
#include <accdec/simulate/convolve.hpp>
#include <accdec/simulate/joint_distance.hpp>
#include <accdec/simulate/motion_buffer.hpp>

namespace accdec {
namespace {
constexpr std::int64_t chunk =
    2048;                // samples between two shifts; three arrays a few axes long stay in the first-level cache
constexpr int many = 6;  // changes in a window from which on they are filtered as a whole, not one by one
}  // namespace

MotionBuffer::MotionBuffer(std::span<const Filter> filters, std::size_t dimensions, const double* start)
    : order_(std::ranges::max_element(filters, {}, &Filter::order)->order()),
      keep_(2 * order_ + 8),
      capacity_(keep_ + chunk),
      axes_(dimensions) {
  const auto size = static_cast<std::size_t>(capacity_), margin = static_cast<std::size_t>(convolve_margin);
  const auto taps = static_cast<std::size_t>(order_) + 1;
  for (std::size_t a = 0; a < dimensions; ++a) {
    axes_[a].filter = &filters[filters.size() == 1 ? 0 : a];
    axes_[a].taps.assign(axes_[a].filter->taps().begin(), axes_[a].filter->taps().end());
    axes_[a].taps.resize(taps + margin, 0.0);
    axes_[a].command.assign(size + static_cast<std::size_t>(change_window), 0.0);
    axes_[a].acceleration.assign(size + taps + static_cast<std::size_t>(change_window) + margin, 0.0);
    axes_[a].velocity.assign(size, 0.0);
    axes_[a].position.assign(size + static_cast<std::size_t>(nearest_margin), 0.0);
    axes_[a].position[0] = start[a];
  }
  count_.assign(size / static_cast<std::size_t>(change_window) + 2, 0);
  changes_.assign(size + 2 * (taps + margin) + static_cast<std::size_t>(change_window), 0.0);
}

void MotionBuffer::step(AxisMotion& axis, std::int64_t index, double by) {
  add_scaled(axis.acceleration.data() + index, by, axis.taps.data(), order_ + 1);
  settled_ = std::max(settled_, number(index) + order_);
}

void MotionBuffer::apply(AxisMotion& axis, std::int64_t from, std::int64_t to) {
  const std::int64_t count = to - from;
  double* const change = changes_.data() + order_ + 1 + convolve_margin;
  find_changes(axis.command.data() + from, count, change, count_.data());
  // Changes in stretches with few of them are filtered one by one and removed. The rest have many changes.
  std::int64_t begin = 0, end = 0;
  const auto convolve = [&] {
    if (end <= begin) return;
    add_convolved(axis.acceleration.data() + from + begin, change + begin, end - begin + order_, axis.taps.data(),
                  order_ + 1);
    settled_ = std::max(settled_, number(from + end - 1) + order_);
  };
  for (std::int64_t k = 0; k < count; k += change_window) {
    const std::int64_t last = std::min(k + change_window, count);
    const int changes = count_[static_cast<std::size_t>(k / change_window)];
    if (changes >= many) {
      // Two stretches are one unless the sums of the first end before the second.
      if (end == 0 || k > end + order_ + convolve_margin) {
        convolve();
        std::fill(change + begin, change + std::max(begin, end), 0.0);
        begin = k;
      }
      for (end = last; change[end - 1] == 0.0; --end) {
      }
    } else if (changes > 0) {
      for (std::int64_t i = k; i < last; ++i) {
        if (change[i] != 0.0) step(axis, from + i, change[i]);
        change[i] = 0.0;
      }
    }
  }
  if (end == 0) return;
  convolve();
  std::fill(change + begin, change + end, 0.0);
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
  for (AxisMotion& axis : axes_) apply(axis, seen_, pos_);
  std::size_t a = 0;
  for (; a + 3 <= axes_.size(); a += 3) integrate<3>(a);
  if (a + 2 == axes_.size()) integrate<2>(a);
  if (a + 1 == axes_.size()) integrate<1>(a);
}

void MotionBuffer::pass_over(std::int64_t count, const double* u, const double* end, std::int64_t left) {
  const std::int64_t last = pos_ - 1;
  base_ = sample() + count;
  pos_ = seen_ = 1;
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    AxisMotion& axis = axes_[a];
    const double lag = static_cast<double>(left) + axis.filter->mean_delay();
    std::fill_n(axis.acceleration.begin(), last + order_ + 2, 0.0);  // no change acts longer
    axis.command[0] = axis.velocity[0] = u[a];
    axis.position[0] = end[a] - lag * u[a];
  }
}

void MotionBuffer::shift(const double* at) {
  const std::int64_t from = pos_ - keep_;
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    AxisMotion& axis = axes_[a];
    // Computes velocity and position of the last sample directly from the command: V = sum b_i u[k-i], S = c[k] - sum_i
    // B'_i u[k-i].
    double v = 0.0, lag = 0.0;
    const double* u = axis.command.data() + pos_ - 1;
    for (int i = 0; i <= order_; ++i) {
      v += axis.filter->tap(i) * u[-i];
      lag += axis.filter->remaining(i + 1) * u[-i];
    }
    axis.velocity[static_cast<std::size_t>(pos_ - 1)] = v;
    axis.position[static_cast<std::size_t>(pos_ - 1)] = at[a] - lag;
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
