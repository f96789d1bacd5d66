#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include <accdec/plan/along/along_run.hpp>
#include <accdec/plan/along/rests_between.hpp>
#include <accdec/plan/along/smooth_path.hpp>
#include <accdec/plan/along/stop_runs.hpp>
#include <accdec/plan/along/straight_run.hpp>

namespace accdec {
namespace {

/// Makes a motion along blocks first .. last; one of `most` samples or more is of no use.
using MakeRun = std::function<std::optional<AlongRun>(std::size_t first, std::size_t last, std::size_t most)>;

constexpr std::size_t never = std::size_t{1} << 60;  // samples

/// Puts a motion together, run by run, from another and from runs along the path.
class Joining {
 public:
  Joining(const FreePath& free, const FreeSamples& motion, MakeRun make)
      : free_(free),
        motion_(motion),
        make_(std::move(make)),
        n_(free.dimensions()),
        last_move_(last_move(free, motion)) {
    result_.position.assign(motion.position.begin(), motion.position.begin() + static_cast<std::ptrdiff_t>(n_));
  }

  FreeSamples run() {
    for (const StopRun& run : stop_runs(free_, motion_))
      runs_.push_back({run, make_(run.first, run.last, run.end - run.begin - run.rest)});
    choose();
    for (std::size_t i = 0; i < runs_.size(); ++i) take(i);
    if (!runs_.empty() && runs_.back().chosen)
      rest(motion_.count(n_) - 1 - last_move_, free_.path.blocks());
    else
      copy(last_move_, motion_.count(n_) - 1);
    return std::move(result_);
  }

 private:
  struct Run : StopRun {
    std::optional<AlongRun> along{};
    bool chosen = false;  // the run along the path
  };

  std::size_t samples(const Run& run, bool along) const {
    if (!along) return run.end - run.begin;
    return run.along ? run.rest + run.along->position.size() / n_ : never;
  }
  /// Samples of rest that a run needs more behind the one before it. Runs of the motion there is have met already.
  std::size_t between(std::size_t i, bool along, bool before) const {
    const Run& run = runs_[i];
    if (!along && !before) return 0;
    if (along && before) {
      if (i == 0 || !run.along || !runs_[i - 1].along) return 0;
      const std::size_t needed = rests_between(free_, runs_[i - 1].along->position, run.along->position);
      return needed - std::min(needed, run.rest);
    }
    // A dwell of the motion may begin while it still comes to rest.
    const std::size_t needed = std::max(free_.border() - 1, along ? 0 : run.rest), there = along ? run.rest : run.still;
    return needed - std::min(needed, there);
  }
  /// The kind of every run, so that all together are as short as possible.
  void choose() {
    std::vector<std::array<std::size_t, 2>> total(runs_.size());  // up to and with a run of this kind
    std::vector<std::array<bool, 2>> before(runs_.size());        // kind of the run before it
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      for (const bool along : {false, true}) {
        const std::size_t same = between(i, along, along), other = between(i, along, !along);
        const std::size_t own = samples(runs_[i], along);
        std::size_t least = 0;
        before[i][along] = along;
        if (i > 0) {
          least = total[i - 1][along] + same;
          before[i][along] = total[i - 1][!along] + other < least ? !along : along;
          least = std::min(least, total[i - 1][!along] + other);
        }
        total[i][along] = std::min(never, least + own);
      }
    }
    bool along = !runs_.empty() && total.back()[1] < total.back()[0];
    for (std::size_t i = runs_.size(); i-- > 0;) {
      runs_[i].chosen = along;
      along = before[i][along];
    }
  }
  void rest(std::size_t count, std::size_t point) {
    for (std::size_t i = 0; i < count; ++i)
      result_.position.insert(result_.position.end(), free_.path.point(point), free_.path.point(point) + n_);
  }
  /// Samples of the motion after `begin`, up to `end`.
  void copy(std::size_t begin, std::size_t end) {
    result_.position.insert(result_.position.end(),
                            motion_.position.begin() + static_cast<std::ptrdiff_t>((begin + 1) * n_),
                            motion_.position.begin() + static_cast<std::ptrdiff_t>((end + 1) * n_));
  }
  void take(std::size_t i) {
    const Run& run = runs_[i];
    if (i > 0) rest(between(i, run.chosen, runs_[i - 1].chosen), run.first);
    if (run.chosen) rest(run.rest, run.first);
    const auto now = static_cast<double>(result_.count(n_) - 1);
    if (run.chosen) {
      result_.position.insert(result_.position.end(), run.along->position.begin(), run.along->position.end());
      for (const double pass : run.along->passes) result_.passes.push_back(now + pass);
    } else {
      copy(run.begin, run.end);
      for (std::size_t b = run.first; b < run.last; ++b)
        result_.passes.push_back(motion_.passes[b] - static_cast<double>(run.begin) + now);
    }
    if (run.last + 1 < free_.path.blocks()) result_.passes.push_back(static_cast<double>(result_.count(n_) - 1));
  }

