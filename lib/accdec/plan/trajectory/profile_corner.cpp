#include <algorithm>
#include <cmath>
#include <optional>

#include <accdec/plan/trajectory/profile_corner.hpp>

namespace accdec {
namespace {

/// tau/v that the axes' accelerations require at speed v.
double stretch_at(const AvailableAcceleration& available, std::size_t dimensions, const ProfileLegs& legs, double v) {
  double stretch = 0.0;
  for (std::size_t a = 0; a < dimensions; ++a) {
    const double step = std::abs(legs.out[a] - legs.in[a]);
    if (step == 0.0) continue;
    const double speed = v * std::max(std::abs(legs.in[a]), std::abs(legs.out[a]));
    stretch = std::max(stretch, step / (legs.scale * available.of_axis(a, speed)));
  }
  return stretch;
}

/// The largest x in [0, high] for which excess(x) <= 0, to a millionth of `high` below it. The excess grows.
/// @param below, above  of 0 and of `high`: <= 0 and > 0
template <class Excess>
double largest_holding(double high, double below, double above, const Excess& excess) {
  double low = 0.0;
  const double exact = 1e-6 * high;
  double aside = -0.4 * exact;  // from the root, to the side that is farther from it
  for (int i = 0; high - low > exact; ++i) {
    const double root = i % 3 == 2 ? 0.5 * (low + high) : low + (high - low) * below / (below - above) + aside;
    const double x = std::clamp(root, low + 0.1 * exact, high - 0.1 * exact), value = excess(x);
    const bool holds = value <= 0.0;
    (holds ? low : high) = x;
    (holds ? below : above) = value;
    aside = holds ? 0.4 * exact : -0.4 * exact;
  }
  return low;
}

/// How long the motion must be steady on both sides, between braking before the corner, the corner and speeding up
/// after it. Then no axis changes its acceleration by more than its swing within the window.
double least_coast(const AvailableAcceleration& available, std::size_t dimensions, const ProfileLegs& legs,
                   double stretch) {
  bool beside = false, across = false;
  for (std::size_t a = 0; a < dimensions; ++a) {
    const double swing = available.swing(a) * (1.0 + 1e-9);
    if (!(swing < unlimited)) continue;
    const double before = -legs.ramp_in * legs.in[a], after = legs.ramp_out * legs.out[a];
    const double inside = stretch > 0.0 ? (legs.out[a] - legs.in[a]) / stretch : 0.0;
    beside = beside || std::abs(inside - before) > swing || std::abs(after - inside) > swing;
    across = across || std::abs(after - before) > swing;
  }
  return beside ? available.window() : across ? 0.5 * available.window() : 0.0;
}

/// The corner at the largest speed with which it holds its tolerance; none if not even at rest.
class CornerSearch {
 public:
  CornerSearch(const AvailableAcceleration& available, std::size_t dimensions, const ProfileLegs& legs, double n)
      : available_(available),
        dimensions_(dimensions),
        legs_(legs),
        n_(n),
        ramp_(std::max(legs.ramp_in, legs.ramp_out)),
        reached_(std::min(legs.feed, std::sqrt(ramp_ * legs.room))) {}

  double stretch(double v) const { return stretch_at(available_, dimensions_, legs_, v); }
  double tolerance(double stretch) const {
    return legs_.tolerance - n_ / stretch * available_.period() * available_.period() / 8.0;
  }
  /// m, of the distance above the tolerance.
  double excess(double v, double stretch, double coast) const {
    return corner_distance(n_, v, stretch * v, available_.last(), ramp_, coast) - tolerance(stretch);
  }
  /// @param known  a pass: none that loses more is of use
  std::optional<CornerPass> with_coast(double coast, const std::optional<CornerPass>& known) const {
    CornerPass pass{legs_.feed, stretch(legs_.feed), coast};
    if (known && loses_more(pass, lost(*known))) return std::nullopt;
    const double above = excess(pass.speed_max, pass.stretch, coast);
    if (above <= 0.0) return pass;
    const double below = excess(0.0, pass.stretch, coast);
    if (below > 0.0) return std::nullopt;
    if (!available_.depends_on_speed() && available_.window() == 0.0) {
      pass.speed_max = std::sqrt(std::max(0.0, 8.0 * tolerance(pass.stretch) / (n_ * pass.stretch)));
      return pass;
    }
    const bool one = !available_.depends_on_speed();
    const double v = largest_holding(legs_.feed, below, above,
                                     [&](double x) { return excess(x, one ? pass.stretch : stretch(x), coast); });
    return CornerPass{v, stretch(v), coast};
  }
  /// Time that the corner costs compared with passing it at the speed that the legs reach, s.
  double lost(const CornerPass& pass) const {
    const double feed = reached(), v = std::min(pass.speed_max, feed);
    return (feed - v) * (feed - v) / (ramp_ * feed) + (pass.stretch * v + 2.0 * pass.coast) * (1.0 - v / feed);
  }
  /// About the speed that the legs reach.
  double reached() const { return reached_; }

