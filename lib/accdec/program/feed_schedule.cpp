#include <accdec/program/feed_schedule.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace accdec {
namespace {

FeedPath feed_path(const Toolpath& path) {
  FeedPath feeds;
  const std::size_t n = feeds.dimensions = path.dimensions(), blocks = path.blocks();
  feeds.direction.resize(blocks * n);
  feeds.length.resize(blocks);
  feeds.margin.assign(blocks, 1.0F);
  for (std::size_t b = 0; b < blocks; ++b) {
    const double* p = path.point(b);
    double sum = 0.0;
    for (std::size_t a = 0; a < n; ++a) sum += (p[n + a] - p[a]) * (p[n + a] - p[a]);
    const double length = feeds.length[b] = std::sqrt(sum);
    for (std::size_t a = 0; a < n; ++a) feeds.direction[b * n + a] = (p[n + a] - p[a]) / length;
  }
  return feeds;
}

/// Makes every run last whole samples by slowing its fastest pieces, which no window minds: if all of a run were slowed, as the command stream
/// does else, neighbouring runs would be by different factors, and what just held between them would not.
void round_runs(const Toolpath& path, std::vector<FeedPiece>& pieces, double sample_period) {
  for (std::size_t first = 0; first < pieces.size();) {
    std::size_t last = first;
    double time = 0.0, top = 0.0;
    for (;; ++last) {
      time += pieces[last].length / pieces[last].speed;
      top = std::max(top, pieces[last].speed);
      if (last + 1 == pieces.size()) break;
      const std::uint32_t b = pieces[last].block;
      if (pieces[last].rest > 0.0 || (pieces[last + 1].block != b && ends_leg(path, b))) break;
    }
    const double missing = std::ceil(time / sample_period - 1e-9) * sample_period - time;
    double fastest = 0.0;
    for (std::size_t i = first; i <= last; ++i) fastest += pieces[i].speed >= 0.999 * top ? pieces[i].length / pieces[i].speed : 0.0;
    for (std::size_t i = first; i <= last && missing > 0.0 && fastest > 10.0 * missing; ++i) {
      if (pieces[i].speed >= 0.999 * top) pieces[i].speed *= fastest / (fastest + missing);
    }
    first = last + 1;
  }
}

}  // namespace

Toolpath split_blocks(const Toolpath& path, const std::vector<FeedPiece>& pieces) {
  const std::size_t n = path.dimensions(), count = pieces.size();
  Toolpath out;
  out.axes = path.axes;
  out.dwell_first = path.dwell_first;
  out.begin = path.begin;
  out.empty_moves = path.empty_moves;
  out.points.reserve((count + 1) * n);
  out.duration.reserve(count);
  out.tolerance.reserve(count);
  out.joint.reserve(count);
  out.line.reserve(count);
  out.rapid.reserve(count);
  out.inside_arc.reserve(count);
  std::vector<std::uint32_t> last(path.blocks());  // piece of every block
  out.points.insert(out.points.end(), path.point(0), path.point(0) + n);
  double done = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t b = pieces[i].block;
    const bool ends = i + 1 == count || pieces[i + 1].block != b;
    const double* p = path.point(b);
    done += pieces[i].length;
    if (ends) {
      out.points.insert(out.points.end(), p + n, p + 2 * n);
      done = 0.0;
      last[b] = static_cast<std::uint32_t>(i);
    } else {
      double length2 = 0.0;
      for (std::size_t a = 0; a < n; ++a) length2 += (p[n + a] - p[a]) * (p[n + a] - p[a]);
      const double part = done / std::sqrt(length2);
      for (std::size_t a = 0; a < n; ++a) out.points.push_back(p[a] + part * (p[n + a] - p[a]));
    }
    out.duration.push_back(pieces[i].length / pieces[i].speed);
    out.tolerance.push_back(ends ? path.tolerance[b] : unlimited);
    out.joint.push_back(ends ? path.joint[b] : Joint::straight);
    out.line.push_back(path.line[b]);
    out.rapid.push_back(path.rapid[b]);
    out.inside_arc.push_back(ends ? path.inside_arc[b] : 0);
  }
  for (const auto& [b, time] : path.dwell) out.dwell.emplace_back(last[b], time);
  for (const auto& [b, time] : path.given) out.given.emplace_back(last[b], time);
  for (Toolpath::Passed passed : path.passed) {
    if (passed.block > 0) passed.block = last[passed.block - 1] + 1;
    out.passed.push_back(std::move(passed));
  }
  return out;
}

