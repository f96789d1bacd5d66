#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include <accdec/machine/response.hpp>
#include <accdec/plan/filters/representative_task.hpp>
#include <accdec/task/equal_corners.hpp>

namespace accdec {
namespace {

Eigen::VectorXd leg(const Toolpath& path, std::size_t b) {
  const auto n = static_cast<Eigen::Index>(path.dimensions());
  return Eigen::Map<const Eigen::VectorXd>(path.point(b + 1), n) - Eigen::Map<const Eigen::VectorXd>(path.point(b), n);
}

TaskCorner task_corner(const std::string& name, const Eigen::VectorXd& in, const Eigen::VectorXd& out, double feed_in,
                       double feed_out) {
  const auto numbers = [](const Eigen::VectorXd& v) { return std::vector<double>(v.data(), v.data() + v.size()); };
  return TaskCorner(name, DirectedLegs{numbers(in), numbers(out)}, feed_in, feed_out);
}

struct Class {
  std::size_t member = 0, count = 0;
};

/// Statistics of a program's blocks, collected once.
struct Survey {
  std::vector<Class> corners;        ///< most frequent first
  std::vector<std::size_t> fastest;  ///< blocks in which some axis is fastest, each once
  double runs = 1.0;                 ///< from rest to rest
};

/// Class of the corner after block b: 10 degrees, headings by fifths of each axis's share, factors of 1.5 in feeds and
/// tolerance.
std::vector<int> class_of(const Toolpath& path, std::size_t b, const Eigen::VectorXd& in, const Eigen::VectorXd& out) {
  const auto logarithm = [](double x) {
    return x > 0.0 && x < unlimited ? static_cast<int>(std::floor(std::log(x) / std::log(1.5))) : -1000;
  };
  const double cosine = -in.dot(out) / (in.norm() * out.norm());
  const double angle = std::acos(std::clamp(cosine, -1.0, 1.0)) * 180.0 / std::numbers::pi;
  std::vector<int> key{static_cast<int>(angle / 10.0), logarithm(in.norm() / path.duration[b]),
                       logarithm(out.norm() / path.duration[b + 1]), logarithm(path.tolerance[b])};
  for (const Eigen::VectorXd* u : {&in, &out}) {
    for (Eigen::Index a = 0; a < u->size(); ++a) key.push_back(static_cast<int>(5.0 * std::abs((*u)[a]) / u->norm()));
  }
  return key;
}

Survey survey(const Toolpath& path) {
  Survey found;
  const std::size_t n = path.dimensions();
  std::map<std::vector<int>, Class> classes;
  std::vector<double> most(n, 0.0);
  found.fastest.assign(n, 0);
  Eigen::VectorXd in, out = leg(path, 0);
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    in = out;
    for (std::size_t a = 0; a < n && path.rapid[b] == 0; ++a) {
      const double speed = std::abs(in[static_cast<Eigen::Index>(a)]) / path.duration[b];
      if (speed > most[a]) most[a] = speed, found.fastest[a] = b;
    }
    if (b + 1 == path.blocks()) break;
    out = leg(path, b + 1);
    if (path.joint[b] == Joint::stop) found.runs += 1.0;
    if (path.joint[b] != Joint::corner || path.rapid[b] != 0 || path.rapid[b + 1] != 0) continue;
    Class& c = classes[class_of(path, b, in, out)];
    if (c.count++ == 0) c.member = b;
  }
  for (const auto& [key, c] : classes) found.corners.push_back(c);
  std::stable_sort(found.corners.begin(), found.corners.end(),
                   [](const Class& a, const Class& b) { return a.count > b.count; });
  std::sort(found.fastest.begin(), found.fastest.end());
  found.fastest.erase(std::unique(found.fastest.begin(), found.fastest.end()), found.fastest.end());
  return found;
}

/// Legs that differ by less than this differ by the rounding of coordinates.
constexpr double coordinate_rounding = 1e-6;

/// The corner with its directions and feeds rounded.
TaskCorner rounded(const TaskCorner& corner) {
  const auto direction = [](const Eigen::VectorXd& u) {
    return Eigen::VectorXd((u / coordinate_rounding).array().round());
  };
  const auto feed = [](double v) {
    const double unit = coordinate_rounding * std::pow(10.0, std::ceil(std::log10(v)));
    return unit * std::round(v / unit);
  };
  const Corner& g = corner.geometry();
  TaskCorner result = task_corner(corner.name, direction(g.direction_in), direction(g.direction_out), feed(g.feed_in),
                                  feed(g.feed_out));
  result.error_max = corner.error_max;
  result.contour_max = corner.contour_max;
  return result;
}

/// m/s, of the axes on one leg, largest first.
std::vector<double> speeds(const Eigen::VectorXd& direction, double feed) {
  std::vector<double> all;
  for (Eigen::Index a = 0; a < direction.size(); ++a) all.push_back(feed * std::abs(direction[a]));
  std::sort(all.rbegin(), all.rend());
  return all;
}

/// Factor by which the first would have to be faster to be as fast as the second on every axis; at least 1. Axes that
/// hardly move do not count.
double faster_by(const std::vector<double>& first, const std::vector<double>& second, double feed) {
  double factor = 1.0;
  for (std::size_t a = 0; a < first.size(); ++a) {
    if (second[a] > 1e-3 * feed) factor = std::max(factor, second[a] / first[a]);
  }
  return factor;
}

/// Merges corners that are equal up to rounding, as fast as the fastest of them.
void gather_alike(Task& task) {
  std::vector<TaskCorner> kept, all = std::move(task.corners);
  for (TaskCorner& corner : all) {
    const auto known = std::find_if(kept.begin(), kept.end(), [&](const TaskCorner& k) {
      return ask_the_same(task.machine, rounded(k), rounded(corner));
    });
    if (known == kept.end()) {
      kept.push_back(std::move(corner));
      continue;
    }
    const Corner &g = known->geometry(), &other = corner.geometry();
    const double in =
        faster_by(speeds(g.direction_in, g.feed_in), speeds(other.direction_in, other.feed_in), g.feed_in);
    const double out =
        faster_by(speeds(g.direction_out, g.feed_out), speeds(other.direction_out, other.feed_out), g.feed_out);
    known->weight += corner.weight;
    known->set_feeds(in * g.feed_in, out * g.feed_out);
  }
  task.corners = std::move(kept);
}

/// Whether some corner starts and stops every axis as fast as the pass does. If this holds up to rounding, the corner
/// is made as fast.
bool starts_as_fast(std::vector<TaskCorner>& corners, const TaskCorner& pass) {
  const Corner& p = pass.geometry();
  for (TaskCorner& corner : corners) {
    const Corner& g = corner.geometry();
    double factor = 1.0;
    for (Eigen::Index a = 0; a < p.axes(); ++a) {
      const double asked = p.feed_in * std::abs(p.direction_in[a]);
      const double there = std::min(g.feed_in * std::abs(g.direction_in[a]), g.feed_out * std::abs(g.direction_out[a]));
      if (asked > 0.0) factor = std::max(factor, asked / there);
    }
    if (!(factor <= 1.0 + coordinate_rounding)) continue;
    corner.set_feeds(factor * g.feed_in, factor * g.feed_out);
    return true;
  }
  return false;
}

}  // namespace

