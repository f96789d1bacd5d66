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

}  // namespace

ProfileMotion::ProfileMotion(const Toolpath& path, const ProfileChain& chain, double sample_period, const Filter& last)
    : ProfileMotion(path, chain, sample_period, last, 0, path.blocks() - 1, sample_period) {}

ProfileMotion::ProfileMotion(const Toolpath& path, const ProfileChain& chain, double sample_period, const Filter& last,
                             std::size_t first_leg, std::size_t last_leg, double first_sample)
    : path_(path),
      chain_(chain),
      period_(sample_period),
      last_(last),
      taps_(last.order() + 1),
      n_(path.dimensions()),
      leg_(first_leg),
      last_leg_(last_leg),
      place_(2 * static_cast<std::int64_t>(first_leg)) {
  for (const double tap : last.taps()) equal_ = equal_ && tap == last.tap(0);
  leg_pieces(first_leg);
  std::copy_n(path.point(first_leg), n_, raw_.begin());
  if (first_leg > 0 && !pieces_.empty()) raw_ = pieces_.front().x;
  out_ = raw_;
  if (taps_ > 1) {
    ring_.resize(static_cast<std::size_t>(taps_) * n_);
    places_.assign(static_cast<std::size_t>(taps_), place_);
    for (std::size_t i = 0; i < ring_.size(); ++i) ring_[i] = raw_[i % n_];
    for (std::size_t a = 0; a < n_; ++a) sum_[a] = static_cast<long double>(raw_[a]) * taps_;
  }
  while (dwell_ < path.dwell.size() && path.dwell[dwell_].first < first_leg) ++dwell_;
  if (first_leg == 0) rest_ = whole_samples(path.dwell_first / period_);
  time_ = first_sample;
}

void ProfileMotion::direction(std::size_t b, double* u) const {
  const double* p = path_.point(b);
  for (std::size_t a = 0; a < n_; ++a) u[a] = (p[n_ + a] - p[a]) / chain_.length[b];
}

void ProfileMotion::leg_piece(std::size_t b, double& way, double speed, double acceleration, double duration,
                              const double* u) {
  if (!(duration > 0.0)) return;
  Piece& piece = pieces_.emplace_back();
  piece.duration = duration;
  for (std::size_t a = 0; a < n_; ++a) {
    piece.x[a] = path_.point(b)[a] + u[a] * way;
    piece.v[a] = u[a] * speed;
    piece.a[a] = u[a] * acceleration;
  }
  way += (speed + 0.5 * acceleration * duration) * duration;
}

/// From one speed to another, one piece for every level between them.
void ProfileMotion::ramp_pieces(std::size_t b, double from, double to, double& way, const double* u) {
  const double width = chain_.feed[b] / chain_.levels, low = std::min(from, to), high = std::max(from, to);
  for (int i = 0; i < chain_.levels; ++i) {
    const int k = from < to ? i : chain_.levels - 1 - i;
    const double bottom = std::max(low, k * width),
                 top = k + 1 == chain_.levels ? high : std::min(high, (k + 1) * width);
    if (!(top > bottom)) continue;
    const double rate = chain_.ramp[b * static_cast<std::size_t>(chain_.levels) + static_cast<std::size_t>(k)];
    leg_piece(b, way, from < to ? bottom : top, from < to ? rate : -rate, (top - bottom) / rate, u);
  }
}

void ProfileMotion::leg_pieces(std::size_t b) {
  pieces_.clear();
  piece_ = 0;
  std::array<double, program_axis_count> u{};
  direction(b, u.data());
  const double first = chain_.speed[b], last = chain_.speed[b + 1], peak = chain_.peak[b];
  const double ramps = 2.0 * chain_.way(b, peak) - chain_.way(b, first) - chain_.way(b, last);
  const double steady = chain_.length[b] - chain_.taken(b, first) - chain_.taken(b + 1, last) - ramps;
  double way = chain_.taken(b, first) - chain_.coast[b] * first;
  leg_piece(b, way, first, 0.0, chain_.coast[b], u.data());
  ramp_pieces(b, first, peak, way, u.data());
  if (peak > 0.0) leg_piece(b, way, peak, 0.0, steady / peak, u.data());
  ramp_pieces(b, peak, last, way, u.data());
  leg_piece(b, way, last, 0.0, chain_.coast[b + 1], u.data());
}

