#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <accdec/plan/along/along_run.hpp>
#include <accdec/plan/along/path_speed.hpp>
#include <accdec/plan/along/smooth_path.hpp>

namespace accdec {
namespace {

constexpr double of_kinks = 0.5;       // of the limits of acceleration and jerk
constexpr double of_tolerance = 0.98;  // for samples beside a joint
constexpr std::size_t nodes_max = 400'000;

using Vector = std::array<double, program_axis_count>;

constexpr int first_rounds = 2, rounds = 7;

/// The time of the first round's coarse cells is right to this part of it, that of later rounds to this.
constexpr double coarse = 5e-3, fine = 1e-4;

struct Caps {
  double feed = unlimited, tolerance = unlimited;  // of a piece: m/s, m
};

void lower(std::vector<double>& limits, double use) {
  if (!(use > 1.0)) return;
  for (double& limit : limits) limit *= std::max(0.5, of_limits / use);
}

class Run {
 public:
  Run(const FreePath& free, std::size_t first, std::size_t last, const Deadline& deadline)
      : free_(free), deadline_(deadline), first_(first), last_(last), curve_(free.path, first, last) {}

  /// @param most_samples  see along_run
  std::optional<AlongRun> plan(std::size_t most_samples) {
    const double there = static_cast<double>(most_samples) * free_.period;
    if (!curve_.bends() || !set_limits() || !set_pieces()) return {};
    first_guess();
    if (problem_.node.empty()) return {};
    for (int round = 0; round < rounds; ++round) {
      // Limits of cells only get lower, so that no later round is faster.
      const double most = (1.0 + (round == 0 ? coarse : fine)) * there;
      if (!problem_.solve(x_, most, [this] { return deadline_.over(); })) return {};
      if (deadline_.over()) return stretched();
      if (round < first_rounds) {
        if (!refine()) return {};
        continue;
      }
      AlongRun run = samples_of(times(), least_count());
      const Uses uses = uses_of(run.position);
      if (uses.hold()) return run;
      // Samples use a limit more than cells do, so the cells get less of it.
      lower(problem_.acceleration_max, uses.acceleration);
      lower(problem_.jerk_max, uses.jerk);
      if (round + 1 < rounds && !refine()) return {};
    }
    return stretched();
  }

 private:
  /// Velocity and force leave the acceleration of the fastest feed.
  bool set_limits() {
    problem_.axes = free_.dimensions();
    double feed = 0.0;
    for (std::size_t b = first_; b <= last_; ++b) feed = std::max(feed, free_.feed[b]);
    for (const Axis& axis : free_.machine.axes) {
      double acceleration = axis.acceleration_max;
      if (axis.force_max < unlimited) {
        const double drag = axis.damping > 0.0 ? axis.damping * std::min(feed, axis.velocity_max) : 0.0;
        if (!(drag < axis.force_max)) return false;
        if (axis.mass > 0.0) acceleration = std::min(acceleration, (axis.force_max - drag) / axis.mass);
      }
      if (!(acceleration < unlimited)) return false;
      problem_.acceleration_max.push_back(of_limits * acceleration);
      problem_.jerk_max.push_back(of_limits * axis.jerk_max);
    }
    return true;
  }

  bool set_pieces() {
    for (const SmoothPath::Piece& piece : curve_.pieces()) {
      Caps caps;
      const double off = curve_.off_chords(piece);
      for (std::size_t b = piece.first; b <= piece.last; ++b) {
        caps.feed = std::min(caps.feed, free_.feed[b]);
        if (b < piece.last) caps.tolerance = std::min(caps.tolerance, free_.path.tolerance[b]);
        if (piece.bends() && !(off < free_.radius[b])) return false;
      }
      caps_.push_back(caps);
    }
    return true;
  }

