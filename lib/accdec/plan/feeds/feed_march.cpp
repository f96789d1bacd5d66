#include <algorithm>
#include <cmath>

#include <accdec/plan/feeds/feed_changes.hpp>
#include <accdec/plan/feeds/feed_march.hpp>

namespace accdec {
namespace {

constexpr double worth = 0.01;     // smallest rise of the speed that is worth a step, of the speed
constexpr double eps_time = 1e-9;  // s
constexpr double good = 1.0 + 2.0 * sum_slack;

template <std::size_t axes>
class March {
 public:
  March(const FeedPath& path, const FeedWindow& window, std::span<const FeedPiece> caps, Walk walk,
        const Deadline& deadline)
      : path_(path, caps, walk),
        window_(window),
        judge_(window, path_.dimensions(), path_.backward()),
        reach_(window.reach()),
        deadline_(deadline) {
    line_.push_back({0.0, 0.0, 1.0F, {}});
  }

  std::vector<FeedPiece> run() {
    out_.reserve(2 * path_.pieces());
    for (std::size_t i = 0; i < path_.pieces(); ++i) {
      const FeedPiece& cap = path_.piece(i);
      double left = cap.length;
      while (left > 0.0) {
        if (++steps_ % 4096 == 0) late_ = late_ || deadline_.over();
        const bool limited = window_.limited() && !late_;
        const double v = limited ? decide(i, left, cap.speed) : cap.speed;
        double time = left / v;
        if (limited && v < cap.speed * (1.0 - worth)) time = std::min(time, relaxes());
        double length = v * time;
        if (left - length < 1e-9 * cap.length || left - length < 1e-10) length = left, time = left / v;
        left -= length;
        go(cap.block, length, v, time);
      }
      if (path_.rest(i) > 0.0) {
        out_.back().rest += path_.rest(i);
        append(now_ + path_.rest(i), 0.0, {}, 1.0F);
      }
    }
    if (path_.backward()) {
      // Rests stand after the piece that comes first in the order of the path.
      std::reverse(out_.begin(), out_.end());
      for (std::size_t i = 0; i < out_.size(); ++i) out_[i].rest = i + 1 < out_.size() ? out_[i + 1].rest : 0.0;
    }
    return std::move(out_);
  }

 private:
  using Segment = FeedSegment<axes>;

  void append(double end, double v, const AxisRow<axes>& row, float margin) {
    Segment& last = line_.back();
    if (last.speed == v && last.velocity == row) {
      last.end = end;
    } else {
      line_.push_back({end, v, margin, row});
    }
    now_ = end;
    const double old = now_ - reach_ - eps_time;
    while (keep_ + 1 < line_.size() && line_[keep_].end <= old) ++keep_;
    if (keep_ > 4096) {
      line_.erase(line_.begin(), line_.begin() + static_cast<std::ptrdiff_t>(keep_));
      keep_ = 0;
      for (Segment& segment : line_) segment.end -= now_;  // so that hours of motion cost no digits
      sure_until_ -= now_, look_far_ -= now_;
      now_ = 0.0;
    }
  }

  void go(std::uint32_t block, double length, double v, double time) {
    if (!out_.empty() && out_.back().block == block && out_.back().rest == 0.0 && out_.back().speed == v) {
      out_.back().length += length;
    } else {
      out_.push_back({block, length, v, 0.0});
    }
    append(now_ + time, v, path_.velocity(block, v), path_.margin(block));
    before_ = v;
  }

  /// s until an earlier change leaves one of the windows.
  double relaxes() const {
    double next = unlimited;
    for (std::size_t i = keep_; i < line_.size(); ++i) {
      const double age = now_ - line_[i].end;
      for (const double lag : {window_.tau1(), window_.tau2(), window_.reach()}) {
        if (lag - age > 1e-7) next = std::min(next, lag - age);
      }
    }
    return std::max(next, 1e-6);
  }

