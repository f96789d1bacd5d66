#include <algorithm>
#include <array>
#include <cmath>

#include <accdec/plan/free/passes.hpp>
#include <accdec/plan/free/shorten.hpp>
#include <accdec/plan/free/window.hpp>

namespace accdec {
namespace {

constexpr int rounds_max = 10;
constexpr double landing = 25.0;  // samples at a part's end that are left for joining it to what follows
constexpr double worth = 0.02;    // samples gained by a round

/// The old motion, counted from a part's begin, at rest before its first and after its last sample.
struct OldMotion {
  const std::vector<double>& position;
  std::ptrdiff_t begin;
  std::size_t n;

  const double* row(std::ptrdiff_t k) const {
    const auto last = static_cast<std::ptrdiff_t>(position.size() / n) - 1;
    return position.data() + static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(begin + k, 0, last)) * n;
  }
  /// Linear between samples.
  void at(double k, double* x) const {
    const double floor = std::floor(k), f = k - floor;
    const double* const a = row(static_cast<std::ptrdiff_t>(floor));
    const double* const b = row(static_cast<std::ptrdiff_t>(floor) + 1);
    for (std::size_t i = 0; i < n; ++i) x[i] = (1.0 - f) * a[i] + f * b[i];
  }
};

/// The part while it is shortened. Its first samples are new; the rest is the old motion, `shift_` samples earlier.
/// Places are counted in samples of the part, 0 being its begin; passes, too.
class Shortening {
 public:
  Shortening(const FreePath& free, const std::vector<double>& position, const FreePart& part, std::size_t size)
      : free_(free),
        old_{position, static_cast<std::ptrdiff_t>(part.begin), free.dimensions()},
        part_(part),
        n_(free.dimensions()),
        window_{free.border(), size},
        passes_(part.passes) {}

  ShortenedPart run(const std::function<bool()>& stop) {
    const std::size_t length = part_.end - part_.begin;
    const std::size_t step = window_.size / 2;
    std::size_t from = 0;
    double gained = 0.0;
    bool done = false;
    for (;; from += step) {
      if (stop()) break;
      const double end = static_cast<double>(from + window_.size) + shift_;
      if (end > static_cast<double>(length) - landing) {
        done = true;
        break;
      }
      // The next window may gain what the last one did.
      const double before = shift_, room = static_cast<double>(length) - landing - end;
      advance(from, gained > 1.0 && gained < room ? gained : 0.0);
      gained = shift_ - before;
    }
    if (!land(from, done) || !kept()) return {};
    return std::move(result_);
  }

  std::optional<ShortenedPart> run_at_once(int more) {
    Window landed;
    double best = 0.0;
    if (try_landing(0, true, best, landed)) {
      while (try_landing(0, true, best + 1.0, landed)) ++best;
    } else {
      do --best;
      while (best >= -more && !try_landing(0, true, best, landed));
    }
    if (best < -more) return {};
    take(0, landed, best);
    result_.passes = passes_;
    return std::move(result_);
  }

 private:
  std::size_t solved() const { return result_.position.size() / n_; }
  /// The motion as it is now at sample k, -border ..
  void now(std::ptrdiff_t k, double* x) const {
    if (k < 0) {
      std::copy_n(old_.row(k), n_, x);
    } else if (static_cast<std::size_t>(k) < solved()) {
      std::copy_n(result_.position.data() + static_cast<std::size_t>(k) * n_, n_, x);
    } else {
      old_.at(static_cast<double>(k) + shift_, x);
    }
  }
  /// As it is now between samples.
  void now_at(double k, double* x) const {
    std::array<double, program_axis_count> a{}, b{};
    const double floor = std::floor(k), f = k - floor;
    now(static_cast<std::ptrdiff_t>(floor), a.data());
    now(static_cast<std::ptrdiff_t>(floor) + 1, b.data());
    for (std::size_t i = 0; i < n_; ++i) x[i] = (1.0 - f) * a[i] + f * b[i];
  }

