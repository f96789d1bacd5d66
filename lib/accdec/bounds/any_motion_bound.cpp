#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include <accdec/bounds/any_motion_bound.hpp>
#include <accdec/bounds/corner_bound.hpp>
#include <accdec/bounds/kernel_bound.hpp>
#include <accdec/bounds/lower_bound.hpp>
#include <accdec/bounds/tube_window.hpp>
#include <accdec/bounds/weight_bound.hpp>
#include <accdec/bounds/window_bound.hpp>
#include <accdec/files.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/simulate/tube_check.hpp>

namespace accdec {
namespace {

/// What may be spent.
struct Effort {
  double kernels;              // steps, some 3 ns each
  double weights;              // products, some 1 ns each
  std::size_t programs = 600;  // linear ones, some 5 ms each
};
constexpr Effort of_seconds{2.5e8, 2e10}, of_a_second{2.5e7, 3e8};
constexpr double cell_ratio = 1.05;  // of one length of windows to the next
constexpr int widenings_max = 24;

/// Blocks that go straight on at one feed.
struct Leg {
  TubeLeg tube;
  double way = 0.0;                          // s at its pace
  double tolerance = 0.0;                    // m, of the joint at its end
  double reach = 0.0;                        // s after which a window shows no more
  double least = 0.0;                        // s that it takes at least
  std::size_t last_block = 0;                // of the program
  double first_loss = 0.0, last_loss = 0.0;  // s at its ends, each by itself
};

bool same(const TubeLeg& a, const TubeLeg& b) {
  double difference = 0.0, length = 0.0;
  for (std::size_t i = 0; i < a.pace.size(); ++i) {
    difference = std::hypot(difference, a.pace[i] - b.pace[i]);
    length = std::hypot(length, a.pace[i]);
  }
  return difference <= 1e-9 * length && (a.feed < unlimited) == (b.feed < unlimited);
}

/// The work that may still be done.
struct WorkLeft {
  Effort effort;
  double time_limit = 0.0;  // s
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
  bool complete = true;
  /// Whether work that is wanted may be done, where its number allows it.
  bool more(bool number) {
    const bool left = number && seconds_since(start) < time_limit;
    complete = complete && left;
    return left;
  }
};

class MotionBound {
 public:
  MotionBound(const Toolpath& path, const Machine& machine, double sample_period, double time_limit, bool thorough)
      : path_(path),
        machine_(machine),
        work_{.effort = thorough ? of_seconds : of_a_second, .time_limit = time_limit},
        slack_(spline_slack(machine, sample_period)),
        swing_times_(machine, path.dimensions()) {
    slack_.wider += path.narrowed;
    make_tube();
  }

  double bound() {
    double time = path_.dwells();
    if (!(slack_.wider < unlimited)) return 0.0;
    for (std::size_t first = 0; first < path_.blocks();) {
      std::size_t last = first;
      while (path_.joint[last] != Joint::stop) ++last;
      time += std::max(0.0, section(first, last) - slack_.saved);
      first = last + 1;
    }
    return time;
  }
  bool complete() const { return work_.complete; }

 private:
  using Key = std::vector<std::int64_t>;

  /// The radius of the tube around every block. Stops grant none. If the path goes straight on, the tolerances at
  /// both ends of all that is straight count. Around a chord an arc with its own tube has room.
  void make_tube() {
    const auto granted = [&](std::size_t b) { return path_.joint[b] == Joint::stop ? 0.0 : path_.tolerance[b]; };
    radius_ = tube_radii(path_);
    for (std::size_t b = 0; b < path_.blocks(); ++b)
      radius_[b] = std::max({radius_[b], b > 0 ? granted(b - 1) : 0.0, granted(b)}) + slack_.wider;
    for (const PathArc& arc : path_.arcs) {
      const double quarter = std::sin(0.25 * arc.angle / (arc.last - arc.first + 1.0));
      for (std::size_t b = arc.first; b <= arc.last; ++b) {
        double dx = 0.0, dy = 0.0;
        const double r = std::max(arc.from(path_.point(b), dx, dy), arc.from(path_.point(b + 1), dx, dy));
        radius_[b] += 2.0 * r * quarter * quarter;
      }
    }
  }

