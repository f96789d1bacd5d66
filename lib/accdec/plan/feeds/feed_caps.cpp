#include <algorithm>
#include <array>
#include <cmath>

#include <accdec/motion/leg_distance.hpp>
#include <accdec/plan/feeds/control_delay.hpp>
#include <accdec/plan/feeds/feed_caps.hpp>
#include <accdec/task/corner_feed.hpp>
#include <accdec/task/delay_kinds.hpp>

namespace accdec {
namespace {

// Multiples of the tolerance: the radius error to plan for where the command compensates most of it. The simulation
// corrects the rest.
constexpr double inside_widened = 5.0, end_widened = 2.0;
constexpr double slowest = 1e-3;  // part of the feed: no joint is passed more slowly; a delay does the rest

/// The block so far ahead of the end of block b, m, inside its leg; behind it if negative.
std::size_t walk(const Toolpath& path, const FeedPath& feeds, std::size_t b, double distance) {
  if (distance >= 0.0) {
    for (++b; b + 1 < feeds.blocks() && distance > feeds.length[b] && !ends_leg(path, b); ++b)
      distance -= feeds.length[b];
    return b;
  }
  for (distance = -distance; b > 0 && distance > feeds.length[b] && !ends_leg(path, b - 1); --b)
    distance -= feeds.length[b];
  return b;
}

}  // namespace

FeedCaps::FeedCaps(const Toolpath& path, const FeedPath& feeds, const FilterBehind& behind, const FeedWindow& window,
                   double sample_period, double feed_step)
    : path_(path),
      feeds_(feeds),
      filter_(behind.command()),
      motion_(behind.motion()),
      window_(window),
      period_(sample_period),
      feed_step_(feed_step),
      finder_(motion_),
      arcs_(path, feeds, behind, window, sample_period),
      steady_(path, feeds, behind, sample_period),
      acceleration_(path.blocks(), unlimited),
      known_(path.blocks()) {
  const std::size_t n = feeds.dimensions;
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    for (std::size_t a = 0; a < n; ++a) {
      const double u = std::abs(feeds.direction[b * n + a]);
      if (u > 0.0) acceleration_[b] = std::min(acceleration_[b], window.acceleration_change(a) / (window.tau1() * u));
    }
  }
}

double FeedCaps::largest(std::size_t b, double v_max, bool apart, bool together) const {
  const std::size_t n = feeds_.dimensions;
  const double *u = feeds_.direction.data() + b * n, *w = u + n;
  const double margin = std::min(feeds_.margin[b], feeds_.margin[b + 1]);
  double v = v_max;
  for (int round = 0; round < 3; ++round) {  // loads allow more at lower speeds
    double next = v_max;
    for (std::size_t a = 0; a < n; ++a) {
      const double in = std::abs(u[a]), out = std::abs(w[a]), turn = std::abs(w[a] - u[a]);
      const double most = std::max(apart ? std::max(in, out) : 0.0, together ? turn : 0.0);
      if (most <= 0.0) continue;
      const double allowed = margin * std::min({window_.step(a), window_.change(a, v * in, 0.0, false),
                                                window_.change(a, v * out, 0.0, true)});
      next = std::min(next, allowed / most);
    }
    if (!window_.loads()) return next;
    v = std::min(v, next);
  }
  return v;
}

bool FeedCaps::passes(std::size_t b, const CornerFeed& corner, double cosine, double tolerance) const {
  const std::size_t n = feeds_.dimensions;
  const double *u = feeds_.direction.data() + b * n, *w = u + n;
  const double margin = std::min(feeds_.margin[b], feeds_.margin[b + 1]);
  for (std::size_t a = 0; a < n; ++a) {
    const double in = corner.speed * u[a], out = corner.leaving * w[a];
    const double allowed = margin * std::min({window_.step(a), window_.change(a, std::abs(in), 0.0, false),
                                              window_.change(a, std::abs(out), 0.0, true)});
    if (std::abs(out - in) > allowed * (1.0 + 1e-9)) return false;
  }
  return finder_(cosine, corner.speed * period_, corner.leaving * period_, tolerance) == 0;
}