ScheduledPlan schedule_feeds(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine, int rounds_max) {
  FeedPath feeds = feed_path(path);
  const FeedWindow window(filter, machine, sample_period, path.dimensions());
  const std::size_t blocks = path.blocks();
  std::vector<double> tolerance = path.tolerance, speed(blocks, unlimited);
  std::vector<int> delay(blocks, 0), extra(blocks, 0);
  std::vector<std::uint8_t> hits(blocks, 0), limit_hits(blocks, 0);
  const int apart = filter.order() + 2;  // from this delay on a joint is passed at rest
  const LegFilters filters(filter);
  ScheduledPlan best;
  std::vector<bool> change(blocks, true);
  for (int round = 0;; ++round) {
    FeedCaps caps(path, feeds, filter, window, sample_period);
    for (std::size_t b = 0; b + 1 < blocks; ++b) {
      if (!change[b]) continue;
      if (ends_leg(path, b)) {
        const CornerFeed corner = caps.corner(b, tolerance[b]);
        speed[b] = corner.speed;
        delay[b] = corner.delay;
      } else {
        speed[b] = caps.smooth(b, tolerance[b]);
        delay[b] = 0;
      }
      delay[b] = std::min(std::max(apart, delay[b]), delay[b] + extra[b]);
      change[b] = false;
    }
    const std::vector<FeedPiece> limits = caps.pieces(speed, delay);
    const std::vector<FeedPiece> backward = march_feeds(feeds, window, limits, Walk::backward);
    std::vector<FeedPiece> pieces = march_feeds(feeds, window, backward, Walk::forward);
    round_runs(path, pieces, sample_period);
    ScheduledPlan plan;
    plan.path = split_blocks(path, pieces);
    std::vector<int> delays(pieces.size(), 0);
    for (std::size_t i = 0; i + 1 < pieces.size(); ++i) {
      if (pieces[i + 1].block != pieces[i].block) delays[i] = delay[pieces[i].block];
    }
    const CommandTiming timing(plan.path, sample_period, delays);
    plan.plan.errors.assign(pieces.size(), 0.0);
    SimulationOptions options;
    if (!machine.axes.empty()) options.machine = &machine;
    options.blame = true;
    plan.plan.simulation = simulate_program(timing, filters, 0, pieces.size() - 1, plan.plan.errors, options);
    plan.plan.errors_hold = true;
    std::size_t off = 0;
    for (std::size_t i = 0; i + 1 < pieces.size(); ++i) {
      const std::uint32_t b = pieces[i].block;
      if (pieces[i + 1].block == b || holds(plan.plan.errors[i], path.tolerance[b])) continue;
      plan.plan.errors_hold = false;
      ++off;
      tolerance[b] *= std::clamp(path.tolerance[b] / plan.plan.errors[i], 0.5, 0.97);
      change[b] = true;
      // Where joints act on each other, slower alone may not do; at rest always does.
      hits[b] = static_cast<std::uint8_t>(std::min(hits[b] + 1, 100));
      if (hits[b] > (ends_leg(path, b) ? 2 : 6)) extra[b] += 1 + filter.order() / 8;
    }
    std::vector<std::uint32_t> broken;
    for (const std::uint32_t i : plan.plan.simulation.broken) {
      const std::uint32_t b = pieces[i].block;
      if (broken.empty() || broken.back() != b) broken.push_back(b);
    }
    if (std::getenv("DBG")) {
      double worst = 0; std::string what;
      for (const auto& use : plan.plan.simulation.limits) if (use.utilisation > worst) worst = use.utilisation, what = std::string(to_string(use.kind)) + use.axis + use.corner;
      std::fprintf(stderr, "  round %d: %lld samples, %zu pieces, %zu errors off, %zu broken, worst %.4f %s\n", round, (long long)plan.plan.simulation.samples, pieces.size(), off, broken.size(), worst, what.c_str());
    }
    plan.plan.delays = std::move(delays);
    const bool good = plan.plan.errors_hold && broken.empty();
    best = std::move(plan);
    if (good || round >= rounds_max) return best;
    for (const std::uint32_t b : broken) {
      // What is commanded within the filter's length before acts, too.
      double back = 0.0;
      for (std::size_t i = b + 1; i-- > 0 && back < window.reach();) {
        if (i == b) limit_hits[i] = static_cast<std::uint8_t>(std::min(limit_hits[i] + 1, 100));
        feeds.margin[i] = std::max(0.02F, feeds.margin[i] * (limit_hits[b] > 8 ? 0.8F : limit_hits[b] > 4 ? 0.92F : 0.97F));
        change[i] = true;
        if (i > 0) change[i - 1] = true;
        back += path.duration[i];
      }
    }
  }
}

}  // namespace accdec
