#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <accdec/bounds/bound_rows.hpp>
#include <accdec/bounds/corner_bound.hpp>
#include <accdec/bounds/leg_plane.hpp>
#include <accdec/bounds/tube_window.hpp>

namespace accdec {
namespace {

using Vector = AxisVector;

/// The linear program of a window. Columns are the positions from the corner, of every moment the axes that either leg
/// moves, in units of what the feed passes between two moments.
class WindowProgram {
 public:
  static constexpr int moments = 24;

  /// @param in  nullptr: at rest in the corner at first
  WindowProgram(const TubeLeg* in, const TubeLeg& out, double tolerance, double before, double after,
                const Machine& machine, std::size_t dimensions)
      : in_(in), out_(out), tolerance_(tolerance), machine_(machine), rows_(0) {
    scale_.step = (before + after) / moments;
    before_ = static_cast<int>(std::floor(before / scale_.step + 1e-9));
    count_ = before_ + static_cast<int>(std::floor(after / scale_.step + 1e-9));
    double axes2 = 0.0;
    for (std::size_t a = 0; a < dimensions; ++a) {
      if (out.direction[a] != 0.0 || (in != nullptr && in->direction[a] != 0.0)) active_.push_back(a);
      axes2 += machine.axes[a].velocity_max * machine.axes[a].velocity_max;
    }
    // On either side of the corner's moment the feed is that of the faster leg: what a filter does around a step of the
    // feed is allowed here.
    scale_.feed = std::max(out.feed, in == nullptr ? 0.0 : in->feed);
    scale_.unit = std::min(scale_.feed, std::sqrt(axes2)) * scale_.step;
    if (!(scale_.unit < unlimited) || active_.empty()) count_ = 0;
    rows_ = BoundRows(columns());
    plane_ = LegPlane(in == nullptr ? Vector{} : in->direction, out.direction, active_);
    for (const std::size_t a : active_) add_axis(a);
    add_feed();
    add_places();
    make_ranges();
  }

  TubeLoss loss() const {
    const double before = before_ * scale_.step, after = (count_ - before_) * scale_.step;
    TubeLoss loss;
    loss.both = before + after + least(true, true);
    loss.in = in_ == nullptr ? 0.0 : before + least(true, false);
    loss.out = in_ == nullptr ? loss.both : after + least(false, true);
    return loss;
  }

 private:
  int columns() const { return (count_ + 1) * static_cast<int>(active_.size()); }
  int column(int moment, std::size_t i) const {
    return moment * static_cast<int>(active_.size()) + static_cast<int>(i);
  }
  std::vector<std::pair<int, double>> along(const Vector& d, int moment, double factor) const {
    std::vector<std::pair<int, double>> entries;
    for (std::size_t i = 0; i < active_.size(); ++i) {
      if (d[active_[i]] != 0.0) entries.emplace_back(column(moment, i), factor * d[active_[i]]);
    }
    return entries;
  }

  Vector at_angle(double angle) const { return plane_.at_angle(angle); }
  double angle_of(const Vector& v) const { return plane_.angle_of(v); }

  void add_axis(std::size_t axis) {
    const auto i = static_cast<std::size_t>(std::find(active_.begin(), active_.end(), axis) - active_.begin());
    const Axis& limits = machine_.axes[axis];
    const double h = scale_.step;
    add_differences(i, {1.0, -1.0}, limits.velocity_max * h);
    add_differences(i, {1.0, -2.0, 1.0}, acceleration_most(limits) * h * h);
    add_differences(i, {1.0, -3.0, 3.0, -1.0}, limits.jerk_max * h * h * h);
    if (in_ == nullptr && count_ > 0) {
      // In its first step from rest no farther than at the largest acceleration, or jerk, throughout.
      const double most = std::min(0.5 * acceleration_most(limits), limits.jerk_max * h / 6.0) * h * h;
      if (most < unlimited) rows_.add({{column(1, i), scale_.unit / most}}, -1.0, 1.0);
    }
  }
  void add_differences(std::size_t i, const std::vector<double>& difference, double most) {
    if (!(most < unlimited)) return;
    const int length = static_cast<int>(difference.size());
    // Before the start it stood still in the corner, which is 0.
    for (int k = in_ == nullptr ? 2 : length - 1; k <= count_; ++k) {
      std::vector<std::pair<int, double>> entries;
      for (int j = 0; j < length && j <= k; ++j) {
        entries.emplace_back(column(k - j, i), difference[static_cast<std::size_t>(j)] * scale_.unit / most);
      }
      rows_.add(entries, -1.0, 1.0);
    }
  }

