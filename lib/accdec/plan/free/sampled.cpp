#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include <accdec/plan/free/free_motion.hpp>
#include <accdec/simulate/command_stream.hpp>
#include <accdec/simulate/profile_motion.hpp>
#include <accdec/simulate/sample_check.hpp>

namespace accdec {
namespace {

constexpr double rounding2 = 1e-28;  // m^2

/// The place on the step from a to b that is nearest to the point, not before `low`.
double nearest(const double* a, const double* b, const double* point, std::size_t n, double low) {
  double along = 0.0, length2 = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    along += (point[i] - a[i]) * (b[i] - a[i]);
    length2 += (b[i] - a[i]) * (b[i] - a[i]);
  }
  return std::clamp(length2 > 0.0 ? along / length2 : 0.0, low, 1.0);
}

/// The place of a motion that is nearest to a point, not before `least`: a sample with a fraction.
class NearestPlace {
 public:
  NearestPlace(const FreeSamples& motion, const double* point, std::size_t n, double least)
      : motion_(motion), point_(point), n_(n), least_(least), at_(least) {}

  /// The step that ends in sample k.
  void offer(std::size_t k) {
    const double* const a = motion_.position.data() + (k - 1) * n_;
    const double t = nearest(a, a + n_, point_, n_, std::max(0.0, least_ - static_cast<double>(k - 1)));
    double distance2 = 0.0;
    for (std::size_t i = 0; i < n_; ++i) {
      const double d = a[i] + t * (a[n_ + i] - a[i]) - point_[i];
      distance2 += d * d;
    }
    // At rest, rounding makes later samples no nearer.
    if (distance2 >= best_ - rounding2) return;
    best_ = distance2;
    at_ = static_cast<double>(k - 1) + t;
  }
  /// The place beside the nearest one that is as far from the block before the point as from the one after it. Samples
  /// before it are nearer to the one, samples after it to the other.
  /// @param last  sample up to which the motion may be on them
  double between(const double* from, const double* to, std::size_t last) const {
    const auto later = [&](double k) {  // by which it is farther from the block before, m^2
      const ProgramPoint x = point_of(k);
      return segment_distance2(from, point_, x.data(), n_) - segment_distance2(point_, to, x.data(), n_);
    };
    const double change = later(at_), way = change > 0.0 ? -1.0 : 1.0;
    if (std::abs(change) <= rounding2 || static_cast<double>(last) <= at_) return at_;
    double same = at_, other = at_;
    do {
      same = other;
      other = std::clamp(way > 0.0 ? std::floor(same) + 1.0 : std::ceil(same) - 1.0, least_, static_cast<double>(last));
      if (other == same) return at_;
    } while (way * later(other) < 0.0);
    for (int halvings = 0; halvings < 40; ++halvings) {
      const double middle = 0.5 * (same + other);
      (way * later(middle) < 0.0 ? same : other) = middle;
    }
    return other;
  }
  double at() const { return at_; }

 private:
  ProgramPoint point_of(double k) const {
    const auto floor = static_cast<std::size_t>(k);
    const double f = k - static_cast<double>(floor);
    const double* const a = motion_.position.data() + floor * n_;
    ProgramPoint x{};
    for (std::size_t i = 0; i < n_; ++i) x[i] = a[i] + (f > 0.0 ? f * (a[n_ + i] - a[i]) : 0.0);
    return x;
  }