  Leg leg_of(std::size_t b) const {
    Leg leg;
    const double* p = path_.point(b);
    double length = 0.0, most = 0.0;
    std::size_t slowest = 0;
    for (std::size_t a = 0; a < path_.dimensions(); ++a) {
      const double way = p[path_.dimensions() + a] - p[a];
      length = std::hypot(length, way);
      leg.tube.direction[a] = way;
      if (std::abs(way) / machine_.axes[a].velocity_max > most) {
        most = std::abs(way) / machine_.axes[a].velocity_max;
        slowest = a;
      }
    }
    double acceleration = unlimited, jerk = unlimited;
    for (std::size_t a = 0; a < path_.dimensions(); ++a) {
      const double u = leg.tube.direction[a] /= length;
      if (u == 0.0) continue;
      acceleration = std::min(acceleration, acceleration_most(machine_.axes[a]) / std::abs(u));
      jerk = std::min(jerk, machine_.axes[a].jerk_max / std::abs(u));
    }
    const double feed = length / path_.duration[b];
    if (most >= path_.duration[b] * (1.0 - 1e-9)) {  // as fast as an axis goes
      leg.tube.pace[slowest] = std::copysign(1.0 / machine_.axes[slowest].velocity_max, leg.tube.direction[slowest]);
    } else {
      leg.tube.feed = feed;
      for (std::size_t a = 0; a < path_.dimensions(); ++a) leg.tube.pace[a] = leg.tube.direction[a] / feed;
    }
    leg.tube.radius = radius_[b];
    leg.way = path_.duration[b];
    leg.reach =
        acceleration < unlimited ? 1.2 * (feed / acceleration + (jerk < unlimited ? acceleration / jerk : 0.0)) : 0.0;
    leg.tolerance = path_.joint[b] == Joint::stop ? 0.0 : path_.tolerance[b] + slack_.wider;
    leg.last_block = b;
    return leg;
  }

  void make_legs(std::size_t first, std::size_t last) {
    legs_.clear();
    for (std::size_t b = first; b <= last; ++b) {
      Leg leg = leg_of(b);
      const bool goes_on = b > first && path_.joint[b - 1] == Joint::straight && same(leg.tube, legs_.back().tube);
      if (!goes_on) {
        legs_.push_back(leg);
        continue;
      }
      Leg& whole = legs_.back();
      whole.way += leg.way;
      whole.tube.radius = std::max(whole.tube.radius, leg.tube.radius);
      whole.tolerance = leg.tolerance;
    }
  }

  double section(std::size_t first, std::size_t last) {
    make_legs(first, last);
    // Room for the rounding of directions, and for feeds of blocks that were merged.
    constexpr double rounding = 1.0 - 1e-8;
    for (Leg& leg : legs_) leg.first_loss = leg.last_loss = 0.0;
    double best = 0.0;
    for (int i = 0; i < widenings_max; ++i) {
      double sum = lost(i == 0);
      for (const Leg& leg : legs_) sum += leg.way;
      const bool better = sum > best * (1.0 + 1e-4);
      best = std::max(best, sum);
      if (!(best < unlimited) || (i > 0 && !better)) break;
      // Windows that show all there is need no second look.
      const bool wide = std::all_of(legs_.begin(), legs_.end(),
                                    [](const Leg& leg) { return 0.5 * leg.least >= cell_ratio * leg.reach; });
      if (i > 0 && wide) break;
      for (Leg& leg : legs_) leg.least = std::max(leg.least, leg.way + leg.first_loss + leg.last_loss);
    }
    best = std::max(best, window_bound(path_, machine_, slack_.wider, first, last, &swing_times_));
    const auto time_left = [this] { return work_.more(true); };
    best = std::max(best, kernel_bound(path_, machine_, slack_.wider, first, last, work_.effort.kernels, time_left));
    std::vector<WeightLeg> legs;
    for (const Leg& leg : legs_) legs.push_back({leg.tube, leg.way, leg.tolerance});
    // The next sections have what this one leaves of its share.
    const auto blocks = static_cast<double>(last - first + 1),
               blocks_left = static_cast<double>(path_.blocks() - first);
    double share = work_.effort.weights * blocks / blocks_left;
    work_.effort.weights -= share;
    best = std::max(best, weight_bound(legs, machine_, path_.dimensions(), best, share, time_left));
    work_.effort.weights += share;
    return rounding * best;
  }

  /// The loss of all ends and corners, windows by what legs take at least; windows of no length at first.
  double lost(bool nothing) {
    double sum = 0.0;
    const auto cell = [&](const Leg& leg) { return nothing ? none : cell_of(leg); };
    for (std::size_t i = 0; i < legs_.size(); ++i) {
      Leg& leg = legs_[i];
      if (i == 0) sum += leg.first_loss = rest(leg, cell(leg));
      if (i + 1 == legs_.size()) {
        sum += leg.last_loss = rest(leg, cell(leg));
      } else {
        const TubeLoss& loss = corner(leg, cell(leg), legs_[i + 1], cell(legs_[i + 1]));
        leg.last_loss = loss.in;
        legs_[i + 1].first_loss = loss.out;
        sum += loss.both;
      }
      if (nothing) leg.least = 0.0;
    }
    return sum;
  }

