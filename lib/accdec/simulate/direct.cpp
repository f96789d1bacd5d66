#include <algorithm>
#include <cmath>
#include <limits>

#include <accdec/simulate/direct.hpp>

namespace accdec {
namespace {

bool at_rest_after(const Toolpath& path, std::span<const int> delays, std::size_t b) {
  return path.joint[b] == Joint::corner || path.joint[b] == Joint::stop || delays[b] > 0 || b + 1 == path.blocks();
}

/// Whole samples that a time takes, by the rule of CommandTiming.
std::int64_t samples_of(double time, double period) {
  const double samples = time / period;
  return static_cast<std::int64_t>(std::ceil(samples - (1e-9 + 1e-11 * samples)));
}

/// The longest rest that is written down: the motion has come to rest, and so have three differences of it.
std::int64_t rest_max(const BlockFilters& legs) {
  return legs.order_max() + legs.behind + 8;
}

/// Position of the command at every sample, and the filter that its step to there passes.
struct CommandSamples {
  std::vector<std::vector<long double>> at;  // by axis; jerk is a third difference of it
  std::vector<std::uint16_t> filter;         // by sample
  std::vector<double> reached;               // by block: sample at which its end is reached
  std::vector<std::int64_t> rest;            // by block: samples of rest after it
  std::vector<DirectMotion::Cut> cuts;
  std::int64_t end_of_motion = 0, last_rest = 0;
};

class Commander {
 public:
  Commander(const Toolpath& path, double period, std::span<const int> delays, const BlockFilters& legs)
      : path_(path), period_(period), delays_(delays), legs_(legs) {
    out_.at.resize(path.dimensions());
    put(path.point(0), 0);
  }

  CommandSamples run() {
    stand(path_.point(0), 0, samples_of(path_.dwell_first, period_));
    out_.reached.resize(path_.blocks());
    out_.rest.resize(path_.blocks());
    for (std::size_t first = 0; first < path_.blocks();) {
      std::size_t last = first;
      while (!at_rest_after(path_, delays_, last)) ++last;
      travel(first, last);
      rest(last);
      first = last + 1;
    }
    return std::move(out_);
  }

 private:
  std::int64_t now() const { return static_cast<std::int64_t>(out_.filter.size()) - 1; }
  template <class Number>
  void put(const Number* point, std::size_t filter) {
    for (std::size_t a = 0; a < out_.at.size(); ++a) out_.at[a].push_back(point[a]);
    out_.filter.push_back(static_cast<std::uint16_t>(filter));
  }

  /// A run takes the next whole number of samples; all its feeds are lowered by the same factor.
  void travel(std::size_t first, std::size_t last) {
    // The last step takes what a hundred thousand chords leave by rounding, a millionth of it in double.
    long double time = 0.0L;
    for (std::size_t b = first; b <= last; ++b) time += path_.duration[b];
    const std::int64_t samples = std::max<std::int64_t>(1, samples_of(static_cast<double>(time), period_));
    const std::int64_t from = now();
    const long double stretch = static_cast<long double>(samples) * period_ / time;
    std::vector<long double> point(path_.dimensions());
    std::size_t b = first;
    long double begun = 0.0L;  // samples after `from` at which block b begins
    for (std::int64_t k = 1; k <= samples; ++k) {
      const auto t = static_cast<long double>(k);
      long double lasts = path_.duration[b] * stretch / period_;
      while (b < last && begun + lasts <= t + 1e-9) {
        begun += lasts;
        out_.reached[b] = static_cast<double>(static_cast<long double>(from) + begun);
        ++b;
        lasts = path_.duration[b] * stretch / period_;
      }
      // A block that begins this little later is extended backwards: a step back to its start would change the jerk.
      const long double part = k == samples ? 1.0L : std::min((t - begun) / lasts, 1.0L);
      for (std::size_t a = 0; a < point.size(); ++a) {
        const long double start = path_.point(b)[a];
        point[a] = start + part * (path_.point(b + 1)[a] - start);
      }
      put(point.data(), legs_.index(b));
    }
    // Blocks shorter than the rest of the last sample.
    for (; b <= last; ++b) out_.reached[b] = static_cast<double>(now());
    out_.end_of_motion = std::max(out_.end_of_motion, now() + legs_.of(last).order() + 1);
  }

