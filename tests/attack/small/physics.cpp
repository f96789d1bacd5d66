#include "physics.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace accdec::attack {
namespace {

constexpr double distance_floor = 1e-12;  // m; what is nearer counts as there
constexpr int frequencies = 1000;         // of a band

struct Legs {
  std::vector<double> in, out;  // m/s
};

std::vector<double> scaled(std::vector<double> v, double length) {
  double square = 0.0;
  for (const double x : v) square += x * x;
  for (double& x : v) x *= length / std::sqrt(square);
  return v;
}

Legs legs_of(const TaskCorner& corner, std::size_t axes) {
  const double in = corner.geometry().feed_in, out = corner.geometry().feed_out;
  if (const auto* d = std::get_if<DirectedLegs>(&corner.legs())) return {scaled(d->in, in), scaled(d->out, out)};
  const auto& p = std::get<PlanarLegs>(corner.legs());
  const double turn = (p.turn == Turn::left ? 1.0 : -1.0) * (std::numbers::pi - p.angle);
  Legs legs{std::vector<double>(axes, 0.0), std::vector<double>(axes, 0.0)};
  legs.in[0] = in * std::cos(p.heading), legs.in[1] = in * std::sin(p.heading);
  legs.out[0] = out * std::cos(p.heading + turn), legs.out[1] = out * std::sin(p.heading + turn);
  return legs;
}

/// Taps of the control's own smoothing.
std::vector<double> smoothing_of(const Task& task) {
  return task.machine.prefilter_taps.empty() ? std::vector<double>{1.0} : task.machine.prefilter_taps;
}

/// Every sample is the smoothing's mean of the last ones.
std::vector<double> smoothed(const std::vector<double>& command, const std::vector<double>& smoothing) {
  std::vector<double> result(command.size(), 0.0);
  for (std::size_t s = 0; s < command.size(); ++s) {
    for (std::size_t j = 0; j < smoothing.size() && j <= s; ++j) result[s] += smoothing[j] * command[s - j];
  }
  return result;
}

/// Velocity of an axis behind its servo. A position control changes its following error e by e' = v - Kv e, here
/// without feedforward, while the command's velocity v is constant for a sample.
std::vector<double> followed(const std::vector<double>& command, const Axis& axis, double period) {
  if (!axis.response_taps.empty()) return smoothed(command, axis.response_taps);
  if (axis.servo_gain == unlimited) return command;
  const double left = std::exp(-axis.servo_gain * period);
  std::vector<double> moved;
  double error = 0.0;
  for (const double v : command) {
    const double next = left * error + (1.0 - left) * v / axis.servo_gain;
    moved.push_back(v - (next - error) / period);
    error = next;
  }
  return moved;
}

/// The velocity that a corner commands an axis before the filter: rest, leg 1, gap, leg 2, rest.
std::vector<double> commanded(double in, double out, std::size_t leg, std::size_t delay) {
  const std::size_t rest = leg;
  std::vector<double> command(rest, 0.0);
  command.insert(command.end(), leg, in);
  command.insert(command.end(), delay, 0.0);
  command.insert(command.end(), leg, out);
  command.insert(command.end(), rest, 0.0);
  return command;
}

/// Every unit tap delays the command: its values at each sample.
Rows rows_of(const std::vector<double>& command, std::size_t taps) {
  Rows rows{taps, std::vector<double>(command.size() * taps, 0.0)};
  for (std::size_t s = 0; s < command.size(); ++s) {
    for (std::size_t i = 0; i < taps && i <= s; ++i) rows.values[s * taps + i] = command[s - i];
  }
  return rows;
}

/// Rows of the positions of the blend, from the first to the last given sample, relative to the corner point.
Rows position_rows(const Rows& velocity, double leg_length, double period, std::size_t first, std::size_t last) {
  Rows rows{velocity.taps, {}};
  std::vector<double> way(velocity.taps, -leg_length);
  for (std::size_t s = 0; s <= last; ++s) {
    for (std::size_t i = 0; i < rows.taps; ++i) way[i] += velocity.row(s)[i] * period;
    if (s >= first) rows.values.insert(rows.values.end(), way.begin(), way.end());
  }
  return rows;
}

/// The plane of the legs: x along leg 1, y across it towards leg 2.
struct Plane {
  std::vector<double> x, y;
  double turn;
};
Plane plane_of(const Legs& legs) {
  Plane plane{scaled(legs.in, 1.0), scaled(legs.out, 1.0), 0.0};
  double along = 0.0, across = 0.0;
  for (std::size_t a = 0; a < plane.x.size(); ++a) along += plane.x[a] * plane.y[a];
  for (std::size_t a = 0; a < plane.x.size(); ++a) {
    plane.y[a] -= along * plane.x[a];
    across += plane.y[a] * plane.y[a];
  }
  for (double& y : plane.y) y = across > 1e-24 ? y / std::sqrt(across) : 0.0;
  plane.turn = std::atan2(across > 1e-24 ? std::sqrt(across) : 0.0, along);
  return plane;
}

/// Two rows a sample: the vector with these components by axis, in the plane.
Rows in_plane(const std::vector<Rows>& by_axis, const Plane& plane) {
  const std::size_t taps = by_axis[0].taps;
  Rows rows{taps, std::vector<double>(2 * by_axis[0].values.size(), 0.0)};
  for (std::size_t a = 0; a < by_axis.size(); ++a) {
    for (std::size_t s = 0; s < by_axis[a].size(); ++s) {
      for (std::size_t i = 0; i < taps; ++i) {
        rows.values[(2 * s) * taps + i] += plane.x[a] * by_axis[a].row(s)[i];
        rows.values[(2 * s + 1) * taps + i] += plane.y[a] * by_axis[a].row(s)[i];
      }
    }
  }
  return rows;
}

}  // namespace