  /// How speed v from here on, or the caps where they are lower, use the limits within `ahead` seconds.
  /// @param to_the_end  else it ends where more is used than allowed
  FeedVerdict check(std::size_t i, double left, double v, double ahead, bool to_the_end) {
    FeedVerdict verdict;
    const std::size_t size = line_.size();
    const double horizon = now_ + ahead, tau1 = window_.tau1(), tau2 = window_.tau2();
    const bool jerk = window_.jerk();
    std::size_t one = keep_, two = keep_, both = keep_;
    double t = now_;
    // Within one window without a jerk limit, only what was commanded before counts.
    const bool looked_back_at = jerk || ahead > tau1;
    const auto follow = [&](const Segment& at) {
      const double end = at.end, until = std::min(end, horizon) - eps_time;
      if (looked_back_at) line_.push_back(at);
      judge_.to(at);
      const Segment* const line = line_.data();
      const std::size_t last = line_.size() - 1;
      const Segment* judged = nullptr;
      while (t < until) {
        const double soon = t + eps_time;
        while (one < last && line[one].end + tau1 <= soon) ++one;
        double next = std::min(end, line[one].end + tau1);
        if (jerk) {
          while (line[two].end + tau2 <= soon) ++two;
          while (line[both].end + reach_ <= soon) ++both;
          next = std::min({next, line[two].end + tau2, line[both].end + reach_});
          judge_.jerk(at, line[one], line[two], line[both], v, verdict);
        }
        if (judged != line + one) judge_.pair(at, line[one], v, verdict);
        judged = line + one;
        if (verdict.use > good && verdict.until == unlimited) {
          verdict.until = t;
          if (!to_the_end) return;
        }
        t = next;
      }
      t = std::max(t, end);
    };
    const auto ends = [&] { return t >= horizon - eps_time || (!to_the_end && verdict.use > good); };
    for (; i < path_.pieces() && !ends(); ++i) {
      const FeedPiece& cap = path_.piece(i);
      const double speed = std::min(v, cap.speed);
      follow({t + left / speed, speed, path_.margin(cap.block), path_.velocity(cap.block, speed)});
      if (path_.rest(i) > 0.0) follow({t + path_.rest(i), 0.0, 1.0F, {}});
      if (i + 1 < path_.pieces()) left = path_.piece(i + 1).length;
    }
    if (!ends()) follow({horizon, 0.0, 1.0F, {}});
    line_.resize(size);
    return verdict;
  }

  /// The speed of piece i from here on. If a far look ahead along the caps was good, so are all caps that are passed
  /// before its end is within reach.
  double decide(std::size_t i, double left, double cap) {
    if (now_ + reach_ > sure_until_ && now_ >= look_far_) {
      const double end = now_ + 6.0 * reach_, broken = check(i, left, unlimited, end - now_, false).until;
      sure_until_ = std::min(end, broken);
      look_far_ = broken < end ? std::max(broken, now_ + reach_) : end - reach_;
    }
    if (now_ + reach_ <= sure_until_) return cap;
    const FeedVerdict verdict = check(i, left, cap, reach_, true);
    if (!(verdict.use > good)) return cap;
    sure_until_ = 0.0;
    return lowered(i, left, cap, verdict);
  }

  /// The smallest rise that is worth a step: of filters so short that they allow less at a time, a part of that.
  double worth_of(std::size_t i, double v) const {
    const double* u = path_.direction(path_.piece(i).block);
    double step = unlimited;
    for (std::size_t a = 0; a < path_.dimensions(); ++a) step = std::min(step, window_.step(a) / std::abs(u[a]));
    return std::min(worth, 0.25 * step / v);
  }

  double lowered(std::size_t i, double left, double cap, FeedVerdict verdict) {
    const double least_rise = before_ > 0.0 ? worth_of(i, before_) : worth;
    double best = cap, least = verdict.use, bad = cap, fine = 0.0;
    double v = cap;
    bool kept = !(before_ > 0.0 && before_ < cap);  // whether going on as before has been tried
    for (int k = 0; k < 12 && fine == 0.0; ++k) {
      const double lower = verdict.try_next > 0.0 ? std::max(0.3 * v, verdict.try_next) : 0.7 * v;
      if (!kept && lower <= before_ * (1.0 + least_rise)) {
        v = before_;  // what is allowed may be a narrow range
        kept = true;
      } else {
        v = std::min(lower, v * (1.0 - 0.01 * least_rise));
      }
      verdict = check(i, left, v, reach_, true);
      if (verdict.use <= good) {
        fine = v;
      } else {
        if (verdict.use < least * (1.0 - 1e-6)) least = verdict.use, best = v;
        bad = v;
      }
    }
    if (fine == 0.0) return best;
    for (int k = 0; k < 5 && !verdict.full && bad > fine * (1.0 + least_rise); ++k) {
      v = 0.5 * (fine + bad);
      (check(i, left, v, reach_, false).use <= good ? fine : bad) = v;
    }
    return fine;
  }

  WalkedPath<axes> path_;
  const FeedWindow& window_;
  ChangeJudge<axes> judge_;
  double reach_;
  const Deadline& deadline_;
  std::size_t steps_ = 0;
  bool late_ = false;
  std::vector<Segment> line_;  // the command so far, from the first that still counts on
  std::size_t keep_ = 0;
  double now_ = 0.0, before_ = 0.0;
  double sure_until_ = 0.0;  // along the caps all is well until then
  double look_far_ = 0.0;    // not before this again
  std::vector<FeedPiece> out_;
};

}  // namespace

std::vector<FeedPiece> march_feeds(const FeedPath& path, const FeedWindow& window, std::span<const FeedPiece> caps,
                                   Walk walk, const Deadline& deadline) {
  switch (path.dimensions) {
    case 2: return March<2>(path, window, caps, walk, deadline).run();
    case 3: return March<3>(path, window, caps, walk, deadline).run();
    default: return March<0>(path, window, caps, walk, deadline).run();
  }
}

}  // namespace accdec