  void add_feed() {
    if (!(scale_.feed < unlimited)) return;
    const double last = in_ == nullptr ? 0.0 : angle_of(in_->direction), side = last < 0.0 ? -1.0 : 1.0;
    for (int m = -1; m <= 5; ++m) {
      const Vector d = at_angle(m < 0 ? -0.4 * side : m > 4 ? last + 0.4 * side : 0.25 * m * last);
      for (int k = 0; k < count_; ++k) {
        auto entries = along(d, k + 1, 1.0);
        for (const auto& entry : along(d, k, -1.0)) entries.push_back(entry);
        rows_.add(entries, -BoundRows::none, scale_.feed * scale_.step / scale_.unit);
      }
    }
  }

  /// How far beyond the end of a leg, and beside it, every moment may be.
  void add_places() {
    constexpr int sides = 24;
    const double tolerance = std::max(tolerance_, 1e-9);  // of an exact corner a thousandth of a micrometre
    for (int m = 0; m < sides && in_ != nullptr; ++m) {
      rows_.add(along(at_angle(2.0 * std::numbers::pi * m / sides), before_, scale_.unit / tolerance), -BoundRows::none,
                1.0);
    }
    for (int k = 0; k <= count_; ++k) {
      if (k < before_) add_tube(k, angle_of(in_->direction), in_->radius);
      if (k > before_) add_tube(k, angle_of(combined(-1.0, out_.direction, 0.0, out_.direction)), out_.radius);
    }
  }
  void add_tube(int moment, double away, double radius) {
    if (!(radius < unlimited)) return;
    const double room = std::max(radius, 1e-9);
    for (int m = -2; m <= 2; ++m) {
      const Vector d = at_angle(away + 0.25 * std::numbers::pi * m);
      if (dot(d, d) > 1e-12) rows_.add(along(d, moment, scale_.unit / room), -BoundRows::none, 1.0);
    }
  }

  /// Ranges of the columns: how far the highest speed goes.
  void make_ranges() {
    high_.resize(static_cast<std::size_t>(columns()));
    for (int k = 0; k <= count_; ++k) {
      const double far =
          in_ == nullptr && k == 0 ? 0.0 : 1.001 * (std::abs(k - before_) + tolerance_ / scale_.unit + 1e-3);
      for (std::size_t i = 0; i < active_.size(); ++i) high_[static_cast<std::size_t>(column(k, i))] = far;
    }
    low_ = high_;
    for (double& value : low_) value = -value;
  }

  /// The least of what the positions at the ends of the window say, s.
  double least(bool first, bool last) const {
    if (count_ == 0) return 0.0;
    std::vector<double> costs(high_.size(), 0.0);
    for (std::size_t i = 0; i < active_.size(); ++i) {
      const std::size_t a = active_[i];
      if (first && in_ != nullptr)
        costs[static_cast<std::size_t>(column(0, i))] += in_->pace[a] * scale_.unit / scale_.step;
      if (last) costs[static_cast<std::size_t>(column(count_, i))] -= out_.pace[a] * scale_.unit / scale_.step;
    }
    return scale_.step * rows_.multipliers(costs, low_, high_).least(costs, low_, high_);
  }

  const TubeLeg* in_;
  const TubeLeg& out_;
  const double tolerance_;
  const Machine& machine_;
  struct {
    double step = 0.0, feed = unlimited, unit = 1.0;  // s, m/s, m
  } scale_;
  int before_ = 0, count_ = 0;       // moments
  std::vector<std::size_t> active_;  // axes
  LegPlane plane_;
  BoundRows rows_;
  std::vector<double> low_, high_;
};

}  // namespace

TubeLoss tube_loss(const TubeWindow& window, const Machine& machine, std::size_t dimensions) {
  const double e = window.tolerance;
  if (!(e < unlimited)) return {-unlimited, -unlimited, -unlimited};
  const TubeLoss uncut{-norm(combined(1.0, window.in->pace, -1.0, window.out->pace)) * e, -norm(window.in->pace) * e,
                       -norm(window.out->pace) * e};
  if (!(window.before > 0.0 && window.after > 0.0)) return uncut;
  const TubeLoss loss =
      WindowProgram(window.in, *window.out, e, window.before, window.after, machine, dimensions).loss();
  return {std::max(loss.both, uncut.both), std::max(loss.in, uncut.in), std::max(loss.out, uncut.out)};
}

TubeLoss rest_loss(const TubeLeg& leg, double after, const Machine& machine, std::size_t dimensions) {
  TubeLoss loss;
  if (!(after > 0.0)) return loss;
  loss.both = std::max(0.0, WindowProgram(nullptr, leg, 0.0, 0.0, after, machine, dimensions).loss().both);
  loss.out = loss.both;
  return loss;
}

}  // namespace accdec