 private:
  /// Whether a pass with this stretch and coast certainly loses more than `least`. In v, lost() is a parabola with a
  /// root at the speed reached. If it is larger at 0, only speeds above its other crossing lose less.
  bool loses_more(const CornerPass& pass, double least) const {
    if (available_.depends_on_speed()) return false;
    // lost(f - x) f = x (p - q x)
    const double p = pass.stretch * reached_ + 2.0 * pass.coast, q = pass.stretch - 1.0 / ramp_;
    if (!(reached_ * (p - q * reached_) > least * reached_ * (1.0 + 1e-9))) return false;
    const double root = std::sqrt(std::max(0.0, p * p - 4.0 * q * least * reached_));
    const double x = 2.0 * least * reached_ / (p + root);
    return excess(reached_ - x * (1.0 + 1e-9), pass.stretch, pass.coast) > 0.0;
  }

  const AvailableAcceleration& available_;
  std::size_t dimensions_;
  const ProfileLegs& legs_;
  double n_, ramp_, reached_;
};

/// The fastest of several lengths of coasting, from the least that the swing allows. @param known  see with_coast
std::optional<CornerPass> best_coast(const AvailableAcceleration& available, std::size_t dimensions,
                                     const ProfileLegs& legs, const CornerSearch& search, double window,
                                     const std::optional<CornerPass>& known = {}) {
  const double stretch = search.stretch(legs.feed), most = 0.5 * window;
  double least = window > 0.0 ? least_coast(available, dimensions, legs, stretch) : 0.0;
  // If the legs are too short for coasting, the acceleration is lowered later where it changes too fast.
  if (4.0 * least * search.reached() > legs.room) least = 0.0;
  // Longer coasting keeps the ramps out of the last boxcar, so the corner can be faster. At rest it is the delay
  // between both legs.
  const auto at_rest = [&](double coast) { return search.excess(0.0, stretch, coast); };
  if (const double above = least < most ? at_rest(least) : 0.0; above > 0.0) {
    // Longer coasting leaves less of the distance.
    const double below = at_rest(most);
    if (below <= 0.0)
      least = most - largest_holding(most - least, below, above, [&](double x) { return at_rest(most - x); });
  }
  constexpr int steps = 4;
  std::optional<CornerPass> best;
  for (int i = 0; i <= (least < most ? steps : 0); ++i) {
    const std::optional<CornerPass> candidate =
        search.with_coast(least + (most - least) * i / steps, best ? best : known);
    if (candidate && (!best || search.lost(*candidate) < search.lost(*best))) best = candidate;
    if (candidate && candidate->speed_max >= search.reached()) break;
  }
  return best;
}

}  // namespace

double corner_distance(double n, double v, double tau, const LastFilter& last, double ramp, double coast) {
  return 0.5 * n * (v * last.deviation(tau) + ramp * last.beyond(0.5 * tau + coast));
}

CornerPass corner_pass(const AvailableAcceleration& available, std::size_t dimensions, const ProfileLegs& legs) {
  CornerPass pass;
  double n = 0.0;
  for (std::size_t a = 0; a < dimensions; ++a) n += (legs.out[a] - legs.in[a]) * (legs.out[a] - legs.in[a]);
  n = std::sqrt(n);
  pass.speed_max = legs.feed;
  if (n < 1e-9) return pass;
  const double window = available.window();
  const CornerSearch search(available, dimensions, legs, n);
  std::optional<CornerPass> best = best_coast(available, dimensions, legs, search, window);
  // A gentler acceleration inside the corner may change so little that no coasting is needed.
  if (best && best->coast > 0.0) {
    for (const double gentler : {0.7, 0.45, 0.25}) {
      ProfileLegs scaled = legs;
      scaled.scale *= gentler;
      const CornerSearch other(available, dimensions, scaled, n);
      const std::optional<CornerPass> candidate = best_coast(available, dimensions, scaled, other, window, best);
      if (candidate && search.lost(*candidate) < search.lost(*best)) best = candidate;
    }
  }
  // The tolerance is as small as the sampling error: stop there, which is timed to a sample.
  if (!best || search.tolerance(best->stretch) <= 0.05 * legs.tolerance) return {0.0, search.stretch(legs.feed), 0.0};
  return *best;
}

}  // namespace accdec
