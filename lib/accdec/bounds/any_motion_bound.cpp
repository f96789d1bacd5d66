#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
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
  double kernels;  // steps, some 3 ns each
  double weights;  // products, some 1 ns each
};
constexpr Effort of_seconds{2.5e8, 2e10}, of_a_second{2.5e7, 3e8};
constexpr std::size_t programs_max = 600;  // linear ones of a machine, some 5 ms each
constexpr double cell_ratio = 1.05;        // of one length of windows to the next
constexpr int widenings_max = 24;

/// Blocks that go straight on at one feed.
struct Leg {
  TubeLeg tube;
  double way = 0.0;                          // s at its pace
  double tolerance = 0.0;                    // m, of the joint at its end
  std::array<double, 2> reach{};             // s after which a window shows no more, by machines_
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

TubeLoss larger(const TubeLoss& a, const TubeLoss& b) {
  return {std::max(a.both, b.both), std::max(a.in, b.in), std::max(a.out, b.out)};
}

/// From stop to stop.
struct Section {
  double time = 0.0;        // s, its bound
  double by_weights = 0.0;  // s, that of `proof`
  std::optional<MotionProof> proof{};
};

/// The work that may still be done. Linear programs leave a part of the time to weights, whose bounds are proved.
struct WorkLeft {
  static constexpr double of_programs = 0.4;
  Effort effort{};
  Deadline deadline, programs;
  bool complete = true;
  WorkLeft() = default;
  WorkLeft(const Effort& most, const Deadline& until)
      : effort(most), deadline(until), programs(until.within(of_programs * until.left())) {}
  /// Whether work that is wanted may be done, where its number allows it.
  bool more(bool number, const Deadline& until) {
    const bool left = number && !until.over();
    complete = complete && left;
    return left;
  }
};

class MotionBound {
 public:
  MotionBound(const Toolpath& path, const Machine& machine, double sample_period)
      : path_(path),
        machines_{machine},
        slack_(spline_slack(machine, sample_period)),
        swing_times_(machine, path.dimensions()) {
    slack_.wider += path.narrowed;
    if (limits_jerk(machine)) machines_.push_back(without_jerk_limits(machine));
    programs_left_ = programs_max * machines_.size();
    make_tube();
  }

