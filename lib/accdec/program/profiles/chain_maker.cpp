#include <algorithm>
#include <cmath>

#include <accdec/program/profiles/chain_maker.hpp>
#include <accdec/program/profiles/profile_corner.hpp>

namespace accdec {

ChainMaker::ChainMaker(const Toolpath& path, const AvailableAcceleration& available)
    : path_(path), available_(available), n_(path.dimensions()) {
  const std::size_t blocks = path.blocks();
  chain_.levels = available.depends_on_speed() ? 16 : 1;
  chain_.length.resize(blocks);
  chain_.feed.resize(blocks);
  chain_.ramp.resize(blocks * levels());
  chain_.speed_max.assign(blocks + 1, 0.0);
  chain_.stretch.assign(blocks + 1, 0.0);
  chain_.coast.assign(blocks + 1, 0.0);
  units_.resize(blocks * n_);
  for (std::size_t b = 0; b < blocks; ++b) measure(b);
  // Between speeding up and braking an axis would change its acceleration by twice what it has.
  for (std::size_t a = 0; a < n_; ++a) {
    if (2.0 * available.of_axis(a, 0.0) > available.swing(a) * (1.0 + 1e-9)) chain_.peak_coast = available.window();
  }
}

const ProfileChain& ChainMaker::make(const ProfileShares& shares) {
  const std::size_t blocks = path_.blocks();
  for (std::size_t b = 0; b < blocks; ++b) set_ramp(b, static_cast<double>(shares.acceleration[2 * b]));
  for (std::size_t c = 1; c < blocks; ++c) {
    if (path_.joint[c - 1] == Joint::stop) continue;
    set_corner(c, static_cast<double>(shares.acceleration[2 * c - 1]), static_cast<double>(shares.speed[c]));
  }
  look_ahead(chain_);
  return chain_;
}

bool ChainMaker::remake(const ProfileShares& shares, std::size_t first, std::size_t last) {
  for (std::size_t b = first; b <= last; ++b) set_ramp(b, static_cast<double>(shares.acceleration[2 * b]));
  for (std::size_t c = first + 1; c <= last; ++c) {
    if (path_.joint[c - 1] == Joint::stop) continue;
    set_corner(c, static_cast<double>(shares.acceleration[2 * c - 1]), static_cast<double>(shares.speed[c]));
  }
  const auto part = [](const std::vector<double>& values, std::size_t from, std::size_t end) {
    return std::vector<double>(values.begin() + static_cast<std::ptrdiff_t>(from),
                               values.begin() + static_cast<std::ptrdiff_t>(end));
  };
  ProfileChain slice;
  slice.levels = chain_.levels;
  slice.peak_coast = chain_.peak_coast;
  slice.length = part(chain_.length, first, last + 1);
  slice.feed = part(chain_.feed, first, last + 1);
  slice.ramp = part(chain_.ramp, first * levels(), (last + 1) * levels());
  slice.speed_max = part(chain_.speed_max, first, last + 2);
  slice.stretch = part(chain_.stretch, first, last + 2);
  slice.coast = part(chain_.coast, first, last + 2);
  const double at_first = slice.speed_max.front() = chain_.speed[first];
  const double at_last = slice.speed_max.back() = chain_.speed[last + 1];
  look_ahead(slice);
  if (slice.speed.front() < at_first * (1.0 - 1e-12) || slice.speed.back() < at_last * (1.0 - 1e-12)) return false;
  std::copy(slice.speed.begin() + 1, slice.speed.end() - 1,
            chain_.speed.begin() + static_cast<std::ptrdiff_t>(first) + 1);
  std::copy(slice.peak.begin(), slice.peak.end(), chain_.peak.begin() + static_cast<std::ptrdiff_t>(first));
  return true;
}

void ChainMaker::measure(std::size_t b) {
  const double* p = path_.point(b);
  double length2 = 0.0;
  for (std::size_t a = 0; a < n_; ++a) length2 += (p[n_ + a] - p[a]) * (p[n_ + a] - p[a]);
  const double length = std::sqrt(length2);
  for (std::size_t a = 0; a < n_; ++a) units_[b * n_ + a] = (p[n_ + a] - p[a]) / length;
  chain_.length[b] = length;
  chain_.feed[b] = available_.feed(unit(b), n_, length / path_.duration[b]);
}

void ChainMaker::set_ramp(std::size_t b, double share) {
  for (std::size_t k = 0; k < levels(); ++k) {
    const double speed = chain_.feed[b] * static_cast<double>(k + 1) / chain_.levels;
    chain_.ramp[b * levels() + k] = share * available_.along(unit(b), n_, speed);
  }
}

void ChainMaker::set_corner(std::size_t c, double acceleration, double speed) {
  ProfileLegs legs;
  legs.in = unit(c - 1);
  legs.out = unit(c);
  legs.ramp_in = chain_.ramp[(c - 1) * levels()];
  legs.ramp_out = chain_.ramp[c * levels()];
  legs.feed = std::min(chain_.feed[c - 1], chain_.feed[c]);
  legs.room = std::min(chain_.length[c - 1], chain_.length[c]);
  legs.tolerance = path_.tolerance[c - 1];
  legs.scale = acceleration;
  const CornerPass pass = corner_pass(available_, n_, legs);
  chain_.speed_max[c] = pass.speed_max * speed;
  chain_.stretch[c] = pass.stretch;
  chain_.coast[c] = pass.coast;
}

}  // namespace accdec
