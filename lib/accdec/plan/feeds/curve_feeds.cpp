#include <algorithm>
#include <array>
#include <cmath>

#include <accdec/machine.hpp>
#include <accdec/plan/feeds/curve_feeds.hpp>

namespace accdec {
namespace {

using Point = std::array<double, program_axis_count>;

/// Deviation at the joints of one leg passed at constant speed.
class SteadyError {
 public:
  SteadyError(const Toolpath& path, const FilterBehind& behind, std::size_t first, std::size_t last,
              std::span<const double> length)
      : path_(path),
        behind_(behind),
        first_(first),
        last_(last),
        length_(length),
        command_(static_cast<std::size_t>(behind.longest_order()) + 3) {}

  /// Distance of joint b from the filtered path, m. @param step  v T, m
  double operator()(std::size_t b, double step) {
    const std::size_t n = path_.dimensions(), count = command_.size();
    // command_[i] is the command at mean delay + 1 - i samples after the joint.
    const double mean = behind_.motion().mean_delay();
    std::size_t i = count;
    std::size_t block = b;
    double from_joint = 0.0;  // of the beginning of the block
    const std::size_t after = std::min(count, static_cast<std::size_t>(std::floor(mean + 1.0)) + 1);
    block = b + 1;
    for (i = after; i-- > 0;) {
      const double s = (mean + 1.0 - static_cast<double>(i)) * step;
      while (block < last_ && from_joint + length_[block] < s) from_joint += length_[block++];
      place(command_[i], block, std::min(1.0, (s - from_joint) / length_[block]));
    }
    block = b;
    from_joint = 0.0;  // of its end, backwards
    for (i = after; i < count; ++i) {
      const double s = (static_cast<double>(i) - mean - 1.0) * step;
      while (block > first_ && from_joint + length_[block] < s) from_joint += length_[block--];
      place(command_[i], block, std::max(0.0, 1.0 - (s - from_joint) / length_[block]));
    }
    std::array<Point, 3> passed{};
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t a = 0; a < n; ++a) {
        const Filter& filter = behind_.motion(a);
        for (int tap = 0; tap <= filter.order(); ++tap)
          passed[k][a] += filter.tap(tap) * command_[k + static_cast<std::size_t>(tap)][a];
      }
    }
    const double* joint = path_.programmed_point(b + 1);
    double least = unlimited;
    for (std::size_t k = 0; k < 2; ++k) {
      double along2 = 1e-300, dot = 0.0, sum = 0.0;
      for (std::size_t a = 0; a < n; ++a) {
        const double d = passed[k + 1][a] - passed[k][a];
        along2 += d * d;
        dot += (joint[a] - passed[k][a]) * d;
      }
      // Axes that lag differently pass the joint at another time.
      const double t = behind_.differs() ? dot / along2 : std::clamp(dot / along2, 0.0, 1.0);
      for (std::size_t a = 0; a < n; ++a) {
        const double x = passed[k][a] + t * (passed[k + 1][a] - passed[k][a]) - joint[a];
        sum += x * x;
      }
      least = std::min(least, sum);
    }
    return std::sqrt(least);
  }

 private:
  void place(Point& at, std::size_t block, double part) const {
    const std::size_t n = path_.dimensions();
    const double* p = path_.point(block);
    for (std::size_t a = 0; a < n; ++a) at[a] = p[a] + part * (p[n + a] - p[a]);
  }

  const Toolpath& path_;
  const FilterBehind& behind_;
  std::size_t first_, last_;  // blocks of the leg
  std::span<const double> length_;
  std::vector<Point> command_;
};

/// Sagitta of the arc through a joint, whose chord is the shorter of its blocks.
double sagitta(const Toolpath& path, std::size_t b, double in, double out) {
  const std::size_t n = path.dimensions();
  const double* p = path.point(b);
  double change2 = 0.0;
  for (std::size_t a = 0; a < n; ++a) {
    const double change = (p[2 * n + a] - p[n + a]) / out - (p[n + a] - p[a]) / in;
    change2 += change * change;
  }
  return std::sqrt(change2) * std::min(in, out) / 8.0;
}