  void rest(std::size_t b) {
    std::int64_t dwell = 0;
    for (const auto& [block, time] : path_.dwell) {
      if (block == b) dwell += samples_of(time, period_);
    }
    if (b + 1 == path_.blocks()) {
      out_.last_rest = dwell;
      return;
    }
    out_.rest[b] = stand(path_.point(b + 1), legs_.index(b), delays_[b] + dwell);
  }

  /// @returns how many of these samples are written down
  std::int64_t stand(const double* point, std::size_t filter, std::int64_t samples) {
    const std::int64_t written = std::min(samples, rest_max(legs_));
    for (std::int64_t k = 0; k < written; ++k) put(point, filter);
    if (samples > written) out_.cuts.push_back({now() + 1, samples - written});
    return written;
  }

  const Toolpath& path_;
  double period_;
  std::span<const int> delays_;
  const BlockFilters& legs_;
  CommandSamples out_;
};

}  // namespace

int BlockFilters::order_max() const {
  int order = 0;
  for (const Filter& filter : filters) order = std::max(order, filter.order());
  return order;
}

double direct_motion_steps(const Toolpath& path, double sample_period, std::span<const int> delays,
                           const BlockFilters& legs) {
  const auto most = static_cast<double>(rest_max(legs));
  const auto rest = [&](double time) { return std::min(time / sample_period, most); };
  double samples = rest(path.dwell_first);
  for (std::size_t b = 0; b < path.blocks(); ++b)
    samples += path.duration[b] / sample_period + std::min<double>(delays[b], most);
  for (const auto& [block, time] : path.dwell) samples += rest(time);
  return samples * static_cast<double>(path.dimensions()) * (legs.order_max() + 1.0);
}

std::int64_t DirectMotion::kept(std::int64_t k) const {
  for (const Cut& cut : cuts) {
    if (k < cut.before) break;
    // A sample left out rests as the one before the cut does.
    k = k < cut.before + cut.count ? cut.before - 1 : k - cut.count;
  }
  return k;
}

DirectMotion direct_motion(const Toolpath& path, double sample_period, std::span<const int> delays,
                           const BlockFilters& legs) {
  const CommandSamples command = Commander(path, sample_period, delays, legs).run();
  const auto commanded = static_cast<std::int64_t>(command.filter.size());
  DirectMotion motion;
  motion.samples = command.end_of_motion + command.last_rest;
  for (const DirectMotion::Cut& cut : command.cuts) motion.samples += cut.count;
  motion.cuts = command.cuts;
  const auto all = static_cast<std::size_t>(commanded + legs.order_max() + legs.behind + 4);
  for (const std::vector<long double>& at : command.at) {
    std::vector<long double> moved(all, 0.0L);
    for (std::int64_t k = 1; k < commanded; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const long double step = at[i] - at[i - 1];
      if (step == 0.0L) continue;
      const auto taps = legs.filters[command.filter[i]].taps();
      for (std::size_t j = 0; j < taps.size(); ++j) moved[i + j] += step * taps[j];
    }
    std::vector<double>& position = motion.position.emplace_back(all);
    std::vector<double>& velocity = motion.velocity.emplace_back(all);
    long double where = at.front();
    for (std::size_t k = 0; k < all; ++k) {
      where += moved[k];
      position[k] = static_cast<double>(where);
      velocity[k] = static_cast<double>(moved[k] / sample_period);
    }
  }
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
    const int order = std::max(legs.of(b).order(), legs.of(b + 1).order()) + legs.behind;
    const auto last = static_cast<std::int64_t>(all) - 1;
    motion.windows.push_back({static_cast<std::int64_t>(std::floor(command.reached[b] + 1e-9)),
                              std::min(last, static_cast<std::int64_t>(std::ceil(command.reached[b] - 1e-9)) +
                                                 command.rest[b] + order + 1)});
  }
  return motion;
}

