#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <accdec/plan/along/leg_program.hpp>
#include <accdec/plan/along/rests_between.hpp>
#include <accdec/plan/along/stop_runs.hpp>
#include <accdec/plan/along/straight_run.hpp>

namespace accdec {
namespace {

/// Puts a motion together, run by run: straight legs by programs, other runs as they are. The first differences of a
/// run see the end of the one before.
class Legs {
 public:
  Legs(const FreePath& free, const FreeSamples& motion, const Deadline& deadline)
      : free_(free), motion_(motion), deadline_(deadline), n_(free.dimensions()) {
    const auto n = static_cast<std::ptrdiff_t>(n_);
    result_.position.assign(motion.position.begin(), motion.position.begin() + n);
  }

  FreeSamples run() {
    const std::vector<StopRun> runs = stop_runs(free_, motion_);
    for (const StopRun& run : runs) {
      if (!shorten(run)) keep(run);
      if (run.last + 1 < free_.path.blocks()) result_.passes.push_back(static_cast<double>(result_.count(n_) - 1));
    }
    if (changed_)
      rest(motion_.count(n_) - 1 - runs.back().end, free_.path.blocks());
    else
      copy(runs.back().end, motion_.count(n_) - 1);
    return std::move(result_);
  }

 private:
  double axis(const FreeSamples& motion, std::size_t sample, std::size_t a) const {
    return motion.position[sample * n_ + a];
  }
  /// The last steps of the result, or rest.
  LegStart start() const {
    LegStart start{std::vector<double>(2 * n_, 0.0)};
    const std::size_t last = result_.count(n_) - 1;
    for (std::size_t i = 0; i < std::min<std::size_t>(2, last); ++i) {
      for (std::size_t a = 0; a < n_; ++a) {
        const double step = axis(result_, last - i, a) - axis(result_, last - i - 1, a);
        start.steps[i * n_ + a] = step;
        start.rest = start.rest && step == 0.0;
      }
    }
    return start;
  }
  void rest(std::size_t count, std::size_t point) {
    for (std::size_t i = 0; i < count; ++i)
      result_.position.insert(result_.position.end(), free_.path.point(point), free_.path.point(point) + n_);
  }
  void copy(std::size_t begin, std::size_t end) {
    const auto n = static_cast<std::ptrdiff_t>(n_);
    result_.position.insert(result_.position.end(),
                            motion_.position.begin() + static_cast<std::ptrdiff_t>(begin + 1) * n,
                            motion_.position.begin() + static_cast<std::ptrdiff_t>(end + 1) * n);
  }

