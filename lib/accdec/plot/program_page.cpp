#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include <accdec/machine/limits.hpp>
#include <accdec/plot/html.hpp>
#include <accdec/plot/html_parts.hpp>
#include <accdec/plot/program_page.hpp>

namespace accdec {
namespace {

constexpr std::int64_t page_points_max = 40'000;
constexpr std::array<double, 7> turns{0.0, 5.0, 20.0, 45.0, 75.0, 105.0, 180.0};

/// Follows a motion along its path: the block that a sample lies on, by the projection onto it.
class Follower {
 public:
  explicit Follower(const Toolpath& path) : path_(path), n_(path.dimensions()) {}

  /// Moves on to the block of a position.
  void follow(const double* x) {
    for (;; ++block_) {
      const bool last = block_ + 1 == path_.blocks();
      double along = 0.0, length2 = 0.0, from_next = 0.0;
      const double* p = path_.point(block_);
      for (std::size_t a = 0; a < n_; ++a) {
        const double u = p[n_ + a] - p[a];
        along += (x[a] - p[a]) * u;
        length2 += u * u;
        if (!last) from_next += (x[a] - p[n_ + a]) * (p[2 * n_ + a] - p[n_ + a]);
      }
      part_ = std::clamp(along / length2, 0.0, 1.0);
      // On this block until past its end or, where the corner is cut, on the way along the next.
      const bool leaving = part_ > 0.5 && from_next > 0.0;
      if (last || (along < length2 && !leaving)) return;
    }
  }
  std::size_t block() const { return block_; }
  /// The joint nearer to the sample: at the end of this block, or before it (-1: the start of the program).
  std::ptrdiff_t joint() const { return static_cast<std::ptrdiff_t>(block_) - (part_ < 0.5 ? 1 : 0); }
  double feed() const {
    double length2 = 0.0;
    const double* p = path_.point(block_);
    for (std::size_t a = 0; a < n_; ++a) length2 += (p[n_ + a] - p[a]) * (p[n_ + a] - p[a]);
    return std::sqrt(length2) / path_.duration[block_];
  }

 private:
  const Toolpath& path_;
  const std::size_t n_;
  std::size_t block_ = 0;
  double part_ = 0.0;
};

double turn_at(const Toolpath& path, std::size_t b) {
  const std::size_t n = path.dimensions();
  const double* p = path.point(b);
  double dot = 0.0, in2 = 0.0, out2 = 0.0;
  for (std::size_t a = 0; a < n; ++a) {
    const double u = p[n + a] - p[a], w = p[2 * n + a] - p[n + a];
    dot += u * w;
    in2 += u * u;
    out2 += w * w;
  }
  return std::acos(std::clamp(dot / std::sqrt(in2 * out2), -1.0, 1.0)) * 180.0 / std::numbers::pi;
}

double norm(const double* v, std::size_t n) {
  double sum = 0.0;
  for (std::size_t a = 0; a < n; ++a) sum += v[a] * v[a];
  return std::sqrt(sum);
}

/// The limits of one machine, and how much of each a sample uses.
class Uses {
 public:
  Uses(const Machine& machine, double period) : period_(period) {
    for (const Axis& axis : machine.axes) axes_.push_back({&axis, AxisSampler(axis, period)});
  }
  /// Index in `axis_limits` of the limit most used by the next sample; -1 if none by 98 %.
  int next(const double* v) {
    int binding = -1;
    double most = 0.98;
    for (Followed& followed : axes_) {
      const AxisState state = followed.sampler.next(*v, (*v - followed.velocity) / period_);
      for (std::size_t i = 0; i < axis_limits.size(); ++i) {
        const double use = axis_limits[i].value(state) / (followed.axis->*axis_limits[i].bound);
        if (use > most) most = use, binding = static_cast<int>(i);
      }
      followed.velocity = *v++;
    }
    return binding;
  }