  /// Fills a window of `count` samples from `from` on with the motion as it is, run through faster by `faster` samples.
  Window window_at(std::size_t from, std::size_t count, double faster) {
    Window w;
    w.size = count;
    w.before.resize(window_.border * n_);
    for (std::size_t i = 0; i < window_.border; ++i)
      now(static_cast<std::ptrdiff_t>(from + i) - static_cast<std::ptrdiff_t>(window_.border), &w.before[i * n_]);
    w.guess.resize(count * n_);
    const double pace = 1.0 + faster / static_cast<double>(count + 1);
    for (std::size_t i = 0; i < count; ++i)
      now_at(static_cast<double>(from) - 1.0 + pace * static_cast<double>(i + 1), &w.guess[i * n_]);
    first_pass_ = 0;
    while (first_pass_ < passes_.size() && passes_[first_pass_] <= static_cast<double>(from) - 1.0) ++first_pass_;
    for (std::size_t i = first_pass_; i < passes_.size(); ++i) {
      const double at = (passes_[i] - static_cast<double>(from) + 1.0) / pace - 1.0;
      if (at >= static_cast<double>(count)) break;
      // Less where joints are close: the guess turns on the way to the next.
      const double before = i > 0 ? passes_[i] - passes_[i - 1] : unlimited;
      const double after = i + 1 < passes_.size() ? passes_[i + 1] - passes_[i] : unlimited;
      w.passes.push_back({part_.first_joint + i, at, std::clamp(0.25 * std::min(before, after), 0.5, 2.0)});
    }
    return w;
  }
  /// The samples after a window: the old motion, base and base + reach samples earlier.
  void set_after(Window& w, std::size_t from, double base, double reach) const {
    w.after.resize(window_.border * n_);
    w.later.resize(window_.border * n_);
    for (std::size_t i = 0; i < window_.border; ++i) {
      const auto k = static_cast<double>(from + w.size + i);
      old_.at(k + base, &w.after[i * n_]);
      old_.at(k + base + reach, &w.later[i * n_]);
    }
  }
  void set_legs(Window& w) const {
    std::size_t leg = part_.first_joint + first_pass_;
    w.leg_before = leg;
    w.leg.resize(w.size + 1);
    std::size_t next = 0;
    for (std::size_t k = 0; k <= w.size; ++k) {
      for (; next < w.passes.size() && w.passes[next].at <= static_cast<double>(k); ++next)
        leg = w.passes[next].joint + 1;
      w.leg[k] = leg;
    }
  }
  bool solve(Window& w, bool maximise, double& share) {
    set_legs(w);
    ++result_.programmes;
    return solve_window(free_, w, maximise, share);
  }

  bool cruises(const Window& w) const {
    if (!w.passes.empty()) return false;
    const double full = free_.feed[part_.first_joint + first_pass_] * free_.period;
    const double* before = w.before.data() + (window_.border - 1) * n_;
    for (std::size_t k = 0; k < w.size; ++k) {
      double step = 0.0;
      for (std::size_t a = 0; a < n_; ++a) step = std::hypot(step, w.guess[k * n_ + a] - before[a]);
      if (step < full * (1.0 - 1e-5)) return false;
      before = w.guess.data() + k * n_;
    }
    return true;
  }

  /// Takes a solved window as new samples.
  void take(std::size_t from, const Window& w, double shift) {
    keep(from);
    result_.position.resize(from * n_);
    result_.position.insert(result_.position.end(), w.guess.begin(), w.guess.end());
    for (std::size_t i = 0; i < w.passes.size(); ++i)
      passes_[first_pass_ + i] = static_cast<double>(from) + w.passes[i].at;
    for (std::size_t i = first_pass_ + w.passes.size(); i < passes_.size(); ++i) {
      passes_[i] = std::max(part_.passes[i] - shift, static_cast<double>(from + w.size) - 1.0);
    }
    shift_ = shift;
  }
  /// Keeps samples up to `end` as they are.
  void keep(std::size_t end) {
    std::array<double, program_axis_count> x{};
    while (solved() < end) {
      now(static_cast<std::ptrdiff_t>(solved()), x.data());
      result_.position.insert(result_.position.end(), x.begin(), x.begin() + static_cast<std::ptrdiff_t>(n_));
    }
  }

  /// One window: passes slide along the guess until nothing is gained, then they are held where they have come to. If
  /// they cannot be, they slide less; in the end they stay where they were.
  /// @param faster  samples by which the first guess is faster than the motion
  void advance(std::size_t from, double faster) {
    const Window old = window_at(from, window_.size, 0.0);
    if (cruises(old)) return;
    Window w = window_at(from, window_.size, faster);
    double shift = shift_ + faster;
    if (faster > 0.0 && !w.passes.empty() && slide_passes(from, 1.0, w, shift) && hold(from, w, shift)) return;
    w = window_at(from, window_.size, 0.0);
    shift = shift_;
    for (double slide = 1.0; slide > 0.1 && !w.passes.empty(); slide *= 0.3) {
      slide_passes(from, slide, w, shift);
      if (hold(from, w, shift)) return;
    }
    hold(from, old, shift_);
  }

