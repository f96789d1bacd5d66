#include <algorithm>
#include <cmath>

#include <accdec/estimate/planners.hpp>
#include <accdec/estimate/segments.hpp>

namespace accdec {
namespace {

/// A segment with its squares of speeds, m^2/s^2.
struct KlipperMove {
  double length = 0.0, acceleration = 0.0;
  double cruise = 0.0;       // largest
  double gain = 0.0;         // most that the segment can add
  double gentle_gain = 0.0;  // the same with the part of the acceleration that minimum_cruise_ratio leaves
  double start = 0.0;        // largest at its start
  double gentle_start = 0.0;
  double start_planned = 0.0, cruise_planned = -1.0, end_planned = 0.0;  // cruise below 0: that of the move before
};

double klipper_segments(const ControlMove& arc, double resolution) {
  return std::floor(arc.length / resolution);
}

KlipperMove klipper_move(const Segment& segment, const ControlSettings& settings) {
  KlipperMove move;
  move.length = segment.length;
  double speed = std::min(segment.rapid ? unlimited : segment.feed, settings.at("max_velocity"));
  move.acceleration = settings.at("max_accel");
  double gentle = move.acceleration * (1.0 - settings.at("minimum_cruise_ratio"));
  if (const double z = std::abs(segment.direction[2]); z > 0.0) {
    speed = std::min(speed, settings.at("max_z_velocity") / z);
    move.acceleration = std::min(move.acceleration, settings.at("max_z_accel") / z);
    gentle = std::min(gentle, move.acceleration);
  }
  move.cruise = speed * speed;
  move.gain = 2.0 * move.length * move.acceleration;
  move.gentle_gain = 2.0 * move.length * gentle;
  return move;
}

/// The largest speed at the joint: of a circle that leaves it by the junction deviation, and of one that meets both
/// segments before their middles.
void set_klipper_joint(const KlipperMove& before, const Segment& in, KlipperMove& move, const Segment& out,
                       double deviation) {
  double start = std::min({move.cruise, before.cruise, before.start + before.gain});
  const double cosine = in.direction.dot(out.direction);
  // Sine and cosine of half the angle between the legs.
  const double sine_half = std::sqrt(std::max(0.0, 0.5 * (1.0 + cosine)));
  const double cosine_half = std::sqrt(std::max(0.0, 0.5 * (1.0 - cosine)));
  if (sine_half < 1.0 && cosine_half > 0.0) {
    const double circle = deviation * sine_half / (1.0 - sine_half);
    const double middle = 0.25 * sine_half / cosine_half;
    start = std::min(
        {start, circle * move.acceleration, circle * before.acceleration, middle * move.gain, middle * before.gain});
  }
  move.start = start;
  move.gentle_start = std::min(start, before.gentle_start + before.gentle_gain);
}

/// From the last move back: the speeds from which a stop is possible, and the peaks between speeding up and braking.
void plan_speeds(std::vector<KlipperMove>& moves) {
  double next = 0.0, gentle_next = 0.0, peak = 0.0;
  int without_cruise = 0;
  for (std::size_t i = moves.size(); i-- > 0;) {
    KlipperMove& move = moves[i];
    const double reachable = next + move.gain, gentle_reachable = gentle_next + move.gentle_gain;
    const double start = std::min(move.start, reachable);
    const double gentle_start = std::min(move.gentle_start, gentle_reachable);
    ++without_cruise;
    if (gentle_start < gentle_reachable) {  // the move can speed up
      if (gentle_start + move.gentle_gain > gentle_next || without_cruise > 1)
        peak = 0.5 * (gentle_start + gentle_reachable);
      move.cruise_planned = std::min({0.5 * (start + reachable), move.cruise, peak});
      without_cruise = 0;
    }
    move.start_planned = start;
    move.end_planned = next;
    next = start;
    gentle_next = gentle_start;
  }
}

double klipper_run(std::vector<KlipperMove>& moves) {
  plan_speeds(moves);
  double time = 0.0, cruise_before = 0.0;
  for (const KlipperMove& move : moves) {
    const double cruise = move.cruise_planned < 0.0 ? std::min(cruise_before, move.start_planned) : move.cruise_planned;
    const double start = std::sqrt(std::min(move.start_planned, cruise));
    const double end = std::sqrt(std::min(move.end_planned, cruise)), top = std::sqrt(cruise);
    const double ramps = (2.0 * cruise - start * start - end * end) / (2.0 * move.acceleration);
    time += (2.0 * top - start - end) / move.acceleration + (move.length - ramps) / top;
    cruise_before = cruise;
  }
  return time;
}

}  // namespace

double klipper_time(const std::vector<ControlMove>& moves, const ControlSettings& settings) {
  const double corner = settings.at("square_corner_velocity");
  const double deviation = corner * corner * (std::sqrt(2.0) - 1.0) / settings.at("max_accel");
  const std::vector<Segment> segments = segments_of(moves, klipper_segments, settings.at("resolution"), false);
  std::vector<KlipperMove> run;
  double time = 0.0;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    run.push_back(klipper_move(segments[i], settings));
    if (run.size() > 1) set_klipper_joint(run[run.size() - 2], segments[i - 1], run.back(), segments[i], deviation);
    if (!segments[i].rests) continue;
    time += klipper_run(run) + segments[i].dwell;
    run.clear();
  }
  return time;
}

}  // namespace accdec