/// At the largest multiple of the control's step that holds tolerance and limits, at least one. Both grow with the
/// feed.
CornerFeed FeedCaps::without_delay(std::size_t b, double cosine, double tolerance) const {
  const auto [in, out] = corner_feed_whole(path_, b);
  const auto at = [&, in = in, out = out](int multiple) {
    const double part = std::min(1.0, multiple * feed_step_);
    return CornerFeed{part * in, part * out, 0};
  };
  int good = 1, bad = corner_feed_multiples(feed_step_) + 2;
  while (bad - good > 1) {
    const int middle = good + (bad - good) / 2;
    (passes(b, at(middle), cosine, tolerance) ? good : bad) = middle;
  }
  return at(good);
}

double FeedCaps::error_in_steps(double cosine) const {
  const auto distance = [&](int k) {
    return leg_distance(motion_.remaining_moment(k), motion_.elapsed_moment(k), cosine);
  };
  int k = static_cast<int>(motion_.mean_delay());
  double least = distance(k);
  // The path is convex, so the distance falls, then rises.
  for (const int step : {1, -1}) {
    for (double next; k + step >= 0 && k + step <= motion_.order() + 1 && (next = distance(k + step)) < least;
         k += step)
      least = next;
  }
  return least;
}

double FeedCaps::time_lost(std::size_t b, double v, double held) const {
  const double a = acceleration_[b], length = feeds_.length[b];
  const double top = std::min(feed(b), std::sqrt(v * v + a * length));
  if (!(top > v)) return 0.0;
  const double ramp = (top - v) * (top - v) / (2.0 * a * top);
  return std::max(ramp, std::min(held, length / v) * (1.0 - v / top));
}

double FeedCaps::held_for(const CornerFeed& corner) const {
  // The motion is nearest to a corner of equal feeds with half of the filter on each side, else with more on one side.
  const double seen = corner.leaving == corner.speed ? window_.half() : motion_.order() * period_;
  return std::max(period_, seen - 0.5 * corner.delay * period_);
}

double FeedCaps::time_lost(std::size_t b, const CornerFeed& corner) const {
  const double held = held_for(corner);
  return corner.delay * period_ + time_lost(b, corner.speed, held) + time_lost(b + 1, corner.leaving, held);
}

CornerFeed FeedCaps::corner(std::size_t b, double tolerance) {
  if (feed_step_ > 0.0) return fastest_corner(b, tolerance);  // depends on the programmed points, too
  KnownCorners<CornerFeed>::Key key{};
  const double* const u = feeds_.direction.data() + b * feeds_.dimensions;
  auto* const rest = std::copy(u, u + 2 * feeds_.dimensions, key.data());
  const std::array<double, 7> others{feeds_.length[b],
                                     feeds_.length[b + 1],
                                     feed(b),
                                     feed(b + 1),
                                     std::min(feeds_.margin[b], feeds_.margin[b + 1]),
                                     tolerance,
                                     path_.joint[b] == Joint::stop ? 1.0 : 0.0};
  const auto end = std::copy(others.begin(), others.end(), rest);
  return known_.get({key.data(), end}, [&] { return fastest_corner(b, tolerance); });
}