  /// Largest squared speed in a place of a piece.
  double cap_at(std::size_t piece, const PathPlace& place) const {
    double length2 = 0.0, bend2 = 0.0, cap = unlimited;
    for (std::size_t a = 0; a < problem_.axes; ++a) {
      length2 += place.first[a] * place.first[a];
      bend2 += place.second[a] * place.second[a];
      const double v = of_limits * free_.machine.axes[a].velocity_max / std::abs(place.first[a]);
      const double along = problem_.acceleration_max[a] / std::abs(place.second[a]);
      cap = std::min({cap, v * v, along});
    }
    const Caps& caps = caps_[piece];
    cap = std::min(cap, caps.feed * caps.feed / length2);
    // The steps of the samples pass a vertex inside the arc by a T^2/8.
    return std::min(cap, of_tolerance * 8.0 * caps.tolerance / (std::sqrt(bend2) * free_.period * free_.period));
  }
  /// Largest squared speed at the border after a piece, where the direction may jump.
  double cap_after(std::size_t piece) const {
    const SmoothPath::Piece& before = curve_.pieces()[piece];
    const SmoothPath::Piece& after = curve_.pieces()[piece + 1];
    const PathPlace in = curve_.at(before, after.begin), out = curve_.at(after, after.begin);
    double speed = unlimited, jump2 = 0.0;
    for (std::size_t a = 0; a < problem_.axes; ++a) {
      const double jump = std::abs(out.first[a] - in.first[a]);
      const double step = free_.period * std::min(problem_.acceleration_max[a], free_.period * problem_.jerk_max[a]);
      speed = std::min(speed, of_kinks * step / jump);
      jump2 += jump * jump;
    }
    speed = std::min(speed, 2.0 * free_.path.tolerance[before.last] / (free_.period * std::sqrt(jump2)));
    return speed * speed;
  }

  /// Sets everything that the nodes decide.
  void set_nodes(std::vector<double> nodes) {
    problem_.node = std::move(nodes);
    const std::size_t count = problem_.node.size();
    problem_.cap.assign(count, unlimited);
    problem_.first.resize((count - 1) * problem_.axes);
    problem_.second.resize((count - 1) * problem_.axes);
    for (std::size_t c = 0; c + 1 < count; ++c) {
      const double u = 0.5 * (problem_.node[c] + problem_.node[c + 1]);
      const std::size_t piece = curve_.piece_at(u);
      const PathPlace place = curve_.at(curve_.pieces()[piece], u);
      std::copy_n(place.first.begin(), problem_.axes,
                  problem_.first.begin() + static_cast<std::ptrdiff_t>(c * problem_.axes));
      std::copy_n(place.second.begin(), problem_.axes,
                  problem_.second.begin() + static_cast<std::ptrdiff_t>(c * problem_.axes));
      const double cap = cap_at(piece, place);
      for (const std::size_t i : {c, c + 1}) problem_.cap[i] = std::min(problem_.cap[i], cap);
    }
    for (std::size_t i = 0, piece = 0; piece + 1 < curve_.pieces().size(); ++piece) {
      const double border = curve_.pieces()[piece + 1].begin;
      while (problem_.node[i] < border) ++i;
      problem_.cap[i] = std::min(problem_.cap[i], cap_after(piece));
    }
    cap_near_rest(1, 0);
    cap_near_rest(count - 2, count - 2);
  }
  /// The first and the last cell at a constant jerk from or to rest: u = j t^3/6.
  void cap_near_rest(std::size_t node, std::size_t cell) {
    double jerk = unlimited;
    for (std::size_t a = 0; a < problem_.axes; ++a)
      jerk = std::min(jerk, problem_.jerk_max[a] / std::abs(problem_.first[cell * problem_.axes + a]));
    if (!(jerk < unlimited)) return;
    const double way = problem_.node[cell + 1] - problem_.node[cell];
    problem_.cap[node] =
        std::min(problem_.cap[node], 0.25 * std::pow(jerk, 2.0 / 3.0) * std::pow(6.0 * way, 4.0 / 3.0));
  }

  /// Nodes with one at every border of pieces: the nearest moves there.
  std::vector<double> with_borders(std::vector<double> nodes) const {
    const std::size_t count = nodes.size();
    std::vector<char> taken(count, 0);
    taken.front() = taken.back() = 1;
    for (std::size_t p = 1; p < curve_.pieces().size(); ++p) {
      const double u = curve_.pieces()[p].begin;
      auto i = static_cast<std::size_t>(
          std::lower_bound(nodes.begin(), nodes.begin() + static_cast<std::ptrdiff_t>(count), u) - nodes.begin());
      if (i > 0 && (i == count || u - nodes[i - 1] < nodes[i] - u)) --i;
      if (taken[i] != 0) {
        nodes.push_back(u);
      } else {
        nodes[i] = u;
        taken[i] = 1;
      }
    }
    std::sort(nodes.begin(), nodes.end());
    const double least = 1e-9 * curve_.length() / static_cast<double>(count);
    nodes.erase(std::unique(nodes.begin(), nodes.end(), [&](double a, double b) { return b - a < least; }),
                nodes.end());
    return nodes;
  }