  const FreeSamples& motion_;
  const double* point_;
  std::size_t n_;
  double least_, at_, best_ = unlimited;
};

/// The place at which a motion passes joint j. Under a contour, every sample has to be near its own block.
double pass_of(const NearestPlace& near, const Toolpath& path, std::size_t j, std::size_t last) {
  const bool bounded = path.contour_max < unlimited && path.joint[j] != Joint::stop;
  return bounded ? near.between(path.point(j), path.point(j + 2), last) : near.at();
}

/// The samples between which a filtered command may be at a joint.
struct Stay {
  std::size_t first = 0, last = 0;
};

/// Takes the joints of a stream of commands.
struct JointTimes {
  std::int64_t begin = 0, order = 0;
  std::vector<Stay> stays{};
  template <class Row>
  void command(const Row& /*u0*/, const Row& /*u*/, std::int64_t /*count*/, const Row& /*end*/) {}
  void joint(std::size_t /*block*/, double time, std::int64_t rest) {
    const std::int64_t reached = begin + static_cast<std::int64_t>(time);
    stays.push_back({static_cast<std::size_t>(reached), static_cast<std::size_t>(reached + rest + order + 2)});
  }
};

/// Those at the ends of the path's own blocks: steps of the feed split them, and their ends are copied. None if the
/// commands are those of another reading of the program.
std::optional<std::vector<Stay>> own_stays(const Toolpath& path, const Toolpath& commanded,
                                           const std::vector<Stay>& stays) {
  const std::size_t n = path.dimensions();
  std::vector<Stay> own;
  for (std::size_t b = 0; b < stays.size() && own.size() + 1 < path.blocks(); ++b) {
    const double* const end = path.point(own.size() + 1);
    if (std::equal(end, end + n, commanded.point(b + 1))) own.push_back(stays[b]);
  }
  if (own.size() + 1 != path.blocks()) return {};
  return own;
}

}  // namespace

FreeSamples sampled(const Toolpath& path, const Trajectory& trajectory, double sample_period) {
  const std::size_t n = path.dimensions();
  FreeSamples motion;
  motion.position.assign(path.point(0), path.point(0) + n);
  std::vector<std::int64_t> first{0}, last{0};
  ProfileMotion profile(path, trajectory.chain, sample_period, trajectory.last);
  while (profile.next()) {
    motion.position.insert(motion.position.end(), profile.position(), profile.position() + n);
    first.push_back(profile.place_first());
    last.push_back(profile.place_last());
  }
  // Joint j is passed by a step whose samples may lie on the legs beside it.
  const std::size_t count = first.size();
  double least = 0.0;
  for (std::size_t j = 0; j + 1 < path.blocks(); ++j) {
    const auto place = static_cast<std::int64_t>(j);
    NearestPlace pass(motion, path.point(j + 1), n, least);
    std::size_t end = 0;
    for (auto k = static_cast<std::size_t>(least) + 1;
         k < count && (std::min(first[k - 1], first[k]) + 1) / 2 <= place + 1; ++k) {
      if (last[k] / 2 >= place) pass.offer(k), end = k;
    }
    motion.passes.push_back(least = pass_of(pass, path, j, end));
  }
  return motion;
}

std::optional<FreeSamples> sampled(const Toolpath& path, const Plan& fixed, double sample_period) {
  const FilteredCommand& command = *fixed.command();
  const CommandTiming timing(fixed.path, sample_period, command.delays);
  JointTimes times{timing.dwell_samples(fixed.path.dwell_first), command.filter.order()};
  emit_commands(timing, 0, fixed.path.blocks() - 1, times);
  const auto stays = own_stays(path, fixed.path, times.stays);
  if (!stays) return {};
  FreeSamples motion;
  const auto n = static_cast<std::ptrdiff_t>(path.dimensions());
  Motion filtered(fixed, sample_period);
  for (Sample sample; filtered.next(sample);)
    motion.position.insert(motion.position.end(), sample.position.begin(), sample.position.begin() + n);
  const std::size_t last = motion.count(path.dimensions()) - 1;
  double least = 0.0;
  for (std::size_t j = 0; j < stays->size(); ++j) {
    NearestPlace pass(motion, path.point(j + 1), path.dimensions(), least);
    const Stay& stay = (*stays)[j];
    const std::size_t end = std::min(stay.last, last);
    for (std::size_t k = std::max(stay.first, static_cast<std::size_t>(least)) + 1; k <= end; ++k) pass.offer(k);
    motion.passes.push_back(least = pass_of(pass, path, j, end));
  }
  return motion;
}

}  // namespace accdec