CornerFeed FeedCaps::fastest_corner(std::size_t b, double tolerance) const {
  const std::size_t n = feeds_.dimensions;
  const double *u = feeds_.direction.data() + b * n, *w = u + n;
  double dot = 0.0;
  for (std::size_t a = 0; a < n; ++a) dot += u[a] * w[a];
  const double cosine = std::clamp(-dot, -1.0, 1.0);
  const double feed_max = std::min(feed(b), feed(b + 1));
  const bool stops = path_.joint[b] == Joint::stop;
  // Behind a servo the motion goes on while the command rests: it may need longer than that to stay within a tolerance.
  const int rest = exact_stop_delay(filter_), longest = finder_.exact_stop_delay();
  const double watched = watched_part(path_.control, u, n, 1.0);
  const auto within = [&](double v) { return finder_(cosine, v * period_, v * period_, tolerance); };
  const auto delay_at = [&](double v) {
    if (stops) return std::max(rest, within(v));
    return control_delay(path_.control, filter_, watched * v * period_, within(v)).value_or(longest);
  };
  const double alone = std::max(slowest * feed_max, largest(b, feed_max, true, false));
  const int apart = std::max(rest, within(alone));
  CornerFeed best{alone, alone, stops || path_.control.any() || apart <= rest + exact_stop_more ? apart : longest};
  double least = time_lost(b, best);
  const bool slow_only = !stops && runs_on(path_.control), stepped = !stops && feed_step_ > 0.0;
  if (slow_only) best = {slowest * feed_max, slowest * feed_max, 0}, least = unlimited;
  if (stepped) {
    const CornerFeed corner = without_delay(b, cosine, tolerance);
    const double time = time_lost(b, corner);
    if (slow_only) return corner;
    if (time < least && passes(b, corner, cosine, tolerance)) best = corner, least = time;
  }
  if (stops || !(tolerance > 0.0)) return best;
  const double no_delay = largest(b, feed_max, false, true), overlap = largest(b, feed_max, true, true);
  /// False if all lower speeds take longer, too: without a delay, more is lost the lower the speed. A delay costs at
  /// least what it saves.
  const auto offer = [&](double v) {
    if (time_lost(b, {v, v, 0}) >= least) return false;
    const int delay = delay_at(v);
    if (v > (delay > 0 ? overlap : no_delay) * (1.0 + 1e-9) || (slow_only && delay > 0)) return true;
    if (stepped && delay == 0) return true;
    const double time = time_lost(b, {v, v, delay});
    if (time >= least) return true;
    least = time;
    best = {v, v, delay};
    return true;
  };
  // The largest speed without delay. The error at the samples is in proportion to it.
  double low = 0.0, high = no_delay;
  if (path_.control.any() || path_.control.names(DelayKind::continuous)) {
    constexpr double rounding = 1.0 - 1e-12;
    low = std::min(high, rounding * tolerance / (error_in_steps(cosine) * period_));
  } else if (delay_at(high) == 0) {
    low = high;
  } else {
    for (int k = 0; k < 12; ++k) {
      const double middle = 0.5 * (low + high);
      (delay_at(middle) == 0 ? low : high) = middle;
    }
  }
  if (low > slowest * feed_max) offer(low);
  for (double v = overlap; v > low && v > slowest * feed_max && offer(v); v *= 0.85) {
  }
  return best;
}

double FeedCaps::steady_change(std::size_t b, double v) const {
  const std::size_t n = feeds_.dimensions;
  const double way = v * window_.tau1();
  double use = 0.0;
  const auto pair = [&](std::size_t from, std::size_t to) {
    const double *u = feeds_.direction.data() + from * n, *w = feeds_.direction.data() + to * n;
    const double margin = std::min(feeds_.margin[from], feeds_.margin[to]);
    for (std::size_t a = 0; a < n; ++a) {
      const double change = v * std::abs(w[a] - u[a]);
      if (change > 0.0) use = std::max(use, change / (margin * window_.change(a, v * w[a], v * u[a], false)));
    }
  };
  pair(walk(path_, feeds_, b, -way), b + 1);
  pair(b, walk(path_, feeds_, b, way));
  return use;
}