  /// A window of half the leg's time, at most its reach, is shortened to reach/ratio^cell.
  static constexpr int none = 1000;
  static int cell_of(const Leg& leg) {
    const double half = 0.5 * leg.least;
    if (!(half > 0.0) || !(leg.reach > 0.0)) return none;
    const double cell = std::ceil(std::log(leg.reach / half) / std::log(cell_ratio) - 1e-9);
    return cell > 60.0 ? none : std::max(0, static_cast<int>(cell));
  }
  static double window_of(const Leg& leg, int cell) {
    return cell == none ? 0.0 : leg.reach * std::pow(cell_ratio, -cell) * (1.0 - 1e-12);
  }
  /// Whether that many linear programs may be solved.
  bool more(std::size_t programs) {
    const bool left = work_.more(work_.effort.programs >= programs);
    if (left) work_.effort.programs -= programs;
    return left;
  }

  static void append(const TubeLeg& leg, double reach, int cell, Key& key) {
    for (const double value : leg.direction) key.push_back(std::llround(value * 1e9));
    for (const double value : leg.pace) key.push_back(std::llround(value * 1e9));
    key.push_back(leg.feed < unlimited ? std::llround(leg.feed * 1e9) : -1);
    key.push_back(leg.radius < unlimited ? std::llround(leg.radius * 1e12) : -1);
    key.push_back(std::llround(reach * 1e9));
    key.push_back(cell);
  }

  double rest(const Leg& leg, int cell) {
    if (cell == none) return 0.0;
    Key key;
    append(leg.tube, leg.reach, cell, key);
    const auto [entry, is_new] = rests_.try_emplace(std::move(key), 0.0);
    if (is_new && more(1)) {
      entry->second = rest_loss(leg.tube, window_of(leg, cell), machine_, path_.dimensions()).both;
    }
    return entry->second;
  }

  TubeLoss corner(const Leg& in, int cell_in, const Leg& out, int cell_out) {
    TubeWindow window{&in.tube, &out.tube, in.tolerance, 0.0, 0.0};
    if (cell_in == none || cell_out == none) return tube_loss(window, machine_, path_.dimensions());
    Key key;
    append(in.tube, in.reach, cell_in, key);
    append(out.tube, out.reach, cell_out, key);
    key.push_back(std::llround(in.tolerance * 1e12));
    const auto known = corners_.find(key);
    if (known != corners_.end()) return known->second;
    if (more(3)) {
      window.before = window_of(in, cell_in);
      window.after = window_of(out, cell_out);
    }
    return corners_[std::move(key)] = tube_loss(window, machine_, path_.dimensions());
  }

  const Toolpath& path_;
  const Machine& machine_;
  WorkLeft work_;
  SplineSlack slack_;
  const SwingTimes swing_times_;
  std::vector<double> radius_;  // m, of every block's tube
  std::vector<Leg> legs_;       // of the section
  std::map<Key, double> rests_;
  std::map<Key, TubeLoss> corners_;
};

bool rests_inside(const Toolpath& path) {
  return std::count(path.joint.begin(), path.joint.end(), Joint::stop) > 1;
}

/// The path with its stops, but for the last, as corners that are passed exactly. Dwells stay.
Toolpath without_stops(Toolpath path) {
  for (std::size_t b = 0; b + 1 < path.blocks(); ++b) {
    if (path.joint[b] != Joint::stop) continue;
    path.joint[b] = Joint::corner;
    path.tolerance[b] = 0.0;
  }
  return path;
}

}  // namespace

AnyMotionBound any_motion_bound(const Toolpath& path, const Machine& task_machine, double sample_period,
                                double time_limit, bool thorough) {
  const Machine machine = program_machine(task_machine, path);
  const auto start = std::chrono::steady_clock::now();
  AnyMotionBound bound{program_lower_bound(path, machine, sample_period), true};
  const auto add = [&](const Toolpath& of_path, const Machine& of_machine, double share, bool effort) {
    const double left = time_limit - seconds_since(start);
    MotionBound motions(of_path, of_machine, sample_period, share * left, effort);
    bound.time = std::max(bound.time, motions.bound());
    bound.complete = bound.complete && motions.complete();
  };
  const bool jerk = limits_jerk(machine), stops = rests_inside(path);
  // Those that take a part of a second come first: the time may end the others.
  add(path, machine, jerk || stops || thorough ? 0.5 : 1.0, false);
  if (jerk) add(path, without_jerk_limits(machine), stops || thorough ? 0.5 : 1.0, false);
  if (stops) add(without_stops(path), machine, thorough ? 0.5 : 1.0, false);
  if (!thorough) return bound;
  bound.complete = true;
  add(path, machine, jerk ? 0.5 : 1.0, true);
  if (jerk) add(path, without_jerk_limits(machine), 1.0, true);
  return bound;
}

}  // namespace accdec
