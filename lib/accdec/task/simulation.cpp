#include <array>
#include <cmath>
#include <span>
#include <utility>

#include <accdec/machine/response.hpp>
#include <accdec/task/corner_feed.hpp>
#include <accdec/task/simulation.hpp>

namespace accdec {
namespace {

/// A sample at which the command changes, and the change; elsewhere the command is constant.
struct Step {
  int at;
  double size;
};

/// The command of one axis: rest, leg 1, gap, leg 2, rest. The feed is lowered on leg 1 and raised on leg 2.
struct Command {
  std::array<Step, 6> steps;

  double at(int k) const {
    double value = 0.0;
    for (const Step& step : steps) value = k >= step.at ? value + step.size : value;
    return value;
  }
};

/// The servo of one axis.
class Servo {
 public:
  Servo(const Axis& axis, double period) : taps_(axis.response_taps.begin(), axis.response_taps.end()) {
    long double sum = 0.0L;
    for (const long double tap : taps_) sum += tap;
    for (long double& tap : taps_) tap /= sum;
    if (!taps_.empty() || !(axis.servo_gain < unlimited)) return;
    const long double gain = axis.servo_gain;
    keeps_ = std::exp(-gain * period);
    takes_ = (1.0L - axis.velocity_feedforward) * (1.0L - keeps_) / gain;
  }
  /// The mean velocity in the next sample, from the command's.
  long double follow(long double velocity, double period) {
    if (!taps_.empty()) {
      past_.insert(past_.begin(), velocity);
      if (past_.size() > taps_.size()) past_.pop_back();
      long double sum = 0.0L;
      for (std::size_t i = 0; i < past_.size(); ++i) sum += taps_[i] * past_[i];
      return sum;
    }
    const long double before = error_;
    error_ = keeps_ * error_ + takes_ * velocity;
    return velocity - (error_ - before) / period;
  }

 private:
  std::vector<long double> taps_, past_;
  long double keeps_ = 0.0L, takes_ = 0.0L, error_ = 0.0L;
};

/// The samples of one axis go here.
class Column {
 public:
  Column(SampledMotion& motion, Eigen::Index axis, double period, long double start)
      : motion_(motion), axis_(axis), period_(period), position_(start) {}
  void add(int k, long double velocity) {
    position_ += velocity * period_;
    motion_.velocity(k, axis_) = static_cast<double>(velocity);
    motion_.position(k, axis_) = static_cast<double>(position_);
    if (k == 0) return;
    motion_.acceleration(k, axis_) = (motion_.velocity(k, axis_) - motion_.velocity(k - 1, axis_)) / period_;
    motion_.jerk(k, axis_) = (motion_.acceleration(k, axis_) - motion_.acceleration(k - 1, axis_)) / period_;
  }

 private:
  SampledMotion& motion_;
  Eigen::Index axis_;
  double period_;
  long double position_;
};

/// Rest, leg 1, gap, leg 2, rest: where they are, and room for the samples.
class Stretches {
 public:
  Stretches(int order, int response, int gap, double part)
      : part_(part),
        slow_(part < 1.0 ? corner_feed_lead(order, response) : 0),
        rest_(order + response + 3),
        leg_(order + response + 4 + slow_),
        delay_(gap) {}
  SampledMotion motion(Eigen::Index axes) const {
    SampledMotion motion;
    motion.start = rest_ - 1;
    motion.corner = rest_ + leg_ - 1;
    motion.stop = motion.corner + delay_ + leg_;
    motion.cruise_in = motion.corner - 1;
    motion.cruise_out = motion.stop - 1;
    motion.velocity = Eigen::MatrixXd::Zero(total(), axes);
    motion.acceleration = motion.jerk = motion.position = motion.velocity;
    return motion;
  }
  int total() const { return rest_ + leg_ + delay_ + leg_ + rest_; }
  Command command(double in, double out) const {
    const int corner = rest_ + leg_, after = corner + delay_;
    const double slow_in = part_ * in, slow_out = part_ * out;
    return {{{{rest_, in},
              {corner - slow_, slow_in - in},
              {corner, -slow_in},
              {after, slow_out},
              {after + slow_, out - slow_out},
              {after + leg_, -out}}}};
  }
  /// Minus the commanded way of leg 1, m: positions from there are relative to the corner point.
  long double start(double in, double period) const {
    const long double way =
        static_cast<long double>(in) * (leg_ - slow_) + static_cast<long double>(part_ * in) * slow_;
    return -way * period;
  }