double FeedCaps::smooth(std::size_t b, double tolerance) const {
  const double top = std::max(feed(b), feed(b + 1));
  // The radius error left by widened arcs is small inside them, and some of it remains at their ends.
  const bool widened = path_.widen_arcs && (arc_of(path_, b) != nullptr || arc_of(path_, b + 1) != nullptr);
  const double bound = path_.joint[b] == Joint::straight ? unlimited : tolerance;
  if (const auto v = arcs_.speed(b, widened ? inside_widened * bound : bound)) return std::max(*v, slowest * top);
  tolerance *= widened ? end_widened : 1.0;
  double v = top;
  // On a curve the change grows with the square of the speed, in a single joint with the speed.
  for (int k = 0; k < 12; ++k) {
    const double use = steady_change(b, v);
    if (use <= 1.0 + 1e-9) break;
    v /= k < 6 && use > 1.005 ? std::sqrt(use) : std::max(use, 1.001);
  }
  if (!(tolerance < unlimited) || path_.joint[b] == Joint::straight) return v;
  if (steady_.error(b, v) <= tolerance) return v;
  double low = 0.0, high = v;
  for (int k = 0; k < 10 && high - low > 0.01 * high; ++k) {
    const double middle = 0.5 * (low + high);
    (steady_.error(b, middle) <= tolerance ? low : high) = middle;
  }
  return std::max(low, slowest * top);
}

struct FeedCaps::Zone {
  double length = 0.0, speed = unlimited;
  void add(double l, double v) {
    length = std::max(length, l);
    speed = std::min(speed, v);
  }
};

/// Holds the speed v of joint b over a distance `left` after it (ahead) or before it: whole blocks, and a part of one.
void FeedCaps::hold(std::size_t b, double v, double left, bool ahead, std::vector<double>& cap,
                    std::vector<Zone>& part) const {
  const auto ends = [&](std::size_t joint) { return ends_leg(path_, joint); };
  for (std::size_t i = ahead ? b + 1 : b;; ahead ? ++i : --i) {
    if (left < feeds_.length[i] * 0.9) {
      part[i].add(left, v);
      return;
    }
    cap[i] = std::min(cap[i], v);
    left -= feeds_.length[i];
    if (left <= 0.0 || ends(b)) return;
    if (ahead ? i + 1 == feeds_.blocks() || ends(i) : i == 0 || ends(i - 1)) return;
  }
}

/// Pieces of one block: the part held at the joint before it, the middle, and the part held at the joint after it.
void FeedCaps::add_pieces(std::size_t b, double cap, Zone first, Zone last, std::vector<FeedPiece>& pieces) const {
  const double length = feeds_.length[b];
  if (first.speed >= cap) first.length = 0.0;
  if (last.speed >= cap) last.length = 0.0;
  if (first.length + last.length > 0.98 * length) {
    const double scale = length / (first.length + last.length);
    first.length *= scale;
    last.length = length - first.length;
  }
  const double middle = length - first.length - last.length;
  const auto block = static_cast<std::uint32_t>(b);
  if (first.length > 0.0) pieces.push_back({block, first.length, first.speed, 0.0});
  if (middle > 0.0) pieces.push_back({block, middle, cap, 0.0});
  if (last.length > 0.0) pieces.push_back({block, last.length, last.speed, 0.0});
}

std::vector<FeedPiece> FeedCaps::pieces(const std::vector<CornerFeed>& joints) const {
  const std::size_t blocks = feeds_.blocks();
  std::vector<Zone> begin(blocks), end(blocks);
  std::vector<double> cap(blocks);
  for (std::size_t b = 0; b < blocks; ++b) cap[b] = feed(b);
  for (std::size_t b = 0; b + 1 < blocks; ++b) {
    const CornerFeed& joint = joints[b];
    if (!(joint.speed < unlimited) || (joint.speed >= cap[b] && joint.leaving >= cap[b + 1])) continue;
    const double time = held_for(joint);
    hold(b, joint.speed, joint.speed * time, false, cap, end);
    hold(b, joint.leaving, joint.leaving * time, true, cap, begin);
  }
  std::vector<FeedPiece> pieces;
  pieces.reserve(3 * blocks);  // pages that are not written cost nothing; moving to new ones would
  for (std::size_t b = 0; b < blocks; ++b) {
    add_pieces(b, cap[b], begin[b], end[b], pieces);
    if (b + 1 < blocks) pieces.back().rest = joints[b].delay * period_;
  }
  return pieces;
}

}  // namespace accdec