double dot(const double* row, const std::vector<double>& taps) {
  double sum = 0.0;
  for (std::size_t i = 0; i < taps.size(); ++i) sum += row[i] * taps[i];
  return sum;
}

int response_order(const Task& task) {
  constexpr double gone = 32.0;  // exp(-32) is 1e-14
  const Axis& axis = task.machine.axes.front();
  const std::size_t servo = std::max<std::size_t>(1, axis.response_taps.size());
  const int loop =
      axis.servo_gain < unlimited ? static_cast<int>(gone / (axis.servo_gain * task.sample_period)) + 1 : 0;
  return static_cast<int>(smoothing_of(task).size() + servo) - 2 + loop;
}

int latency_of(const Task& task) {
  return task.settings ? static_cast<int>(std::lround(task.settings->in_position_latency / task.sample_period)) : 0;
}

bool may_have_width(const Task& task, int order, const std::vector<int>& delays) {
  if (!task.settings) return true;
  const int latency = latency_of(task), most = order + static_cast<int>(smoothing_of(task).size()) - 1 + latency;
  for (std::size_t i = 0; i < delays.size(); ++i) {
    if (delays[i] < latency || delays[i] > most) return false;
    for (std::size_t j = 0; j < delays.size(); ++j) {
      const double faster = task.corners[i].geometry().feed_in, slower = task.corners[j].geometry().feed_in;
      if (faster >= slower && delays[i] < delays[j]) return false;
    }
  }
  return true;
}

Physics::Physics(const Task& task, int order, const std::vector<int>& delays) {
  const auto taps = static_cast<std::size_t>(order) + 1;
  linear.taps = cones.taps = velocities.taps = taps;
  for (std::size_t j = 0; j < task.corners.size(); ++j) add_corner(task, j, order, delays[j]);
  if (task.settings) add_widths(task, delays);
  for (const Mode& mode : task.machine.modes) {
    const int count = mode.frequency_high > mode.frequency_low ? frequencies : 1;
    for (int f = 0; f < count; ++f) {
      const double part = count > 1 ? f / (count - 1.0) : 0.0;
      const double step = 2.0 * std::numbers::pi * task.sample_period *
                          (mode.frequency_low + part * (mode.frequency_high - mode.frequency_low));
      // A unit tap leaves the smoothing's taps, from its own place on.
      const std::vector<double> smoothing = smoothing_of(task);
      double* x = cones.fresh();
      for (std::size_t i = 0; i < taps; ++i) {
        for (std::size_t j = 0; j < smoothing.size(); ++j)
          x[i] += smoothing[j] * std::cos(step * static_cast<double>(i + j)) / mode.residual_max;
      }
      double* y = cones.fresh();
      for (std::size_t i = 0; i < taps; ++i) {
        for (std::size_t j = 0; j < smoothing.size(); ++j)
          y[i] += smoothing[j] * std::sin(step * static_cast<double>(i + j)) / mode.residual_max;
      }
    }
  }
  for (const Rows* rows : {&linear, &cones}) {
    for (const double value : rows->values) most = std::max(most, 2.0 * std::abs(value));
  }
}

