#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include <accdec/plan/free/free_motion.hpp>
#include <accdec/plan/free/shorten.hpp>
#include <accdec/plan/free/splines.hpp>
#include <accdec/simulate/command_stream.hpp>

namespace accdec {
namespace {

/// The sections between stops, cut into parts of about `size` samples. Samples at every stop stay.
class Parts {
 public:
  Parts(const FreePath& free, const FreeSamples& motion, std::size_t size, bool shifted)
      : free_(free), motion_(motion), size_(size) {
    // Dwells before the first move and after the last one are no part of it.
    const std::size_t n = free.dimensions(), last = motion.count(n) - 1 - free.rests_at(free.path.blocks() - 1);
    std::size_t begin = 1 + static_cast<std::size_t>(whole_samples(free.path.dwell_first / free.period));
    std::size_t first_joint = 0;
    for (std::size_t j = 0; j < free.path.blocks(); ++j) {
      if (free.path.joint[j] != Joint::stop) continue;
      const std::size_t stop =
          j < motion.passes.size() ? static_cast<std::size_t>(std::lround(motion.passes[j])) : last;
      // The sample before a stop stays, so that the motion is as slow there as it was.
      const std::size_t end = stop < last ? stop - 1 : last;
      if (usable(first_joint, j)) add(begin, end, first_joint, j, shifted);
      begin = stop;
      const auto same = [&](std::size_t k) {
        return std::equal(motion.position.data() + k * n, motion.position.data() + (k + 1) * n,
                          motion.position.data() + stop * n);
      };
      while (begin < last && same(begin + 1)) ++begin;
      begin = std::max(begin, stop + free.border() - 1) + 1;
      first_joint = j + 1;
    }
  }
  std::vector<FreePart> parts;

 private:
  /// Blocks first .. last have tubes, and their joints tolerances.
  bool usable(std::size_t first, std::size_t last) const {
    constexpr double least = 1e-8;
    for (std::size_t b = first; b <= last; ++b) {
      if (!(free_.radius[b] > least) || (b < last && !(free_.path.tolerance[b] > least))) return false;
    }
    return true;
  }
  void add(std::size_t begin, std::size_t end, std::size_t joint, std::size_t end_joint, bool shifted) {
    if (end < begin + 20) return;
    const std::size_t length = end - begin;
    std::size_t pieces = std::max<std::size_t>(1, (length + size_ / 2) / size_);
    if (shifted && pieces > 1) ++pieces;
    std::size_t from = begin;
    for (std::size_t i = 0; i < pieces; ++i) {
      double share = static_cast<double>(i + 1) / static_cast<double>(pieces);
      if (shifted && pieces > 1) share = (static_cast<double>(i) + 0.5) / (static_cast<double>(pieces) - 1.0);
      const std::size_t to =
          i + 1 == pieces ? end : begin + static_cast<std::size_t>(share * static_cast<double>(length));
      FreePart part{from, to, joint, joint};
      while (part.first_joint < end_joint && motion_.passes[part.first_joint] <= static_cast<double>(from) - 1.0)
        ++part.first_joint;
      part.end_joint = part.first_joint;
      while (part.end_joint < end_joint && motion_.passes[part.end_joint] < static_cast<double>(to)) ++part.end_joint;
      joint = part.first_joint;
      for (std::size_t j = part.first_joint; j < part.end_joint; ++j)
        part.passes.push_back(motion_.passes[j] - static_cast<double>(from));
      if (to > from + 20) parts.push_back(std::move(part));
      from = to + free_.border();
    }
  }

  const FreePath& free_;
  const FreeSamples& motion_;
  const std::size_t size_;
};

/// The motion with its shortened parts.
FreeSamples joined(const FreePath& free, const FreeSamples& motion, const std::vector<FreePart>& parts,
                   const std::vector<ShortenedPart>& shortened) {
  const auto n = static_cast<std::ptrdiff_t>(free.dimensions());
  FreeSamples result;
  result.passes = motion.passes;
  std::size_t next = 0, saved = 0, joint = 0;
  const auto copy = [&](std::size_t end) {
    result.position.insert(result.position.end(), motion.position.begin() + static_cast<std::ptrdiff_t>(next) * n,
                           motion.position.begin() + static_cast<std::ptrdiff_t>(end) * n);
    next = end;
  };
  const auto move_passes = [&](std::size_t end) {
    for (; joint < end; ++joint) result.passes[joint] -= static_cast<double>(saved);
  };
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const ShortenedPart& part = shortened[i];
    if (part.saved == 0) continue;
    copy(parts[i].begin);
    move_passes(parts[i].first_joint);
    result.position.insert(result.position.end(), part.position.begin(), part.position.end());
    for (std::size_t j = 0; j < part.passes.size(); ++j)
      result.passes[joint + j] = part.passes[j] + static_cast<double>(parts[i].begin - saved);
    joint += part.passes.size();
    next = parts[i].end;
    saved += part.saved;
  }
  copy(motion.count(free.dimensions()));
  move_passes(result.passes.size());
  return result;
}

/// Shortens all parts on some threads; progress is told from any of them.
class Sweep {
 public:
  /// @param splines  the parts become such splines; none: they are shortened sample by sample
  Sweep(const FreePath& free, const SplineTube* splines, const FreeSamples& motion, std::vector<FreePart> parts,
        const FreeOptions& options, const Deadline& deadline, FreeProgress begun)
      : free_(free),
        splines_(splines),
        motion_(motion),
        parts_(std::move(parts)),
        options_(options),
        deadline_(deadline),
        progress_(std::move(begun)),
        shortened_(parts_.size()) {}

