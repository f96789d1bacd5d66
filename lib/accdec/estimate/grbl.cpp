#include <algorithm>
#include <cmath>

#include <accdec/estimate/planners.hpp>
#include <accdec/estimate/segments.hpp>

namespace accdec {
namespace {

/// Squares of speeds in m^2/s^2.
struct GrblBlock {
  double length = 0.0, acceleration = 0.0;
  double speed = 0.0;  // m/s, largest
  double entry = 0.0;  // largest at its start
};

double grbl_segments(const ControlMove& arc, double tolerance) {
  const double chord = std::sqrt(tolerance * std::max(2.0 * arc.radius - tolerance, 0.0));
  return chord > 0.0 ? std::floor(std::abs(0.5 * arc.angle * arc.radius) / chord) : 1.0;
}

/// Moves end on whole steps of every axis, so the directions of short ones are rounded.
std::vector<Segment> on_steps(const std::vector<Segment>& segments, const Vector& begin, double step) {
  std::vector<Segment> rounded;
  Vector at = begin, last = begin;
  const auto to_step = [&](double value) { return step * std::round(value / step); };
  last = last.unaryExpr(to_step);
  for (const Segment& segment : segments) {
    at += segment.length * segment.direction;
    const Vector to = at.unaryExpr(to_step), way = to - last;
    const double length = way.norm();
    if (length > 0.25 * step) {
      rounded.push_back(segment);
      rounded.back().direction = way / length;
      rounded.back().length = length;
      last = to;
    } else if (!rounded.empty()) {
      rounded.back().dwell += segment.dwell;
      rounded.back().rests = rounded.back().rests || segment.rests;
    }
  }
  return rounded;
}

GrblBlock grbl_block(const Segment& segment, const ControlLimits& limits) {
  GrblBlock block;
  block.length = segment.length;
  block.acceleration = along(segment.direction, limits.acceleration);
  block.speed = along(segment.direction, limits.velocity);
  if (!segment.rapid) block.speed = std::min(block.speed, segment.feed);
  return block;
}

/// The largest square of the speed at a joint: of a circle that leaves it by the junction deviation, within the
/// acceleration that the axes have towards its centre.
double joint_speed(const Segment& in, const Segment& out, const ControlLimits& limits, double deviation) {
  const double cosine = -in.direction.dot(out.direction);  // of the angle between the legs
  if (cosine > 0.999999) return 0.0;
  if (cosine < -0.999999) return unlimited;
  const double acceleration = along((out.direction - in.direction).normalized(), limits.acceleration);
  const double sine_half = std::sqrt(0.5 * (1.0 - cosine));
  return acceleration * deviation * sine_half / (1.0 - sine_half);
}

/// A block's end is planned when its execution begins: the buffer's last block then still ends at rest.
double grbl_run(const std::vector<GrblBlock>& blocks, std::size_t buffer) {
  double time = 0.0, speed = 0.0;  // speed: its square where a block begins
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    double next = 0.0;
    for (std::size_t i = std::min(blocks.size(), b + buffer); --i > b;)
      next = std::min(blocks[i].entry, next + 2.0 * blocks[i].acceleration * blocks[i].length);
    const GrblBlock& block = blocks[b];
    next = std::min(next, speed + 2.0 * block.acceleration * block.length);
    time += trapezoid_time(block.length, std::sqrt(speed), block.speed, std::sqrt(next), block.acceleration);
    speed = next;
  }
  return time;
}

}  // namespace

double grbl_time(const std::vector<ControlMove>& moves, const ControlLimits& limits, const ControlSettings& settings) {
  const double deviation = settings.at("junction_deviation");
  const std::vector<Segment> segments = on_steps(segments_of(moves, grbl_segments, settings.at("arc_tolerance"), true),
                                                 moves.front().from, 1.0 / settings.at("steps_per_mm"));
  // One place of the ring stays empty.
  const auto buffer = static_cast<std::size_t>(settings.at("block_buffer_size")) - 1;
  std::vector<GrblBlock> run;
  double time = 0.0;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    GrblBlock block = grbl_block(segments[i], limits);
    if (!run.empty()) {
      const double speed = std::min(block.speed, run.back().speed);
      block.entry = std::min(speed * speed, joint_speed(segments[i - 1], segments[i], limits, deviation));
    }
    run.push_back(block);
    if (!segments[i].rests) continue;
    time += grbl_run(run, buffer) + segments[i].dwell;
    run.clear();
  }
  return time;
}

}  // namespace accdec