void ProfileMotion::corner_piece(std::size_t c) {
  pieces_.clear();
  piece_ = 0;
  const double v = chain_.speed[c], tau = chain_.stretch[c] * v;
  if (!(tau > 0.0)) return;
  std::array<double, program_axis_count> in{}, out{};
  direction(c - 1, in.data());
  direction(c, out.data());
  Piece& piece = pieces_.emplace_back();
  piece.duration = tau;
  for (std::size_t a = 0; a < n_; ++a) {
    piece.x[a] = path_.point(c)[a] - in[a] * 0.5 * v * tau;
    piece.v[a] = in[a] * v;
    piece.a[a] = (out[a] - in[a]) / chain_.stretch[c];
  }
}

/// Rests in corner c: from the next sample on, until the last filter is empty and dwells are over.
void ProfileMotion::arrive(std::size_t c) {
  std::copy_n(path_.point(c), n_, raw_.begin());
  rest_ = taps_;
  for (; dwell_ < path_.dwell.size() && path_.dwell[dwell_].first < c; ++dwell_) {
    rest_ += whole_samples(path_.dwell[dwell_].second / period_);
  }
  done_ = c == path_.blocks();
}

void ProfileMotion::begin_leg(std::size_t b) {
  leg_ = b;
  leg_pieces(b);
  place_ = 2 * static_cast<std::int64_t>(b);
  if (phases_) (*phases_)[b] = time_;
}

void ProfileMotion::note_phases(std::vector<double>& phases) {
  phases_ = &phases;
  phases[leg_] = time_;
}

/// Whether the piece driven is the last one before a stop.
bool ProfileMotion::ends_at_stop() const {
  return piece_ + 1 == pieces_.size() && !in_corner_ && chain_.stops(leg_ + 1);
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
  while (piece_ == pieces_.size() || time_ > pieces_[piece_].duration - (ends_at_stop() ? almost * period_ : 0.0)) {
    if (piece_ < pieces_.size()) {
      time_ -= pieces_[piece_++].duration;
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
      corner_piece(leg_ + 1);
      continue;
    }
    arrive(leg_ + 1);
    --rest_;
    if (done_) return true;
    time_ = period_;
    begin_leg(leg_ + 1);
    return true;
  }
  const Piece& piece = pieces_[piece_];
  for (std::size_t a = 0; a < n_; ++a) raw_[a] = piece.x[a] + (piece.v[a] + 0.5 * piece.a[a] * time_) * time_;
  time_ += period_;
  return true;
}

void ProfileMotion::smooth() {
  double* row = ring_.data() + slot_ * n_;
  for (std::size_t a = 0; a < n_; ++a) {
    if (equal_) sum_[a] += static_cast<long double>(raw_[a]) - static_cast<long double>(row[a]);
    row[a] = raw_[a];
  }
  places_[slot_] = place_;
  const std::size_t newest = slot_, count = static_cast<std::size_t>(taps_);
  slot_ = slot_ + 1 == count ? 0 : slot_ + 1;
  if (!equal_) return convolve(newest);
  if (slot_ == 0) {
    // Summed again once per round, so that rounding does not add up.
    for (std::size_t a = 0; a < n_; ++a) {
      sum_[a] = 0.0L;
      for (std::size_t i = a; i < ring_.size(); i += n_) sum_[a] += static_cast<long double>(ring_[i]);
    }
  }
  for (std::size_t a = 0; a < n_; ++a) out_[a] = static_cast<double>(sum_[a] / taps_);
}

/// The newest sample and the distances of the others from it; this rounds less than a sum of positions.
void ProfileMotion::convolve(std::size_t newest) {
  const std::size_t count = static_cast<std::size_t>(taps_);
  std::array<double, program_axis_count> sum{};
  const double* tap = last_.taps().data();
  for (std::size_t i = 0, at = newest; i < count; ++i, at = at == 0 ? count - 1 : at - 1) {
    if (tap[i] == 0.0) continue;
    for (std::size_t a = 0; a < n_; ++a) sum[a] += tap[i] * (ring_[at * n_ + a] - raw_[a]);
  }
  for (std::size_t a = 0; a < n_; ++a) out_[a] = raw_[a] + sum[a];
}

std::int64_t ProfileMotion::pass_rest() {
  if (stood_ < taps_ + 4 || rest_ == 0) return 0;
  return std::exchange(rest_, 1) - 1;
}

bool ProfileMotion::next() {
  if (!raw()) return false;
  if (taps_ > 1) {
    smooth();
  } else {
    out_ = raw_;
  }
  return true;
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