 private:
  struct Followed {
    const Axis* axis;
    AxisSampler sampler;
    double velocity = 0.0;  ///< m/s, of the last sample
  };
  double period_;
  std::vector<Followed> axes_;
};

/// The two axes of the largest extent.
std::array<std::size_t, 2> page_view_of(const Toolpath& path) {
  const std::size_t n = path.dimensions();
  std::vector<std::pair<double, std::size_t>> extent;
  for (std::size_t a = 0; a < n; ++a) {
    double low = INFINITY, high = -INFINITY;
    for (std::size_t i = 0; i <= path.blocks(); ++i) {
      low = std::min(low, path.point(i)[a]);
      high = std::max(high, path.point(i)[a]);
    }
    extent.emplace_back(low - high, a);
  }
  std::stable_sort(extent.begin(), extent.end());
  if (n == 1) return {0, 0};
  return {std::min(extent[0].second, extent[1].second), std::max(extent[0].second, extent[1].second)};
}

std::string arrays(const Toolpath& path, const Machine& machine, const PageMotion& motion, std::int64_t count) {
  const std::array<std::size_t, 2> view = page_view_of(path);
  const std::int64_t every = std::max<std::int64_t>(1, (count + page_points_max - 1) / page_points_max);
  Uses uses(machine, motion.sample_period);
  std::string t, x, y, v, l;
  int binding = -1;
  motion.samples([&](std::int64_t k, const double* at, const double* velocity) {
    binding = std::max(binding, uses.next(velocity));
    if (k % every != 0 && k + 1 != count) return;
    t += fmt::format("{:.6g},", static_cast<double>(k) * motion.sample_period);
    x += fmt::format("{:.4f},", at[view[0]] * 1e3);
    y += fmt::format("{:.4f},", path.dimensions() > 1 ? at[view[1]] * 1e3 : 0.0);
    v += fmt::format("{:.5g},", norm(velocity, path.dimensions()) * 1e3);
    l += fmt::format("{},", binding);
    binding = -1;
  });
  std::string names;
  for (const AxisLimit& limit : axis_limits) names += fmt::format("\"{}\",", to_string(limit.kind));
  return fmt::format("const D={{t:[{}],x:[{}],y:[{}],v:[{}],l:[{}],names:[{}],ax:[\"{}\",\"{}\"]}};\n", t, x, y, v, l,
                     names, path.axis_name(view[0]), path.axis_name(view[1]));
}

std::string title_of(const std::string& program, double cycle_time, const char* plan) {
  return fmt::format("{}: {:.6g} s, plan {}", program, cycle_time, plan);
}

}  // namespace

std::vector<CornerLoss> time_lost(const Toolpath& path, const PageMotion& motion) {
  std::vector<CornerLoss> classes;
  for (std::size_t i = 0; i + 1 < turns.size(); ++i) classes.push_back({turns[i], turns[i + 1], false, 0, 0.0});
  classes.push_back({0.0, 180.0, true, 0, 0.0});
  std::vector<std::uint8_t> of_joint(path.blocks(), 0);
  for (std::size_t b = 0; b < path.blocks(); ++b) {
    std::size_t i = classes.size() - 1;
    if (path.joint[b] != Joint::stop) {
      const double turn = turn_at(path, b);
      i = 0;
      while (i + 2 < turns.size() && turn > turns[i + 1]) ++i;
    }
    of_joint[b] = static_cast<std::uint8_t>(i);
    ++classes[i].count;
  }
  Follower follower(path);
  motion.samples([&](std::int64_t k, const double* x, const double* v) {
    if (k == 0) return;
    follower.follow(x);
    const double slower = 1.0 - norm(v, path.dimensions()) / follower.feed();
    const std::ptrdiff_t joint = follower.joint();
    const std::size_t i = joint < 0 ? classes.size() - 1 : of_joint[static_cast<std::size_t>(joint)];
    classes[i].time += slower * motion.sample_period;
  });
  return classes;
}

std::string program_page(const Toolpath& programmed, const Machine& machine, const PageMotion& motion) {
  std::int64_t count = 0;
  motion.samples([&](std::int64_t, const double*, const double*) { ++count; });
  std::vector<std::vector<std::string>> rows;
  for (const CornerLoss& loss : time_lost(programmed, motion)) {
    if (loss.count == 0) continue;
    rows.push_back(
        {loss.stop ? "stops, start and end" : fmt::format("{:g} to {:g} degrees", loss.turn_from, loss.turn_to),
         fmt::format("{}", loss.count), fmt::format("{:.4f}", loss.time),
         fmt::format("{:.3f}", 1e3 * loss.time / static_cast<double>(loss.count))});
  }
  std::string page = html_head(motion.title);
  page +=
      "<p>The path has the colour of its speed; the speed over time that of the limit that binds. Wheel or two "
      "fingers: "
      "zoom. Drag: move. Double click: everything. The pointer tells time, place and speed.</p>\n"
      "<canvas id=\"path\"></canvas>\n<p id=\"info\">&nbsp;</p>\n<canvas id=\"speed\"></canvas>\n"
      "<p id=\"legend\"></p>\n<h2>Time lost against the programmed feed</h2>\n";
  page += html_table({{"turn", "joints", "lost, s", "lost by each, ms"}, rows});
  page += "<script>\n" + arrays(programmed, machine, motion, count) + std::string(program_script) + "</script>\n" +
          html_foot();
  return page;
}

std::string program_page(const Toolpath& programmed, const Machine& machine, const ProgramResult& result) {
  return program_page(programmed, program_machine(machine, programmed),
                      {title_of(result.program, result.cycle_time, result.legs.single() ? "fixed" : "per-leg"),
                       result.sample_period, [&](const SampleVisitor& visit) { visit_samples(result, visit); }});
}

std::string program_page(const Toolpath& programmed, const Machine& machine, const ProfileResult& result) {
  return program_page(programmed, program_machine(machine, programmed),
                      {title_of(result.program, result.cycle_time, "profiles"), result.sample_period,
                       [&](const SampleVisitor& visit) { visit_profile_samples(result, visit); }});
}

}  // namespace accdec