 private:
  double part_;
  int slow_, rest_, leg_, delay_;
};

/// The filtered command of one axis, m/s, sample by sample. The convolution of the command with the taps changes only
/// if the command changed within the last n samples. Otherwise it is the sum of all taps, and no rounding of earlier
/// samples is carried on.
class Filtered {
 public:
  Filtered(const Filter& filter, const Command& command) : taps_(filter.taps()), command_(command) {
    for (const double tap : taps_) whole_ += tap;
  }
  long double at(int k) {
    bool changing = false;
    for (const Step& step : command_.steps) {
      if (k < step.at || k - step.at >= static_cast<int>(taps_.size())) continue;
      velocity_ += static_cast<long double>(taps_[static_cast<std::size_t>(k - step.at)]) * step.size;
      changing = true;
    }
    if (!changing) velocity_ = whole_ * command_.at(k);
    return velocity_;
  }

 private:
  std::span<const double> taps_;
  const Command& command_;
  long double whole_ = 0.0L, velocity_ = 0.0L;
};

/// Taps of the filter behind the control's smoothing.
Filter smoothed(const Filter& filter, const std::vector<double>& smoothing) {
  if (smoothing.empty()) return filter;
  std::vector<double> taps(static_cast<std::size_t>(filter.order()) + smoothing.size(), 0.0);
  for (std::size_t i = 0; i < taps.size(); ++i) {
    for (std::size_t j = 0; j < smoothing.size(); ++j)
      taps[i] += filter.tap(static_cast<int>(i) - static_cast<int>(j)) * smoothing[j];
  }
  return Filter(std::move(taps));
}

}  // namespace

SampledMotion simulate_corner(const Filter& filter, const Corner& corner, int delay, double sample_period,
                              double part) {
  const Stretches stretches(filter.order(), 0, delay, part);
  SampledMotion motion = stretches.motion(corner.axes());
  for (Eigen::Index a = 0; a < corner.axes(); ++a) {
    const double in = corner.feed_in * corner.direction_in[a], out = corner.feed_out * corner.direction_out[a];
    const Command command = stretches.command(in, out);
    Filtered filtered(filter, command);
    // Extended precision, because the path is metres long and the corner error micrometres.
    Column column(motion, a, sample_period, stretches.start(in, sample_period));
    for (int k = 0; k < stretches.total(); ++k) column.add(k, filtered.at(k));
  }
  return motion;
}

SampledResponse simulate_response(const Filter& filter, const Corner& corner, int delay, double sample_period,
                                  const Machine& machine, double part) {
  const Response response(machine, sample_period);
  SampledResponse sampled;
  if (response.ideal()) {
    sampled.command = simulate_corner(filter, corner, delay, sample_period, part);
    return sampled;
  }
  const Filter behind = smoothed(filter, response.prefilter_order() > 0 ? response.prefilter() : std::vector<double>{});
  sampled.longer = response.order();
  const Stretches stretches(behind.order(), response.servo_order(), delay, part);
  sampled.command = sampled.moved.emplace(stretches.motion(corner.axes()));
  for (Eigen::Index a = 0; a < corner.axes(); ++a) {
    const double in = corner.feed_in * corner.direction_in[a], out = corner.feed_out * corner.direction_out[a];
    const Command command = stretches.command(in, out);
    Filtered filtered(behind, command);
    const long double start = stretches.start(in, sample_period);
    Column commanded(sampled.command, a, sample_period, start), moved(*sampled.moved, a, sample_period, start);
    Servo servo(machine.axes[static_cast<std::size_t>(a)], sample_period);
    for (int k = 0; k < stretches.total(); ++k) {
      const long double velocity = filtered.at(k);
      commanded.add(k, velocity);
      moved.add(k, servo.follow(velocity, sample_period));
    }
  }
  return sampled;
}

std::vector<AxisState> axis_states(const SampledResponse& sampled, const Axis& axis, Eigen::Index a,
                                   double sample_period, double still) {
  const SampledMotion &command = sampled.command, &motion = sampled.motion();
  AxisSampler sampler(axis, sample_period, still);
  std::vector<AxisState> states;
  for (Eigen::Index n = 0; n < command.velocity.rows(); ++n) {
    const AxisState state = sampler.next(command.velocity(n, a), command.acceleration(n, a));
    states.push_back(with_load(state, axis, motion.velocity(n, a), motion.acceleration(n, a), still));
  }
  return states;
}

}  // namespace accdec
