#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include <accdec/bounds/corner_bound.hpp>
#include <accdec/plan/along/along_run.hpp>
#include <accdec/plan/along/coarse_runs.hpp>
#include <accdec/plan/along/stop_runs.hpp>
#include <accdec/simulate/sample_check.hpp>

namespace accdec {
namespace {

constexpr double tolerance_share = 0.08;  // that control points may lose

/// m: the most by which control points move towards their neighbours, if others are put between them.
double bend(const Machine& machine, double period) {
  double acceleration = 0.0;
  for (const Axis& axis : machine.axes) acceleration = std::hypot(acceleration, acceleration_most(axis));
  return acceleration * period * period / 8.0;
}

/// Whether the joint at the end of a block grants a way off the path.
bool grants(const Toolpath& path, std::size_t block) {
  return path.joint[block] != Joint::stop && path.tolerance[block] > 0.0;
}

double smallest_tolerance(const Toolpath& path) {
  double least = unlimited;
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    if (grants(path, b)) least = std::min(least, path.tolerance[b]);
  }
  return least;
}

/// The path for control points. At stops it rests for so long (s) that no limit sees the runs before and behind at
/// once: each is then a motion by itself. Dwells are added to the motion that is made of them.
Toolpath narrowed(Toolpath path, double by, double rest) {
  path.dwell.clear();
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    if (grants(path, b))
      path.tolerance[b] -= by;
    else if (b + 1 < path.blocks() && path.joint[b] != Joint::straight)
      path.dwell.emplace_back(static_cast<std::uint32_t>(b), rest);
  }
  path.dwell_first = 0.0;
  return path;
}

/// A force is that of an acceleration and of a speed, whose means between control points are not the same.
Machine weakened(Machine machine, double period) {
  for (Axis& axis : machine.axes) {
    if (axis.force_max < unlimited) axis.force_max -= 0.5 * axis.damping * acceleration_most(axis) * period;
  }
  return machine;
}

/// Every other sample of the moves of a motion; at stops it rests as long as limits see.
FreeSamples every_other(const FreePath& fine, const FreeSamples& motion) {
  const std::size_t n = fine.dimensions();
  FreeSamples coarse;
  const auto add = [&](std::size_t k) {
    coarse.position.insert(coarse.position.end(), &motion.position[k * n], &motion.position[k * n] + n);
  };
  for (const StopRun& run : stop_runs(fine, motion)) {
    std::size_t k = run.begin + run.still;
    for (std::size_t i = 0; i < (run.first == 0 ? 1 : fine.border()); ++i) add(k);
    const double start = static_cast<double>(coarse.count(n) - 1) - 0.5 * static_cast<double>(k);
    for (std::size_t b = run.first; b < run.last; ++b) coarse.passes.push_back(start + 0.5 * motion.passes[b]);
    do add(k = std::min(k + 2, run.end));
    while (k < run.end);
    if (run.last + 1 < fine.path.blocks()) coarse.passes.push_back(static_cast<double>(coarse.count(n) - 1));
  }
  return coarse;
}

/// Twice as many control points of the same spline, from rest to rest.
AlongRun refined(const FreeSamples& coarse, const StopRun& run, std::size_t n) {
  AlongRun fine;
  fine.alone = true;
  const std::size_t first = run.begin + run.still;
  const auto x = [&](std::size_t k, std::size_t a) { return coarse.position[std::clamp(k, first, run.end) * n + a]; };
  for (std::size_t k = first; k <= run.end; ++k) {
    for (std::size_t a = 0; a < n; ++a)
      fine.position.push_back((x(std::max(k, first + 1) - 1, a) + 6.0 * x(k, a) + x(k + 1, a)) / 8.0);
    for (std::size_t a = 0; a < n; ++a) fine.position.push_back((x(k, a) + x(k + 1, a)) / 2.0);
  }
  for (std::size_t b = run.first; b < run.last; ++b)
    fine.passes.push_back(2.0 * (coarse.passes[b] - static_cast<double>(first)) + 1.0);
  return fine;
}

/// Whether a run stays in its tube, at its feeds, and within the tolerances of its joints.
bool keeps_path(const FreePath& free, const StopRun& run, const AlongRun& along) {
  constexpr double above_feed = 1.0 + 5e-7;  // the check grants 1e-6
  const std::size_t n = free.dimensions();
  const auto row = [&](std::size_t k) { return k == 0 ? free.path.point(run.first) : &along.position[(k - 1) * n]; };
  const auto off = [&](const double* from, const double* to, const double* x, double most) {
    return !holds(std::sqrt(segment_distance2(from, to, x, n)), most);
  };
  for (std::size_t leg = run.first, k = 1; k <= along.position.size() / n; ++k) {
    double feed = free.feed[leg], step = 0.0;
    while (leg < run.last && along.passes[leg - run.first] <= static_cast<double>(k)) ++leg;
    feed = std::max(feed, free.feed[leg]);
    if (off(free.path.point(leg), free.path.point(leg + 1), row(k), free.radius[leg])) return false;
    for (std::size_t a = 0; a < n; ++a) step = std::hypot(step, row(k)[a] - row(k - 1)[a]);
    if (step > free.period * feed * above_feed) return false;
  }
  for (std::size_t j = run.first; j < run.last; ++j) {
    const double at = along.passes[j - run.first], floor = std::floor(at), f = at - floor;
    const double* const before = row(static_cast<std::size_t>(floor));
    const double* const after = row(std::min(static_cast<std::size_t>(floor) + 1, along.position.size() / n));
    ProgramPoint x{};
    for (std::size_t a = 0; a < n; ++a) x[a] = (1.0 - f) * before[a] + f * after[a];
    const double* const point = free.path.point(j + 1);
    if (off(point, point, x.data(), std::min(free.path.tolerance[j], free.radius[j]))) return false;
  }
  return true;
}

}  // namespace

FreeSamples with_coarse_runs(const FreePath& free, const FreeSamples& motion, const FreeOptions& options,
                             const Deadline& deadline, FreeReport& report) {
  const double period = 2.0 * free.period, least = smallest_tolerance(free.path), loss = bend(free.machine, period);
  if (deadline.over() || !(least < unlimited) || loss > tolerance_share * least) return motion;
  const Toolpath path = narrowed(free.path, loss, static_cast<double>(free.border() - 1) * period);
  const Machine machine = weakened(free.machine, period);
  const FreePath coarse(path, machine, period);
  FreeSamples samples = with_coarse_runs(coarse, every_other(free, motion), options, deadline, report);
  const FreeReport own = shorten_motion(coarse, samples, options, deadline);
  report.programmes += own.programmes;
  report.iterations += own.iterations;
  const std::vector<StopRun> runs = stop_runs(coarse, samples);
  const auto make = [&](std::size_t first, std::size_t last, std::size_t most) -> std::optional<AlongRun> {
    const auto run = std::lower_bound(runs.begin(), runs.end(), first,
                                      [](const StopRun& r, std::size_t block) { return r.first < block; });
    if (run == runs.end() || run->first != first || run->last != last) return {};
    AlongRun fine = refined(samples, *run, free.dimensions());
    if (fine.position.size() / free.dimensions() >= most || !keeps_path(free, *run, fine)) return {};
    return fine;
  };
  return with_runs(free, motion, make);
}

}  // namespace accdec