  /// A slow motion, u = L (t - sin(2 pi t)/(2 pi)) over the whole time.
  void first_guess() {
    double time = 0.0;
    for (std::size_t p = 0; p < curve_.pieces().size(); ++p) {
      const SmoothPath::Piece& piece = curve_.pieces()[p];
      const int places = piece.spline >= 0 ? 8 : 1;  // a spline bends more in some than in others
      for (int i = 0; i < places; ++i) {
        const double u = piece.begin + (i + 0.5) / places * piece.length;
        time += piece.length / places / std::sqrt(cap_at(p, curve_.at(piece, u)));
      }
    }
    time += 50.0 * free_.period;
    if (!(time < static_cast<double>(nodes_max) * free_.period)) return;
    const auto cells = std::max<std::size_t>(60, static_cast<std::size_t>(0.5 * time / free_.period));
    std::vector<double> nodes(cells + 1);
    constexpr double turn = 2.0 * std::numbers::pi;
    for (std::size_t i = 0; i <= cells; ++i) {
      const double t = static_cast<double>(i) / static_cast<double>(cells);
      nodes[i] = curve_.length() * (t - std::sin(turn * t) / turn);
    }
    nodes.back() = curve_.length();
    std::vector<double> speed2(nodes.size());
    for (std::size_t i = 0; i <= cells; ++i) {
      const double v = 1.0 - std::cos(turn * static_cast<double>(i) / static_cast<double>(cells));
      speed2[i] = v * v;
    }
    const double scale = curve_.length() * curve_.length() / (time * time);
    for (double& x : speed2) x *= scale;
    move_to(with_borders(nodes), nodes, speed2);
  }

  /// Takes nodes with the squared speeds of old ones, slower as far as the bounds need.
  bool move_to(std::vector<double> nodes, const std::vector<double>& old, const std::vector<double>& old_x) {
    std::vector<double> x(nodes.size(), 0.0);
    for (std::size_t i = 1, c = 0; i + 1 < nodes.size(); ++i) {
      while (old[c + 1] < nodes[i]) ++c;
      const double f = (nodes[i] - old[c]) / (old[c + 1] - old[c]);
      x[i] = (1.0 - f) * old_x[c] + f * old_x[c + 1];
    }
    set_nodes(std::move(nodes));
    for (std::size_t i = 1; i + 1 < x.size(); ++i) x[i] = std::min(x[i], 0.95 * problem_.cap[i]);
    for (int i = 0; i < 200 && !problem_.holds(x); ++i) {
      for (double& v : x) v *= 0.8;
    }
    x_ = std::move(x);
    return problem_.holds(x_);
  }

  /// Times of the nodes, s.
  std::vector<double> times() const {
    std::vector<double> time(problem_.node.size(), 0.0);
    for (std::size_t c = 0; c + 1 < time.size(); ++c)
      time[c + 1] =
          time[c] + 2.0 * (problem_.node[c + 1] - problem_.node[c]) / (std::sqrt(x_[c]) + std::sqrt(x_[c + 1]));
    return time;
  }
  /// The parameter at even times.
  std::vector<double> at_even_times(const std::vector<double>& time, std::size_t count) const {
    std::vector<double> result(count + 1, 0.0);
    for (std::size_t k = 1, c = 0; k < count; ++k) {
      const double t = time.back() * static_cast<double>(k) / static_cast<double>(count);
      while (time[c + 1] < t) ++c;
      const double v = std::sqrt(x_[c]), slope = (x_[c + 1] - x_[c]) / (problem_.node[c + 1] - problem_.node[c]);
      const double since = t - time[c];
      result[k] = std::min(problem_.node[c] + (v + 0.25 * slope * since) * since, problem_.node[c + 1]);
    }
    result.back() = curve_.length();
    return result;
  }
  /// Nodes a sample period apart in time.
  bool refine() {
    const std::vector<double> time = times();
    const auto count = static_cast<std::size_t>(std::ceil(time.back() / free_.period));
    if (count < 4 || count > nodes_max) return false;
    std::vector<double> nodes = at_even_times(time, count);
    const std::vector<double> old = problem_.node, old_x = x_;
    return move_to(with_borders(std::move(nodes)), old, old_x);
  }

