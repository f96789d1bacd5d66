#include <algorithm>
#include <cmath>
#include <utility>

#include <accdec/plan/trajectory/chain_maker.hpp>
#include <accdec/plan/trajectory/look_ahead.hpp>
#include <accdec/plan/trajectory/profile_corner.hpp>
#include <accdec/simulate/profile_motion.hpp>

namespace accdec {
namespace {

/// `copy(values of the chain, values of the part, index in the chain)` for everything that a chain has of its legs and
/// corners.
template <class Chain, class Part, class Copy>
void with_parts(Chain& chain, Part& part, std::size_t first, const Copy& copy) {
  copy(chain.length, part.length, first);
  copy(chain.feed, part.feed, first);
  copy(chain.ramp, part.ramp, first * static_cast<std::size_t>(chain.levels));
  copy(chain.speed_max, part.speed_max, first);
  copy(chain.stretch, part.stretch, first);
  copy(chain.coast, part.coast, first);
  copy(chain.speed, part.speed, first);
  copy(chain.peak, part.peak, first);
}

/// Legs first .. last with the corners at both ends.
ProfileChain part_of(const ProfileChain& chain, std::size_t first, std::size_t last) {
  ProfileChain part;
  part.levels = chain.levels;
  part.peak_coast = chain.peak_coast;
  const std::size_t legs = last - first + 1;
  for (auto* values : {&part.length, &part.feed, &part.peak}) values->resize(legs);
  for (auto* values : {&part.speed_max, &part.stretch, &part.coast, &part.speed}) values->resize(legs + 1);
  part.ramp.resize(legs * static_cast<std::size_t>(chain.levels));
  with_parts(chain, part, first, [](const auto& from, auto& to, std::size_t at) {
    std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(at), to.size(), to.begin());
  });
  return part;
}

/// Puts a part in its place; for the corners at its ends the chain keeps its values.
void put_part(const ProfileChain& part, std::size_t first, ProfileChain& chain) {
  const double ends[] = {chain.speed_max[first], chain.speed_max[first + part.legs()]};
  with_parts(chain, part, first, [](auto& to, const auto& from, std::size_t at) {
    std::copy(from.begin(), from.end(), to.begin() + static_cast<std::ptrdiff_t>(at));
  });
  chain.speed_max[first] = ends[0];
  chain.speed_max[first + part.legs()] = ends[1];
}

bool keeps_ends(const ProfileChain& part) {
  return part.speed.front() >= part.speed_max.front() * (1.0 - 1e-12) &&
         part.speed.back() >= part.speed_max.back() * (1.0 - 1e-12);
}

/// The first leg after the last stop, with which the part may begin.
std::size_t after_last_stop(const ProfileChain& part) {
  std::size_t from = part.legs();
  while (from > 0 && !part.stops(from)) --from;
  return from;
}

/// The same, with the speeds of corners and the peaks of legs from `from` on lower by `less` of them.
/// @param tapered  by nothing at both ends and by that in the middle third: short legs at the ends may leave no room
/// for
///                 a change of speed
ProfileChain slowed(const ProfileChain& part, std::size_t from, double less, bool tapered) {
  ProfileChain slow = part;
  const auto legs = static_cast<double>(part.legs() - from);
  const auto share = [&](double behind) {
    return 1.0 - less * (tapered ? std::min(1.0, 3.0 * std::min(behind, legs - behind) / legs) : 1.0);
  };
  for (std::size_t c = from + 1; c < part.legs(); ++c) {
    slow.speed_max[c] = share(static_cast<double>(c - from)) * part.speed[c];
  }
  look_ahead(slow);
  for (std::size_t b = from; b < part.legs(); ++b) {
    const double peak = share(static_cast<double>(b - from) + 0.5) * part.peak[b];
    slow.peak[b] = std::max({slow.speed[b], slow.speed[b + 1], std::min(slow.peak[b], peak)});
  }
  return slow;
}

constexpr double exact = 1e-9;            // of a sample
constexpr double less_max = 0.3;          // of a speed, that a part may lose
constexpr std::size_t very_many = 50000;  // legs

/// Slows legs from `from` on until they take so much more, s. False if too little can be slowed without changing the
/// speeds at the ends.
bool take_longer(ProfileChain& part, std::size_t from, double more, double period, bool tapered) {
  const double time = chain_time(part, from, part.legs());
  // Finds how much less by false position, because the time rises nearly linearly with it.
  double low = 0.0, high = std::min(less_max, 2.0 * more / time), below = -more, above = 0.0;
  while (true) {
    const ProfileChain slow = slowed(part, from, high, tapered);
    if (!keeps_ends(slow)) return false;
    above = chain_time(slow, from, slow.legs()) - time - more;
    if (above >= 0.0) break;
    if (high == less_max) return false;
    low = std::exchange(high, std::min(less_max, 2.0 * high));
    below = above;
  }
  for (int i = 0; i < 80; ++i) {
    const double less = i % 3 == 2 ? 0.5 * (low + high) : low - (high - low) * below / (above - below);
    ProfileChain slow = slowed(part, from, less, tapered);
    const double off = chain_time(slow, from, slow.legs()) - time - more;
    if (std::abs(off) < exact * period) {
      if (!keeps_ends(slow)) return false;
      part.speed = std::move(slow.speed);
      part.peak = std::move(slow.peak);
      return true;
    }
    (off > 0.0 ? high : low) = less;
    (off > 0.0 ? above : below) = off;
  }
  return false;
}

/// The same, until they take `wanted` and a whole number of samples.
/// @param quick  a part with little room does, too. Longer parts are a little faster on curves. Those with much room
/// may
///               have thousands of legs, and a program of very many legs has no time for them.
bool take_whole_samples(ProfileChain& part, std::size_t from, double wanted, double period, bool quick) {
  double more = (wanted - chain_time(part, from, part.legs())) / period;
  more -= std::floor(more);
  if (more < exact || more > 1.0 - exact) return true;
  more *= period;
  if (quick) return take_longer(part, from, more, period, true);
  return keeps_ends(slowed(part, from, less_max, false)) && take_longer(part, from, more, period, false);
}

}  // namespace

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
  corners_.resize(blocks);
  for (std::size_t b = 0; b < blocks; ++b) measure(b);
  // Between speeding up and braking, an axis would change its acceleration by twice its limit.
  for (std::size_t a = 0; a < n_; ++a) {
    if (2.0 * available.of_axis(a, 0.0) > available.swing(a) * (1.0 + 1e-9)) chain_.peak_coast = available.window();
  }
}