  /// A straight leg in the least number of samples; false: it is none, or the time is over.
  bool shorten(const StopRun& run) {
    const std::optional<StraightLeg> leg = straight_leg(free_, run.first, run.last);
    if (!leg || deadline_.over()) return false;
    std::vector<double> way;
    for (std::size_t k = run.begin + run.rest; k <= run.end; ++k) {
      double sum = 0.0;
      for (std::size_t a = 0; a < n_; ++a)
        sum += leg->direction[a] * (axis(motion_, k, a) - free_.path.point(run.first)[a]);
      way.push_back(sum);
    }
    if (way.size() < 2) return false;
    const std::size_t before = result_.count(n_);
    rest(run.rest, run.first);
    std::optional<std::vector<double>> done = fewest(run, *leg, way);
    std::optional<std::vector<double>> averaged = averaged_leg(free_, *leg);
    // As short as there is, it is at rest at its ends without the rounding of a filter.
    const std::size_t most = done ? done->size() - 1 : way.size();
    if (averaged && averaged->size() <= most && may_follow(free_, result_.position, first_of(run, *averaged), 0))
      done = std::move(averaged);
    if (!done) {
      result_.position.resize(before * n_);
      return false;
    }
    const auto now = static_cast<double>(result_.count(n_) - 1);
    const AlongRun along = on_line(free_, run.first, run.last, *done);
    result_.position.insert(result_.position.end(), along.position.begin(), along.position.end());
    for (const double pass : along.passes) result_.passes.push_back(now + pass);
    if (!changed_) chain_ = {run, before};
    changed_ = true;
    return true;
  }
  /// The first number of samples for which there is a motion, around that of the motion there is.
  std::optional<std::vector<double>> fewest(const StopRun& run, const StraightLeg& leg,
                                            const std::vector<double>& way) const {
    const LegStart begin = start();
    const std::size_t now = way.size() - 1;
    std::optional<std::vector<double>> best;
    const auto try_count = [&](std::size_t count) {
      std::optional<std::vector<double>> done = leg_in(free_, leg, begin, way, count);
      if (done && may_follow(free_, result_.position, first_of(run, *done), 0)) best = std::move(done);
      return best && best->size() == count + 1;
    };
    // Most legs take two samples less; then three are too many.
    std::size_t good = now + free_.border() - 1, bad = 0;
    for (std::size_t less = 2;; less = less == 2 ? 3 : 2 * less) {
      if (now <= less || deadline_.over()) break;
      if (!try_count(now - less)) {
        bad = now - less;
        break;
      }
      good = now - less;
    }
    if (!best) {
      for (std::size_t count = bad + 1; count <= now + free_.border() - 1; ++count) {
        if (deadline_.over() || try_count(count)) break;
      }
      return best;
    }
    while (good - bad > 1 && !deadline_.over()) {
      const std::size_t middle = bad + (good - bad) / 2;
      (try_count(middle) ? good : bad) = middle;
    }
    return best;
  }

  /// The first samples behind the result, rows.
  std::vector<double> first_of(const StopRun& run) const {
    std::vector<double> rows;
    for (std::size_t i = 1; i <= free_.border(); ++i) {
      const std::size_t k = std::min(run.begin + i, motion_.count(n_) - 1);
      rows.insert(rows.end(), &motion_.position[k * n_], &motion_.position[k * n_] + n_);
    }
    return rows;
  }
  std::vector<double> first_of(const StopRun& run, std::vector<double> done) const {
    done.resize(free_.border() + 1, 1.0);
    return on_line(free_, run.first, run.last, done).position;
  }
  /// The run as it is. If it has to wait for the legs before it as long as they save, they stay as they are, too.
  void keep(const StopRun& run) {
    std::size_t rests = changed_ ? rests_between(free_, result_.position, first_of(run)) : 0;
    if (rests > 0) {
      const std::size_t now = result_.count(n_) - chain_.samples;
      if (now + rests >= run.begin - chain_.run.begin) {
        result_.position.resize(chain_.samples * n_);
        result_.passes.resize(chain_.run.first);
        copy_run(chain_.run.begin, run.begin, chain_.run.first, run.first);
        rests = 0;
      }
    }
    rest(rests, run.first);
    changed_ = false;
    copy_run(run.begin, run.end, run.first, run.last);
  }
  /// Samples of the motion, and the passes of joints first .. end - 1.
  void copy_run(std::size_t from, std::size_t to, std::size_t first, std::size_t end) {
    const auto now = static_cast<double>(result_.count(n_) - 1);
    copy(from, to);
    for (std::size_t b = first; b < end; ++b)
      result_.passes.push_back(motion_.passes[b] - static_cast<double>(from) + now);
  }

  const FreePath& free_;
  const FreeSamples& motion_;
  const Deadline& deadline_;
  const std::size_t n_;
  bool changed_ = false;  // the last run is not that of the motion
  struct {
    StopRun run;
    std::size_t samples = 0;  // of the result before it
  } chain_;                   // the first of these runs
  FreeSamples result_;
};

}  // namespace

FreeSamples with_shortest_legs(const FreePath& free, const FreeSamples& motion, const Deadline& deadline) {
  return Legs(free, motion, deadline).run();
}

}  // namespace accdec