void Physics::add_corner(const Task& task, std::size_t j, int order, int delay) {
  const TaskCorner& corner = task.corners[j];
  const std::size_t axes = task.machine.axes.size();
  const Legs legs = legs_of(corner, axes);
  const std::vector<double> smoothing = smoothing_of(task);
  const int longest = order + response_order(task);
  const auto leg = static_cast<std::size_t>(longest) + 4, end = 2 * leg;
  // The last sample of leg 1's command, and everything until leg 2 is at full speed.
  const std::size_t first = end - 1, last = end + static_cast<std::size_t>(longest + delay) + 1;
  std::vector<Rows> velocity, position;
  for (std::size_t a = 0; a < axes; ++a) {
    const Axis& axis = task.machine.axes[a];
    const std::vector<double> command =
        smoothed(commanded(legs.in[a], legs.out[a], leg, static_cast<std::size_t>(delay)), smoothing);
    velocity.push_back(rows_of(followed(command, axis, task.sample_period), linear.taps));
    const double direction = legs.in[a] + legs.out[a];
    add_axis(axis, rows_of(command, linear.taps), velocity[a], task.sample_period, direction < 0.0 ? -1.0 : 1.0);
    const double length = static_cast<double>(leg) * legs.in[a] * task.sample_period;
    position.push_back(position_rows(velocity[a], length, task.sample_period, first, last));
  }
  const Plane plane = plane_of(legs);
  if (corner.error_max) {
    ErrorLimit error{j, *corner.error_max, std::max(*corner.error_max, 1e-9), in_plane(position, plane), 0, 0};
    error.first = static_cast<std::size_t>(std::min(longest, delay));
    error.last = static_cast<std::size_t>(std::max(longest, delay)) + 1;
    for (const double value : error.positions.values) most = std::max(most, 2.0 * std::abs(value) / error.cut_bound);
    errors.push_back(std::move(error));
  }
  if (corner.speed_min <= 0.0) return;
  const Rows flat = in_plane(velocity, plane);
  for (std::size_t s = first; s <= last; ++s) {
    speeds.push_back({velocities.size(), velocities.size() + 1, corner.speed_min, plane.turn});
    velocities.values.insert(velocities.values.end(), flat.row(2 * s), flat.row(2 * s) + 2 * flat.taps);
  }
}

/// The way of leg 1 that is left so many samples after the end of its command: v T sum_i c_i max(i - k, 0) of the
/// command's taps c. A width is at least that of each corner after its delay, and below that of each one sample before.
void Physics::add_widths(const Task& task, const std::vector<int>& delays) {
  const std::vector<double> smoothing = smoothing_of(task);
  const int latency = latency_of(task);
  const auto way = [&](std::size_t corner, int sample, std::size_t tap) {
    double sum = 0.0;
    for (std::size_t j = 0; j < smoothing.size(); ++j)
      sum += smoothing[j] * std::max(0, static_cast<int>(tap + j) - sample);
    return task.corners[corner].geometry().feed_in * sum;
  };
  for (std::size_t i = 0; i < delays.size(); ++i) {
    for (std::size_t j = 0; j < delays.size(); ++j) {
      if (delays[j] == latency || task.corners[i].geometry().feed_in == task.corners[j].geometry().feed_in) continue;
      double* row = linear.fresh();
      double largest = 1e-12;
      for (std::size_t t = 0; t < linear.taps; ++t) {
        row[t] = way(i, delays[i] - latency, t) - way(j, delays[j] - latency - 1, t);
        largest = std::max(largest, std::abs(row[t]));
      }
      for (std::size_t t = 0; t < linear.taps; ++t) row[t] = 1.0 + row[t] / largest;
    }
  }
}