DirectMotion behind_servos(const DirectMotion& command, const Machine& machine, double sample_period) {
  DirectMotion motion = command;
  for (std::size_t a = 0; a < motion.position.size(); ++a) {
    const Axis& axis = machine.axes[a];
    const std::vector<double>& v = command.velocity[a];
    std::vector<double>&moved = motion.velocity[a], &at = motion.position[a];
    if (!axis.response_taps.empty()) {
      long double sum = 0.0L, where = command.position[a].front();
      for (const double tap : axis.response_taps) sum += tap;
      for (std::size_t k = 0; k < v.size(); ++k) {
        long double speed = 0.0L;
        for (std::size_t j = 0; j < axis.response_taps.size() && j <= k; ++j) speed += axis.response_taps[j] * v[k - j];
        moved[k] = static_cast<double>(speed / sum);
        at[k] = static_cast<double>(where += speed / sum * sample_period);
      }
    } else if (axis.servo_gain < unlimited) {
      const long double x = axis.servo_gain * static_cast<long double>(sample_period), left = std::expm1(-x);
      const long double lag = (1.0L - axis.velocity_feedforward) * -left / axis.servo_gain;
      long double error = 0.0L;
      for (std::size_t k = 0; k < v.size(); ++k) {
        const long double change = left * error + lag * v[k];
        error += change;
        moved[k] = static_cast<double>(v[k] - change / sample_period);
        at[k] = static_cast<double>(command.position[a][k] - error);
      }
    }
  }
  return motion;
}

std::int64_t direct_settling(const DirectMotion& motion, const Toolpath& path, double within) {
  const double* end = path.point(path.blocks());
  const std::int64_t from = motion.kept(motion.samples), all = std::ssize(motion.position.front());
  std::int64_t settled = from;
  for (std::int64_t k = from; k < all; ++k) {
    double square = 0.0;
    for (std::size_t a = 0; a < path.dimensions(); ++a)
      square += std::pow(motion.position[a][static_cast<std::size_t>(k)] - end[a], 2);
    if (std::sqrt(square) > within) settled = k + 1;
  }
  return settled - from;
}

double direct_distance(const DirectMotion& motion, const double* point, std::int64_t first, std::int64_t last,
                       bool between) {
  const std::size_t n = motion.position.size();
  double least = std::numeric_limits<double>::infinity();
  for (std::int64_t k = first; k <= last; ++k) {
    const auto i = static_cast<std::size_t>(k);
    double off = 0.0, along = 0.0, length = 0.0;
    for (std::size_t a = 0; a < n; ++a) {
      const double from = point[a] - motion.position[a][i];
      off += from * from;
      if (!between || k == last) continue;
      const double way = motion.position[a][i + 1] - motion.position[a][i];
      along += from * way, length += way * way;
    }
    least = std::min(least, off);
    if (length > 0.0 && along > 0.0 && along < length) {
      // Computed again from the foot of the perpendicular, because a difference of squares would lose the digits.
      double foot = 0.0;
      for (std::size_t a = 0; a < n; ++a) {
        const double way = motion.position[a][i + 1] - motion.position[a][i];
        const double from = point[a] - motion.position[a][i] - along / length * way;
        foot += from * from;
      }
      least = std::min(least, foot);
    }
  }
  return std::sqrt(least);
}

double direct_error(const DirectMotion& motion, const Toolpath& path, std::size_t b) {
  const bool between = path.joint[b] == Joint::smooth || path.joint[b] == Joint::straight;
  const DirectMotion::Window& window = motion.windows[b];
  return direct_distance(motion, path.programmed_point(b + 1), window.first, window.last, between);
}

}  // namespace accdec