  /// Raises the bounds of the sections to what is found here. Linear programs are solved once, whatever the effort.
  /// @returns whether all that was wanted was done
  bool raise(std::vector<Section>& sections, const Effort& effort, const Deadline& deadline) {
    work_ = WorkLeft(effort, deadline);
    if (!(slack_.wider < unlimited)) return true;
    std::size_t i = 0;
    for (std::size_t first = 0; first < path_.blocks(); ++i) {
      std::size_t last = first;
      while (path_.joint[last] != Joint::stop) ++last;
      if (sections.size() == i) sections.emplace_back();
      raise(sections[i], first, last);
      first = last + 1;
    }
    return work_.complete;
  }

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
      if (std::abs(way) / machines_[0].axes[a].velocity_max > most) {
        most = std::abs(way) / machines_[0].axes[a].velocity_max;
        slowest = a;
      }
    }
    double acceleration = unlimited, jerk = unlimited;
    for (std::size_t a = 0; a < path_.dimensions(); ++a) {
      const double u = leg.tube.direction[a] /= length;
      if (u == 0.0) continue;
      acceleration = std::min(acceleration, acceleration_most(machines_[0].axes[a]) / std::abs(u));
      jerk = std::min(jerk, machines_[0].axes[a].jerk_max / std::abs(u));
    }
    const double feed = length / path_.duration[b];
    if (most >= path_.duration[b] * (1.0 - 1e-9)) {  // as fast as an axis goes
      leg.tube.pace[slowest] =
          std::copysign(1.0 / machines_[0].axes[slowest].velocity_max, leg.tube.direction[slowest]);
    } else {
      leg.tube.feed = feed;
      for (std::size_t a = 0; a < path_.dimensions(); ++a) leg.tube.pace[a] = leg.tube.direction[a] / feed;
    }
    leg.tube.radius = radius_[b];
    leg.way = path_.duration[b];
    if (acceleration < unlimited) {
      const double ramp = feed / acceleration, rounding = jerk < unlimited ? acceleration / jerk : 0.0;
      leg.reach = {1.2 * (ramp + rounding), 1.2 * ramp};
    }
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
      whole.last_block = leg.last_block;
      whole.tube.radius = std::max(whole.tube.radius, leg.tube.radius);
      whole.tolerance = leg.tolerance;
    }
  }

  void raise(Section& of, std::size_t first, std::size_t last) {
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
                                    [](const Leg& leg) { return 0.5 * leg.least >= cell_ratio * leg.reach[0]; });
      if (i > 0 && wide) break;
      for (Leg& leg : legs_) leg.least = std::max(leg.least, leg.way + leg.first_loss + leg.last_loss);
    }
    best = std::max(best, window_bound(path_, machines_[0], slack_.wider, first, last, &swing_times_));
    const auto time_left = [this] { return work_.more(true, work_.deadline); };
    best =
        std::max(best, kernel_bound(path_, machines_[0], slack_.wider, first, last, work_.effort.kernels, time_left));
    std::vector<WeightLeg> legs;
    for (const Leg& leg : legs_) legs.push_back({leg.tube, leg.way, leg.tolerance, leg.last_block});
    // The next sections have what this one leaves of its share.
    const auto blocks = static_cast<double>(last - first + 1),
               blocks_left = static_cast<double>(path_.blocks() - first);
    double share = work_.effort.weights * blocks / blocks_left;
    work_.effort.weights -= share;
    MotionProof proof;
    proof.first = first;
    const double by_weights = weight_bound(legs, machines_[0], path_.dimensions(), best, share, time_left, &proof);
    work_.effort.weights += share;
    if (by_weights > of.by_weights) of.by_weights = by_weights, of.proof = std::move(proof);
    best = std::max(best, by_weights);
    of.time = std::max(of.time, rounding * best - slack_.saved);
  }

  /// The loss of all ends and corners, windows by what legs take at least; windows of no length at first.
  double lost(bool nothing) {
    double sum = 0.0;
    if (nothing) {
      for (Leg& leg : legs_) leg.least = 0.0;
    }
    for (std::size_t i = 0; i < legs_.size(); ++i) {
      Leg& leg = legs_[i];
      if (i == 0) sum += leg.first_loss = rest(leg);
      if (i + 1 == legs_.size()) {
        sum += leg.last_loss = rest(leg);
      } else {
        const TubeLoss loss = corner(leg, legs_[i + 1]);
        leg.last_loss = loss.in;
        legs_[i + 1].first_loss = loss.out;
        sum += loss.both;
      }
    }
    return sum;
  }

  /// A window of half the leg's time, at most its reach, is shortened to reach/ratio^cell.
  static constexpr int none = 1000;
  static int cell_of(const Leg& leg, std::size_t m) {
    const double half = 0.5 * leg.least;
    if (!(half > 0.0) || !(leg.reach[m] > 0.0)) return none;
    const double cell = std::ceil(std::log(leg.reach[m] / half) / std::log(cell_ratio) - 1e-9);
    return cell > 60.0 ? none : std::max(0, static_cast<int>(cell));
  }
  static double window_of(const Leg& leg, std::size_t m, int cell) {
    return leg.reach[m] * std::pow(cell_ratio, -cell) * (1.0 - 1e-12);
  }
  /// Whether that many linear programs may be solved.
  bool more(std::size_t programs) {
    const bool left = work_.more(programs_left_ >= programs, work_.programs);
    if (left) programs_left_ -= programs;
    return left;
  }

  static void append(const Leg& leg, std::size_t m, int cell, Key& key) {
    for (const double value : leg.tube.direction) key.push_back(std::llround(value * 1e9));
    for (const double value : leg.tube.pace) key.push_back(std::llround(value * 1e9));
    key.push_back(leg.tube.feed < unlimited ? std::llround(leg.tube.feed * 1e9) : -1);
    key.push_back(leg.tube.radius < unlimited ? std::llround(leg.tube.radius * 1e12) : -1);
    key.push_back(std::llround(leg.reach[m] * 1e9));
    key.push_back(cell);
  }

  // A motion keeps the limits of all machines. So the largest loss of their windows counts, each as long as it needs.
  double rest(const Leg& leg) {
    double loss = 0.0;
    for (std::size_t m = 0; m < machines_.size(); ++m) loss = std::max(loss, rest(leg, m));
    return loss;
  }
  TubeLoss corner(const Leg& in, const Leg& out) {
    TubeLoss loss = corner(in, out, 0);
    for (std::size_t m = 1; m < machines_.size(); ++m) loss = larger(loss, corner(in, out, m));
    return loss;
  }

  double rest(const Leg& leg, std::size_t m) {
    const int cell = cell_of(leg, m);
    if (cell == none) return 0.0;
    Key key{static_cast<std::int64_t>(m)};
    append(leg, m, cell, key);
    const auto known = rests_.find(key);
    if (known != rests_.end()) return known->second;
    if (!more(1)) return 0.0;
    return rests_[std::move(key)] = rest_loss(leg.tube, window_of(leg, m, cell), machines_[m], path_.dimensions()).both;
  }

  TubeLoss corner(const Leg& in, const Leg& out, std::size_t m) {
    const int cell_in = cell_of(in, m), cell_out = cell_of(out, m);
    TubeWindow window{&in.tube, &out.tube, in.tolerance, 0.0, 0.0};
    if (cell_in == none || cell_out == none) return tube_loss(window, machines_[m], path_.dimensions());
    Key key{static_cast<std::int64_t>(m)};
    append(in, m, cell_in, key);
    append(out, m, cell_out, key);
    key.push_back(std::llround(in.tolerance * 1e12));
    const auto known = corners_.find(key);
    if (known != corners_.end()) return known->second;
    if (!more(3)) return tube_loss(window, machines_[m], path_.dimensions());
    window.before = window_of(in, m, cell_in);
    window.after = window_of(out, m, cell_out);
    return corners_[std::move(key)] = tube_loss(window, machines_[m], path_.dimensions());
  }

  const Toolpath& path_;
  std::vector<Machine> machines_;  // the given one, and the same without its jerk limits
  WorkLeft work_{};
  std::size_t programs_left_ = programs_max;
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
                                const Deadline& deadline, bool thorough) {
  const Machine machine = program_machine(task_machine, path), freer = without_jerk_limits(machine);
  AnyMotionBound bound{program_lower_bound(path, machine, sample_period), true};
  std::vector<Section> sections, passed;  // passed: its stops are passed
  const auto raise = [&](MotionBound& motions, std::vector<Section>& of, double share, const Effort& effort) {
    const bool complete = motions.raise(of, effort, deadline.within(share * deadline.left()));
    bound.complete = bound.complete && complete;
    double time = path.dwells();
    for (const Section& section : of) time += section.time;
    bound.time = std::max(bound.time, time);
  };
  const bool jerk = limits_jerk(machine), stops = rests_inside(path);
  MotionBound limited(path, machine, sample_period), free(path, freer, sample_period);
  // Those that take a part of a second come first: the time may end the others.
  raise(limited, sections, jerk || stops || thorough ? 0.5 : 1.0, of_a_second);
  if (jerk) raise(free, sections, stops || thorough ? 0.5 : 1.0, of_a_second);
  if (stops) {
    const Toolpath all = without_stops(path);
    MotionBound past_stops(all, machine, sample_period);
    raise(past_stops, passed, thorough ? 0.5 : 1.0, of_a_second);
  }
  if (!thorough) return bound;
  bound.complete = true;
  raise(limited, sections, jerk ? 0.5 : 1.0, of_seconds);
  if (jerk) raise(free, sections, 1.0, of_seconds);
  for (Section& section : sections) {
    if (!section.proof) continue;
    // Without jerk limits there are no weights of the jerk: zeros are a choice, too.
    for (MotionProof::Leg& leg : section.proof->legs) {
      if (jerk && leg.jerk.empty()) leg.jerk.assign(leg.shares.size(), std::vector<double>(path.dimensions(), 0.0));
    }
    bound.proofs.push_back(std::move(*section.proof));
  }
  return bound;
}

}  // namespace accdec