void Physics::add_axis(const Axis& axis, const Rows& velocity, const Rows& moved, double period, double direction) {
  const std::size_t taps = velocity.taps;
  const std::vector<double> zero(taps, 0.0);
  // `now`, `before` and `earlier` weigh the velocities of three samples.
  const auto limit = [&](const Rows& of, std::size_t s, double now, double before, double earlier, double more,
                         double bound) {
    if (!(bound < unlimited)) return;
    const auto v = [&](std::size_t back) { return s >= back ? of.row(s - back) : zero.data(); };
    double* row = linear.fresh();
    double largest = 0.0;
    for (std::size_t i = 0; i < taps; ++i) {
      row[i] = (now * v(0)[i] + before * v(1)[i] + earlier * v(2)[i] + more) / bound;
      largest = std::max(largest, std::abs(row[i]));
    }
    // No taps, being parts of a whole, use it more than its largest entry.
    if (largest < 1.0 - 1e-5) linear.values.resize(linear.values.size() - taps);
  };
  const double a = 1.0 / period, jerk = a / period;
  const double of_now = axis.mass * a + axis.damping, of_before = axis.mass * a;
  for (std::size_t s = 1; s < velocity.size(); ++s) {
    limit(velocity, s, 1.0, 0.0, 0.0, 0.0, axis.velocity_max);
    limit(velocity, s, a, -a, 0.0, 0.0, axis.acceleration_max);
    limit(velocity, s, jerk, -2.0 * jerk, jerk, 0.0, axis.jerk_max);
    // Dry friction is against the motion. It also helps to stop an axis that just stands, which is the same.
    limit(moved, s, of_now, -of_before, 0.0, direction * axis.coulomb, axis.force_max);
  }
  if (!(axis.power_max < unlimited) && !(axis.regeneration_max < unlimited)) return;
  const std::size_t first = velocities.size();
  velocities.values.insert(velocities.values.end(), moved.values.begin(), moved.values.end());
  for (std::size_t s = 1; s < velocity.size(); ++s) {
    const std::size_t now = first + s;
    if (axis.power_max < unlimited) powers.push_back({now, now - 1, of_now, of_before, axis.power_max, 1.0});
    if (axis.regeneration_max < unlimited)
      powers.push_back({now, now - 1, of_now, of_before, axis.regeneration_max, -1.0});
  }
}

double error_at(const ErrorLimit& error, std::size_t k, const std::vector<double>& taps) {
  return std::hypot(dot(error.positions.row(2 * k), taps), dot(error.positions.row(2 * k + 1), taps));
}

double nearest(const ErrorLimit& error, const std::vector<double>& taps) {
  double least = INFINITY;
  for (std::size_t k = 0; 2 * k < error.positions.size(); ++k) least = std::min(least, error_at(error, k, taps));
  return least <= distance_floor ? 0.0 : least;
}

double power_use(const Physics& physics, const PowerLimit& limit, const std::vector<double>& taps) {
  const double now = dot(physics.velocities.row(limit.now), taps),
               before = dot(physics.velocities.row(limit.before), taps);
  return limit.sign * (limit.of_now * now - limit.of_before * before) * now / limit.bound;
}

double speed_use(const Physics& physics, const SpeedLimit& limit, const std::vector<double>& taps) {
  return limit.bound /
         std::hypot(dot(physics.velocities.row(limit.x), taps), dot(physics.velocities.row(limit.y), taps));
}

double worst_use(const Physics& physics, const std::vector<double>& taps) {
  double worst = 0.0;
  for (std::size_t i = 0; i < physics.linear.size(); ++i)
    worst = std::max(worst, std::abs(dot(physics.linear.row(i), taps)));
  for (std::size_t i = 0; i < physics.cones.size(); i += 2)
    worst = std::max(worst, std::hypot(dot(physics.cones.row(i), taps), dot(physics.cones.row(i + 1), taps)));
  for (const PowerLimit& limit : physics.powers) worst = std::max(worst, power_use(physics, limit, taps));
  for (const SpeedLimit& limit : physics.speeds) worst = std::max(worst, speed_use(physics, limit, taps));
  for (const ErrorLimit& error : physics.errors) {
    if (const double distance = nearest(error, taps); distance > 0.0) worst = std::max(worst, distance / error.bound);
  }
  return worst;
}

}  // namespace accdec::attack