  const FreePath& free_;
  const FreeSamples& motion_;
  const MakeRun make_;
  const std::size_t n_;
  const std::size_t last_move_;  // sample that ends it; a dwell may follow
  std::vector<Run> runs_;
  FreeSamples result_;
};

/// Blocks that go on without a sharp turn, at whose end the path turns sharply.
struct SmoothPart {
  std::size_t first = 0, last = 0;
  bool bends = false;
};

std::vector<SmoothPart> smooth_parts(const FreePath& free, std::size_t first, std::size_t last) {
  constexpr double sharp = 0.02;  // rad; a motion along the path nearly rests there
  const SmoothPath curve(free.path, first, last);
  std::vector<SmoothPart> parts;
  for (std::size_t i = 0; i < curve.pieces().size(); ++i) {
    const SmoothPath::Piece& piece = curve.pieces()[i];
    double turn = i == 0 ? unlimited : 0.0;
    if (i > 0) {
      const PathPlace in = curve.at(curve.pieces()[i - 1], piece.begin), out = curve.at(piece, piece.begin);
      for (std::size_t a = 0; a < free.dimensions(); ++a) turn = std::hypot(turn, out.first[a] - in.first[a]);
    }
    if (turn > sharp) parts.push_back({piece.first, piece.last});
    parts.back().last = piece.last;
    parts.back().bends = parts.back().bends || piece.bends();
  }
  return parts;
}

/// A motion that rests wherever the path turns sharply. Coming to rest takes less time than creeping around a corner.
/// @returns none without such a turn or without curves, or if a part has no motion
std::optional<AlongRun> resting_run(const FreePath& free, std::size_t first, std::size_t last, std::size_t most,
                                    const Deadline& deadline) {
  const std::vector<SmoothPart> parts = smooth_parts(free, first, last);
  if (parts.size() < 2 || std::none_of(parts.begin(), parts.end(), [](const SmoothPart& p) { return p.bends; }))
    return {};
  const std::size_t n = free.dimensions();
  AlongRun whole;
  for (const SmoothPart& part : parts) {
    const std::size_t done = whole.position.size() / n;
    if (done >= most || deadline.over()) return {};
    const auto run = part.bends ? along_run(free, part.first, part.last, most - done, deadline)
                                : straight_run(free, part.first, part.last);
    if (!run) return {};
    for (std::size_t k = done > 0 ? rests_between(free, whole.position, run->position) : 0; k > 0; --k)
      whole.position.insert(whole.position.end(), free.path.point(part.first), free.path.point(part.first) + n);
    const std::size_t taken = whole.position.size() / n;
    if (part.first > first) whole.passes.push_back(static_cast<double>(taken));
    whole.position.insert(whole.position.end(), run->position.begin(), run->position.end());
    for (const double pass : run->passes) whole.passes.push_back(static_cast<double>(taken) + pass);
  }
  return whole;
}

}  // namespace

FreeSamples with_runs_along(const FreePath& free, const FreeSamples& motion, const Deadline& deadline) {
  const auto make = [&](std::size_t first, std::size_t last, std::size_t most) {
    if (deadline.over()) return std::optional<AlongRun>();
    std::optional<AlongRun> run = along_run(free, first, last, most, deadline);
    if (run) most = std::min(most, run->position.size() / free.dimensions());
    if (auto resting = resting_run(free, first, last, most, deadline);
        resting && resting->position.size() / free.dimensions() < most)
      run = std::move(resting);
    return run;
  };
  return Joining(free, motion, make).run();
}

FreeSamples with_straight_runs(const FreePath& free, const FreeSamples& motion) {
  const auto make = [&](std::size_t first, std::size_t last, std::size_t) { return straight_run(free, first, last); };
  return Joining(free, motion, make).run();
}

}  // namespace accdec