  /// The largest uses of limits by samples.
  struct Uses {
    double velocity = 0.0, acceleration = 0.0, jerk = 0.0;
    bool hold() const { return std::max({velocity, acceleration, jerk}) <= 1.0 + 1e-9; }
  };
  Uses uses_of(const std::vector<double>& position) const {
    const std::size_t count = position.size() / problem_.axes;
    Uses uses;
    const double rate = 1.0 / free_.period;
    for (std::size_t a = 0; a < problem_.axes; ++a) {
      const Axis& axis = free_.machine.axes[a];
      double before = free_.path.point(first_)[a], velocity = 0.0, acceleration = 0.0;
      for (std::size_t k = 0; k < count + 3; ++k) {
        const double now = position[std::min(k, count - 1) * problem_.axes + a];
        const double v = (now - before) * rate, b = (v - velocity) * rate, jerk = (b - acceleration) * rate;
        before = now;
        velocity = v;
        acceleration = b;
        uses.velocity = std::max(uses.velocity, std::abs(v) / axis.velocity_max);
        uses.acceleration = std::max({uses.acceleration, std::abs(b) / axis.acceleration_max,
                                      std::abs(axis.mass * b + axis.damping * v) / axis.force_max});
        uses.jerk = std::max(uses.jerk, std::abs(jerk) / axis.jerk_max);
      }
    }
    return uses;
  }
  std::size_t least_count() const { return static_cast<std::size_t>(std::ceil(times().back() / free_.period - 1e-9)); }
  /// Slower as a whole, until the limits hold.
  std::optional<AlongRun> stretched() const {
    std::size_t count = least_count();
    for (int i = 0; i < 20; ++i) {
      AlongRun run = samples_of(times(), count);
      const Uses uses = uses_of(run.position);
      if (uses.hold()) return run;
      const double more = std::max({uses.velocity, std::sqrt(uses.acceleration), std::cbrt(uses.jerk)});
      count = std::max(count + 1, static_cast<std::size_t>(static_cast<double>(count) * std::min(more, 1.05)));
    }
    return {};
  }
  AlongRun samples_of(const std::vector<double>& time, std::size_t count) const {
    AlongRun run;
    const std::vector<double> u = at_even_times(time, count);
    for (std::size_t k = 1; k <= count; ++k) {
      const PathPlace place = curve_.at(curve_.pieces()[curve_.piece_at(u[k])], u[k]);
      run.position.insert(run.position.end(), place.position.begin(),
                          place.position.begin() + static_cast<std::ptrdiff_t>(problem_.axes));
    }
    std::copy_n(free_.path.point(last_ + 1), problem_.axes,
                run.position.end() - static_cast<std::ptrdiff_t>(problem_.axes));
    std::size_t k = 0;
    for (const SmoothPath::Piece& piece : curve_.pieces()) {
      for (std::size_t b = piece.first; b <= piece.last && b < last_; ++b) {
        const double end = curve_.end_of(piece, b);
        while (u[k + 1] < end) ++k;
        run.passes.push_back(static_cast<double>(k) + (end - u[k]) / (u[k + 1] - u[k]));
      }
    }
    return run;
  }

  const FreePath& free_;
  const Deadline& deadline_;
  const std::size_t first_, last_;
  const SmoothPath curve_;
  std::vector<Caps> caps_;
  PathSpeed problem_;
  std::vector<double> x_;
};

}  // namespace

std::optional<AlongRun> along_run(const FreePath& free, std::size_t first, std::size_t last, std::size_t most,
                                  const Deadline& deadline) {
  for (std::size_t b = first; b < last; ++b) {
    const Joint joint = free.path.joint[b];
    if (joint == Joint::stop || (joint != Joint::straight && free.path.tolerance[b] < least_tolerance)) return {};
  }
  return Run(free, first, last, deadline).plan(most);
}

}  // namespace accdec