Task representative_task(const Toolpath& path, const Task& task, std::size_t corners_max) {
  Task result = task;
  result.filter.reset();
  result.corners.clear();
  result.machine = program_machine(task.machine, path);
  result.machine.prefilter_taps = task.machine.prefilter_taps;
  give_slowest_servo(result.machine, task.sample_period);
  for (Axis& axis : result.machine.axes) axis = averaging(std::move(axis));
  const Survey found = survey(path);
  result.design.objective = Objective::cycle;
  result.design.runs = found.runs;

  double all = 0.0, kept = 0.0;
  for (std::size_t i = 0; i < found.corners.size(); ++i) {
    all += static_cast<double>(found.corners[i].count);
    if (i < corners_max) kept += static_cast<double>(found.corners[i].count);
  }
  for (std::size_t i = 0; i < std::min(corners_max, found.corners.size()); ++i) {
    const std::size_t b = found.corners[i].member;
    const Eigen::VectorXd u = leg(path, b), w = leg(path, b + 1);
    TaskCorner corner = task_corner(fmt::format("line {}", path.line[b]), u, w, u.norm() / path.duration[b],
                                    w.norm() / path.duration[b + 1]);
    corner.error_max = path.tolerance[b];
    if (path.contour_max < unlimited) corner.contour_max = path.contour_max;
    // The classes kept also represent the others.
    corner.weight = static_cast<double>(found.corners[i].count) * all / kept;
    result.corners.push_back(std::move(corner));
  }
  gather_alike(result);
  for (const std::size_t b : found.fastest) {
    const Eigen::VectorXd u = leg(path, b);
    const double feed = u.norm() / path.duration[b];
    TaskCorner pass = task_corner(fmt::format("pass in line {}", path.line[b]), u, u, feed, feed);
    pass.delay = 0;
    pass.weight = 1e-3;
    if (!starts_as_fast(result.corners, pass)) result.corners.push_back(std::move(pass));
  }
  return result;
}

}  // namespace accdec
