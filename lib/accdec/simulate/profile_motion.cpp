#include <algorithm>
#include <cmath>
#include <utility>

#include <accdec/simulate/command_stream.hpp>
#include <accdec/simulate/profile_motion.hpp>

namespace accdec {
namespace {

/// The motion counts as arrived if less than this part of a sample is missing. So close to rest, this is less than the
/// rounding of a position.
constexpr double almost = 1e-5;

/// Samples made at once.
constexpr std::int64_t run_max = 256;

/// m, of the points of legs first .. last.
double largest_coordinate(const Toolpath& path, std::size_t first, std::size_t last) {
  const std::size_t n = path.dimensions();
  double largest = 0.0;
  for (const double *x = path.point(first), *end = path.point(last + 1) + n; x != end; ++x)
    largest = std::max(largest, std::abs(*x));
  return largest;
}

}  // namespace

ProfileMotion::ProfileMotion(const Toolpath& path, const ProfileChain& chain, double sample_period, const Filter& last)
    : ProfileMotion(path, chain, sample_period, last, 0, path.blocks() - 1, sample_period) {}

ProfileMotion::ProfileMotion(const Toolpath& path, const ProfileChain& chain, double sample_period, const Filter& last,
                             std::size_t first_leg, std::size_t last_leg, double first_sample)
    : path_(path),
      chain_(chain),
      period_(sample_period),
      pieces_(path, chain),
      leg_(first_leg),
      last_leg_(last_leg),
      place_(2 * static_cast<std::int64_t>(first_leg)),
      raw_(start(first_leg)),
      out_(raw_),
      smoother_(last, path.dimensions(), raw_, place_, largest_coordinate(path, first_leg, last_leg)) {
  while (dwell_ < path.dwell.size() && path.dwell[dwell_].first < first_leg) ++dwell_;
  if (first_leg == 0) rest_ = whole_samples(path.dwell_first / period_);
  time_ = first_sample;
}

/// The point where the motion rests before its first sample.
ProfileMotion::Point ProfileMotion::start(std::size_t first_leg) {
  pieces_.begin_leg(first_leg);
  Point at{};
  if (first_leg > 0 && !pieces_.over()) {
    for (std::size_t a = 0; a < path_.dimensions(); ++a) at[a] = pieces_.now().at(a, 0.0);
    return at;
  }
  std::copy_n(path_.point(first_leg), path_.dimensions(), at.begin());
  return at;
}

/// Rests in corner c: from the next sample on, until the last filter is empty and dwells are over.
void ProfileMotion::arrive(std::size_t c) {
  std::copy_n(path_.point(c), path_.dimensions(), raw_.begin());
  rest_ = smoother_.taps();
  for (; dwell_ < path_.dwell.size() && path_.dwell[dwell_].first < c; ++dwell_) {
    rest_ += whole_samples(path_.dwell[dwell_].second / period_);
  }
  done_ = c == path_.blocks();
}

void ProfileMotion::begin_leg(std::size_t b) {
  leg_ = b;
  ran_ = 0;
  pieces_.begin_leg(b);
  place_ = 2 * static_cast<std::int64_t>(b);
  if (phases_) (*phases_)[b] = time_;
}

void ProfileMotion::note_phases(std::vector<double>& phases) {
  phases_ = &phases;
  phases[leg_] = time_;
}

/// No sample of the piece is later, s.
double ProfileMotion::piece_end() const {
  const bool stop = pieces_.last() && !in_corner_ && chain_.stops(leg_ + 1);
  return pieces_.now().duration - (stop ? almost * period_ : 0.0);
}

/// The next sample of the motion before the last filter, into raw_.
bool ProfileMotion::raw() {
  if (rest_ > 0) {
    --rest_;
    ++stood_;
    return true;
  }
  stood_ = 0;
  if (done_) return false;
  while (pieces_.over() || time_ > piece_end()) {
    if (!pieces_.over()) {
      time_ -= pieces_.now().duration;
      pieces_.go_on();
      ran_ = 0;
      continue;
    }
    if (in_corner_) {
      in_corner_ = false;
      begin_leg(leg_ + 1);
      continue;
    }
    if (leg_ == last_leg_ && last_leg_ + 1 < path_.blocks()) return false;
    ++place_;
    if (!chain_.stops(leg_ + 1)) {
      in_corner_ = true;
      ran_ = 0;
      pieces_.begin_corner(leg_ + 1);
      continue;
    }
    arrive(leg_ + 1);
    --rest_;
    if (done_) return true;
    time_ = period_;
    begin_leg(leg_ + 1);
    return true;
  }
  const MotionPiece& piece = pieces_.now();
  for (std::size_t a = 0, n = path_.dimensions(); a < n; ++a) raw_[a] = piece.at(a, time_);
  time_ += period_;
  ran_ = piece.steady ? ran_ + 1 : 0;
  return true;
}

std::int64_t ProfileMotion::pass_steady() {
  const std::int64_t seen = this->seen();
  if (rest_ > 0) return stood_ < seen ? 0 : std::exchange(rest_, 1) - 1;
  if (ran_ < seen || pieces_.over()) return 0;
  // The last ones fill the filter again, so that what follows is made of the same samples.
  const double left = std::floor((pieces_.now().duration - time_) / period_) - 2.0 - static_cast<double>(seen);
  if (left < static_cast<double>(seen)) return 0;
  time_ += left * period_;
  for (std::int64_t k = 0; k < seen; ++k) next();
  return static_cast<std::int64_t>(left) + seen;
}

bool ProfileMotion::next() {
  if (!raw()) return false;
  smoother_.next(raw_, place_, out_);
  return true;
}

std::int64_t ProfileMotion::next_run(const std::array<double*, program_axis_count>& rows, std::int64_t* places_first,
                                     std::int64_t most) {
  if (rest_ > 0 || done_ || pieces_.over()) return 0;
  const MotionPiece& piece = pieces_.now();
  if (piece.steady && ran_ < seen()) most = std::min(most, seen() - ran_);
  std::array<double, run_max> times;
  const double end = piece_end();
  std::int64_t count = 0;
  for (most = std::min(most, run_max); count < most && time_ <= end; time_ += period_)
    times[static_cast<std::size_t>(count++)] = time_;
  if (count == 0) return 0;
  stood_ = 0;
  for (std::size_t a = 0, n = path_.dimensions(); a < n; ++a) {
    for (std::int64_t k = 0; k < count; ++k) rows[a][k] = piece.at(a, times[static_cast<std::size_t>(k)]);
  }
  smoother_.next_run(rows, count, place_, places_first);
  for (std::size_t a = 0, n = path_.dimensions(); a < n; ++a) out_[a] = rows[a][count - 1];
  ran_ = piece.steady ? ran_ + count : 0;
  return count;
}

double chain_time(const ProfileChain& chain) {
  return chain_time(chain, 0, chain.legs());
}

double chain_time(const ProfileChain& chain, std::size_t first_leg, std::size_t end) {
  double time = 0.0;
  for (std::size_t b = first_leg; b < end; ++b) {
    const double first = chain.speed[b], last = chain.speed[b + 1], peak = chain.peak[b];
    const double ramps = 2.0 * chain.way(b, peak) - chain.way(b, first) - chain.way(b, last);
    const double steady = chain.length[b] - chain.taken(b, first) - chain.taken(b + 1, last) - ramps;
    time += chain.coast[b] + chain.coast[b + 1] + chain.stretch[b + 1] * last;
    if (peak > 0.0) time += std::max(0.0, steady) / peak;
    if (chain.levels == 1) {
      time += (2.0 * peak - first - last) / chain.ramp[b];
      continue;
    }
    const double width = chain.feed[b] / chain.levels;
    for (int k = 0; k < chain.levels; ++k) {
      const double low = k * width, high = k + 1 == chain.levels ? peak : std::min(peak, (k + 1) * width);
      const double rate = chain.ramp[b * static_cast<std::size_t>(chain.levels) + static_cast<std::size_t>(k)];
      for (const double from : {first, last}) {
        if (high > std::max(low, from)) time += (high - std::max(low, from)) / rate;
      }
    }
  }
  return time;
}

}  // namespace accdec