  /// Solves with sliding passes as long as that gains.
  /// @param shift  of the motion after the window
  /// @returns false if the guess is faster than the motion and no motion is as fast
  bool slide_passes(std::size_t from, double slide, Window& w, double& shift) {
    const double most = static_cast<double>(part_.end - part_.begin) - static_cast<double>(from + window_.size);
    double share = 0.0;
    for (int round = 0; round < rounds_max && slide > 0.05; ++round) {
      const double base = std::max(0.0, std::floor(shift - 0.5));
      const double reach = std::min(round == 0 ? 4.0 : 2.0, std::max(0.0, std::floor(most - base)));
      Window trial = w;
      trial.slide = slide;
      set_after(trial, from, base, reach);
      if (!solve(trial, true, share) || base + share * reach < shift - 0.5) {
        if (round == 0 && shift > shift_) return false;
        slide *= 0.5;
        continue;
      }
      const double gained = base + share * reach - shift;
      shift += gained;
      find_passes(free_.path, trial, 1.0);
      w = std::move(trial);
      if (gained < worth) break;
    }
    return true;
  }

  /// Solves with passes that stay, and takes the answer.
  bool hold(std::size_t from, const Window& guess, double shift) {
    double share = 0.0;
    for (double base = std::floor(shift - 0.25), down = 0.0; down < 2.0; ++down, --base) {
      Window exact = guess;
      exact.slide = 0.0;
      set_after(exact, from, std::max(0.0, base), 1.0);
      if (!solve(exact, true, share)) continue;
      take(from, exact, std::max(0.0, base) + share);
      return true;
    }
    return false;
  }

  /// Joins the motion so far to the old one, a whole number of samples earlier. The window for this is the last of the
  /// part, or the next one where the work ends early.
  bool land(std::size_t from, bool at_end) {
    Window landed;
    for (const std::size_t back : {std::size_t{0}, window_.size / 2, window_.size}) {
      if (back > from) break;
      const std::size_t start = from - back;
      const double first = std::floor(shift_ + 0.01);
      double best = -1.0;
      for (double shift = first; shift >= std::max(0.0, first - 2.0) && best < 0.0; --shift) {
        if (try_landing(start, at_end, shift, landed)) best = shift;
      }
      if (best < 0.0) continue;
      while (at_end && try_landing(start, at_end, best + 1.0, landed)) ++best;
      if (best < 1.0) return false;
      take(start, landed, best);
      result_.moved = solved();
      keep(part_.end - part_.begin - static_cast<std::size_t>(best));
      result_.saved = static_cast<std::size_t>(best);
      result_.passes = passes_;
      return true;
    }
    return false;
  }

  /// A window from `from` to the end of the part, or as long as others, after which the old motion comes so many
  /// samples earlier.
  bool try_landing(std::size_t from, bool at_end, double shift, Window& landed) {
    const double left = static_cast<double>(part_.end - part_.begin) - shift - static_cast<double>(from);
    if (left < 3.0) return false;
    const std::size_t count =
        at_end ? static_cast<std::size_t>(left) : std::min(static_cast<std::size_t>(left), window_.size);
    Window w = window_at(from, count, shift - shift_);
    set_after(w, from, shift, 0.0);
    double share = 0.0;
    for (const double slide : {0.0, 0.5, 0.2}) {
      if (slide > 0.0 && w.passes.empty()) return false;
      if (slide == 0.0 && shift > shift_ + 0.01 && !w.passes.empty()) continue;
      Window trial = w;
      if (slide > 0.0) {
        trial.slide = slide;
        if (!solve(trial, false, share)) continue;
        find_passes(free_.path, trial, 1.0);
        trial.slide = 0.0;
      }
      if (!solve(trial, false, share)) continue;
      landed = std::move(trial);
      return true;
    }
    return false;
  }

  /// If no window was solved, a mean of two copies of the old motion may cut corners by a T^2/8.
  bool kept() const {
    return keeps_path(free_, part_, result_.moved, passes_, [&](std::ptrdiff_t k) -> const double* {
      const auto count = static_cast<std::ptrdiff_t>(solved());
      if (k >= 0 && k < count) return result_.position.data() + static_cast<std::size_t>(k) * n_;
      return old_.row(k < 0 ? k : k + static_cast<std::ptrdiff_t>(result_.saved));
    });
  }

  const FreePath& free_;
  const OldMotion old_;
  const FreePart& part_;
  const std::size_t n_;
  const struct { std::size_t border, size; } window_;  // samples
  std::vector<double> passes_;
  double shift_ = 0.0;
  std::size_t first_pass_ = 0;
  ShortenedPart result_;
};

}  // namespace

ShortenedPart shorten(const FreePath& free, const std::vector<double>& position, const FreePart& part, std::size_t size,
                      const std::function<bool()>& stop) {
  return Shortening(free, position, part, size).run(stop);
}

std::optional<ShortenedPart> shorten_at_once(const FreePath& free, const std::vector<double>& position,
                                             const FreePart& part, int more) {
  return Shortening(free, position, part, part.end - part.begin).run_at_once(more);
}

}  // namespace accdec