  FreeSamples run(FreeReport& report) {
    std::vector<std::jthread> others;
    const std::size_t threads = std::min<std::size_t>(static_cast<std::size_t>(options_.threads), parts_.size());
    for (std::size_t i = 1; i < threads; ++i) others.emplace_back([this] { work(); });
    work();
    others.clear();
    for (const ShortenedPart& part : shortened_) {
      report.programmes += part.programmes;
      report.iterations += part.iterations;
    }
    return joined(free_, motion_, parts_, shortened_);
  }

 private:
  bool over() const { return deadline_.over(); }
  void work() {
    for (std::size_t i = next_++; i < parts_.size(); i = next_++) {
      if (over()) return;
      shortened_[i] = shortened(parts_[i]);
      const std::lock_guard lock(mutex_);
      progress_.gained += static_cast<double>(shortened_[i].saved) * free_.period;
      progress_.share = static_cast<double>(++done_) / static_cast<double>(parts_.size());
      if (options_.progress) options_.progress(progress_);
    }
  }
  ShortenedPart shortened(const FreePart& part) const {
    const auto stop = [this] { return over(); };
    if (splines_) return splines_->shorten(motion_.position, part, window_of(part, splines_->spacing()), stop);
    return shorten(free_, motion_.position, part, window_of(part, 1), stop);
  }
  /// Long windows where joints are rare: what is gained at one moves the samples of the whole leg.
  static std::size_t window_of(const FreePart& part, std::size_t spacing) {
    const double between = static_cast<double>((part.end - part.begin) / spacing) /
                           (1.0 + static_cast<double>(part.end_joint - part.first_joint));
    return between < 20.0 ? 80 : between < 60.0 ? 160 : 240;
  }

  const FreePath& free_;
  const SplineTube* const splines_;
  const FreeSamples& motion_;
  const std::vector<FreePart> parts_;
  const FreeOptions& options_;
  const Deadline& deadline_;
  FreeProgress progress_;
  std::vector<ShortenedPart> shortened_;
  std::atomic<std::size_t> next_ = 0;
  std::size_t done_ = 0;
  std::mutex mutex_;
};

/// Shortens a motion, or its parts as splines, until a sweep gains little or the time is over.
void sweep(const FreePath& free, const SplineTube* splines, FreeSamples& motion, const FreeOptions& options,
           const Deadline& deadline, FreeReport& report, double& gained) {
  const std::size_t n = free.dimensions(), spacing = splines ? splines->spacing() : 1;
  // Up to 1500 samples or control points, less of short motions: parts are shortened side by side.
  const std::size_t size = std::clamp(motion.count(n) / 4, std::max<std::size_t>(1000, 300 * spacing), 1500 * spacing);
  const double worth = splines ? 2e-3 : 4e-4;
  for (; report.sweeps < options.sweeps; ++report.sweeps) {
    const bool shifted = report.sweeps % 2 != 0;
    std::vector<FreePart> parts = Parts(free, motion, size, shifted).parts;
    if (splines) std::erase_if(parts, [&](const FreePart& part) { return !splines->has_room(part); });
    if (parts.empty()) break;
    const std::size_t before = motion.count(n);
    FreeProgress begun{
        .stage = fmt::format("sweep {} over the {}", report.sweeps + 1, splines ? "control points" : "samples"),
        .gained = gained};
    if (options.progress) options.progress(begun);
    motion = Sweep(free, splines, motion, std::move(parts), options, deadline, std::move(begun)).run(report);
    report.ended = deadline.over();
    const auto saved = static_cast<double>(before - motion.count(n));
    gained += saved * free.period;
    if (report.ended || saved < worth * static_cast<double>(before)) break;
  }
}

}  // namespace

FreeReport shorten_motion(const FreePath& free, FreeSamples& motion, const FreeOptions& options,
                          const Deadline& deadline) {
  FreeReport report;
  double gained = 0.0;
  for (std::size_t spacing = 4; spacing > 1 && !deadline.over(); spacing /= 2) {
    const SplineTube splines(free, spacing);
    sweep(free, &splines, motion, options, deadline, report, gained);
  }
  if (!deadline.over()) sweep(free, nullptr, motion, options, deadline, report, gained);
  report.ended = deadline.over();
  return report;
}

}  // namespace accdec