/// Adds the stretches of a leg whose blocks are slowed; stretches less than `reach` seconds apart are joined.
void add_slowed(const Toolpath& path, const Curve& leg, double reach, CurveFeeds& result) {
  double apart = 2.0 * reach;  // from the last block of a curve
  for (std::size_t b = leg.first; b <= leg.last; ++b) {
    if (!(result.duration[b] > path.duration[b])) {
      apart += path.duration[b];
      continue;
    }
    if (apart < reach && !result.curves.empty() && result.curves.back().last >= leg.first) {
      result.curves.back().last = b;
    } else {
      result.curves.push_back({b, b});
    }
    apart = 0.0;
  }
}

}  // namespace

CurveFeeds curve_feeds(const Toolpath& path, const FilterBehind& behind, double sample_period,
                       std::span<const int> delays, std::span<const double> planned, std::size_t joints_max) {
  const std::size_t blocks = path.blocks(), n = path.dimensions();
  const double reach = (behind.felt_order() + 2) * sample_period;
  const auto chosen =
      [&](std::size_t b) {  // whether the plan had to do something about the block or the joint at its end
        return planned[b] > path.duration[b] * (1.0 + 1e-9) || (!ends_leg(path, b) && delays[b] > 0);
      };
  std::vector<Curve> legs;
  std::size_t joints = 0;
  for (std::size_t first = 0, b = 0; b < blocks; first = ++b) {
    bool any = chosen(b);
    while (!ends_leg(path, b)) any = chosen(++b) || any;
    if (!any || b == first) continue;
    legs.push_back({first, b});
    joints += b - first;
  }
  CurveFeeds result;
  if (legs.empty() || joints > joints_max) return result;
  result.duration = path.duration;
  std::vector<double> length(blocks);
  for (const Curve& leg : legs) {
    for (std::size_t b = leg.first; b <= leg.last; ++b) {
      const double* p = path.point(b);
      double sum = 0.0;
      for (std::size_t a = 0; a < n; ++a) sum += (p[n + a] - p[a]) * (p[n + a] - p[a]);
      length[b] = std::sqrt(sum);
    }
    SteadyError error(path, behind, leg.first, leg.last, length);
    for (std::size_t b = leg.first; b < leg.last; ++b) {
      const bool adjust_in = path.duration[b] < reach, adjust_out = path.duration[b + 1] < reach;
      if (!adjust_in && !adjust_out) continue;
      const double granted = path.tolerance[b] > 0.0 ? path.tolerance[b] : sagitta(path, b, length[b], length[b + 1]);
      const double bound = std::min(granted, path.contour_max);
      if (!(bound < unlimited) || bound < 1e-9) continue;
      const double fastest = std::max(adjust_in ? length[b] / path.duration[b] : 0.0,
                                      adjust_out ? length[b + 1] / path.duration[b + 1] : 0.0);
      if (error(b, fastest * sample_period) <= bound) continue;
      double low = 0.0, high = fastest;
      while (high - low > 0.005 * high) {
        const double middle = 0.5 * (low + high);
        (error(b, middle * sample_period) <= bound ? low : high) = middle;
        if (high < 1e-4 * fastest) break;
      }
      const double speed = std::max(low, 1e-4 * fastest);
      if (adjust_in) result.duration[b] = std::max(result.duration[b], length[b] / speed);
      if (adjust_out) result.duration[b + 1] = std::max(result.duration[b + 1], length[b + 1] / speed);
    }
    add_slowed(path, leg, reach, result);
  }
  return result;
}

double curve_time(const Curve& curve, std::span<const double> duration, std::span<const int> delays,
                  double sample_period) {
  double time = 0.0;
  const std::size_t first = curve.first > 0 ? curve.first - 1 : 0, last = std::min(curve.last + 1, duration.size() - 1);
  for (std::size_t b = first; b <= last; ++b) time += duration[b];
  for (std::size_t b = first; b < last; ++b) time += delays[b] * sample_period;
  return time;
}

}  // namespace accdec