const ProfileChain& ChainMaker::make(const ProfileShares& shares) {
  set_part(shares, 0, path_.blocks() - 1);
  look_ahead(chain_);
  return chain_;
}

void ChainMaker::set_part(const ProfileShares& shares, std::size_t first, std::size_t last) {
  for (std::size_t b = first; b <= last; ++b) set_ramp(b, static_cast<double>(shares.acceleration[2 * b]));
  for (std::size_t c = first + 1; c <= last; ++c) {
    if (path_.joint[c - 1] == Joint::stop) continue;
    set_corner(c, shares);
  }
}

bool ChainMaker::remake(const ProfileShares& shares, std::size_t first, std::size_t last,
                        const std::vector<double>& phases) {
  const ProfileChain before = part_of(chain_, first, last);
  set_part(shares, first, last);
  ProfileChain part = part_of(chain_, first, last);
  part.speed_max.front() = before.speed.front();
  part.speed_max.back() = before.speed.back();
  look_ahead(part);
  bool made = keeps_ends(part);
  if (made && last + 1 < path_.blocks() && !part.stops(part.legs())) {
    const std::size_t from = after_last_stop(part);
    const double begins = from > 0 ? available_.period() : phases[first];
    made = take_whole_samples(part, from, begins - phases[last + 1], available_.period(), chain_.legs() > very_many);
  }
  put_part(made ? part : before, first, chain_);
  if (!made) std::fill_n(corners_.begin() + static_cast<std::ptrdiff_t>(first) + 1, last - first, Corner{});
  return made;
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

void ChainMaker::set_corner(std::size_t c, const ProfileShares& shares) {
  const float* const share = shares.acceleration.data() + 2 * c - 2;
  const auto speed = static_cast<double>(shares.speed[c]);
  Corner& known = corners_[c];
  if (known.before == share[0] && known.at == share[1] && known.after == share[2]) {
    chain_.speed_max[c] = known.speed * speed;
    return;
  }
  ProfileLegs legs;
  legs.in = unit(c - 1);
  legs.out = unit(c);
  legs.ramp_in = chain_.ramp[(c - 1) * levels()];
  legs.ramp_out = chain_.ramp[c * levels()];
  legs.feed = std::min(chain_.feed[c - 1], chain_.feed[c]);
  legs.room = std::min(chain_.length[c - 1], chain_.length[c]);
  legs.tolerance = path_.tolerance[c - 1];
  legs.scale = static_cast<double>(share[1]);
  const CornerPass pass = corner_pass(available_, n_, legs);
  chain_.speed_max[c] = pass.speed_max * speed;
  chain_.stretch[c] = pass.stretch;
  chain_.coast[c] = pass.coast;
  known = {share[0], share[1], share[2], pass.speed_max};
}

}  // namespace accdec
