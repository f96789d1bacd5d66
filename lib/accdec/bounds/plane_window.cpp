#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <accdec/bounds/bound_rows.hpp>
#include <accdec/bounds/corner_bound.hpp>
#include <accdec/bounds/plane_window.hpp>

namespace accdec {
namespace {

constexpr int side = 12;  // steps before the corner, and after it
// Steps grow away from the corner, where motions bend most: moment k of a side is at (k/side)^growth of its time.
constexpr double growth = 1.3;
constexpr double narrow = 0.008;
constexpr int sectors_max = 40;

/// Shares of the time after which the corner is passed.
struct Shares {
  double low = 0.0, high = 1.0;
};

using Entries = std::vector<std::pair<int, double>>;

/// The right side of a row.
struct Side {
  std::array<double, 4> powers{};  // of the time, over the side at the program's time
  bool both = false;
};
double value(const std::array<double, 4>& powers, double time) {
  return powers[0] + time * (powers[1] + time * (powers[2] + time * powers[3]));
}

/// When moments -1 .. are, in shares of the time from the corner.
struct Moments {
  std::array<double, 2 * side + 2> shares{};
  double operator()(int moment) const { return shares[static_cast<std::size_t>(moment + 1)]; }
};

/// The linear program for a range of shares. Columns are the positions from the corner at every moment.
class PlaneProgram {
 public:
  PlaneProgram(const PlaneWindow& window, const Machine& machine, std::size_t dimensions, const Shares& shares,
               double time, std::vector<unsigned char>& basis)
      : window_(window), machine_(machine), shares_(shares), time_(time), rows_(0) {
    corner_ = window.in == nullptr ? 0 : side;
    count_ = corner_ + side;
    for (int k = -1; k <= count_; ++k) {
      const double part = std::pow(std::abs(k - corner_) / static_cast<double>(side), growth);
      const double whole = k < corner_ && window.in != nullptr ? shares.low : 1.0 - shares.high;
      at_.shares[static_cast<std::size_t>(k + 1)] = k < corner_ ? -whole * part : whole * part;
    }
    double axes2 = 0.0;
    for (std::size_t a = 0; a < dimensions; ++a) {
      const bool moves = window.out->direction[a] != 0.0 || window.after_normal[a] != 0.0 ||
                         window.before_normal[a] != 0.0 || (window.in != nullptr && window.in->direction[a] != 0.0);
      if (moves) active_.push_back(a);
      axes2 += machine.axes[a].velocity_max * machine.axes[a].velocity_max;
    }
    // On either side of the corner the feed is that of the faster leg, as in tube_loss.
    scale_.feed = std::max(window.out->feed, window.in == nullptr ? 0.0 : window.in->feed);
    scale_.speed = std::min(scale_.feed, std::sqrt(axes2));
    scale_.unit = scale_.speed * time / (2.0 * side);
    rows_ = BoundRows((count_ + 1) * static_cast<int>(active_.size()));
    plane_ = LegPlane(window.in == nullptr ? AxisVector{} : window.in->direction, window.out->direction, active_);
    for (std::size_t i = 0; i < active_.size(); ++i) add_axis(i);
    add_feed();
    add_places();
    solve(basis);
  }

  /// The time that every motion of these shares takes at least, s.
  double least_time() const {
    const double goal = (window_.before + window_.after) / scale_.unit * (1.0 - 1e-9);
    double low = 0.0, high = 4.0 * time_;
    if (!(way(low) < goal)) return 0.0;
    for (int i = 0; i < 40; ++i) {
      const double middle = 0.5 * (low + high);
      (way(middle) < goal ? low : high) = middle;
    }
    return low;
  }

 private:
  int column(int moment, std::size_t i) const {
    return moment * static_cast<int>(active_.size()) + static_cast<int>(i);
  }
  Entries along(const AxisVector& d, int moment, double factor) const {
    Entries entries;
    for (std::size_t i = 0; i < active_.size(); ++i) {
      if (d[active_[i]] != 0.0) entries.emplace_back(column(moment, i), factor * d[active_[i]]);
    }
    return entries;
  }
  /// entries (m) <= powers of the time (m); on both sides of zero if asked.
  void add(Entries entries, const std::array<double, 4>& powers, bool both) {
    const double most = value(powers, time_);
    if (!(most < unlimited)) return;
    for (auto& entry : entries) entry.second *= scale_.unit / most;
    rows_.add(entries, both ? -1.0 : -BoundRows::none, 1.0);
    Side limit{powers, both};
    for (double& power : limit.powers) power /= most;
    sides_.push_back(limit);
  }

  void add_axis(std::size_t i) {
    const Axis& limits = machine_.axes[active_[i]];
    const double v = limits.velocity_max, a = acceleration_most(limits), jerk = limits.jerk_max;
    const bool rest = window_.in == nullptr;
    for (int k = 1; k <= count_; ++k) {
      add_divided(i, k - 1, 1, v);
      if (k >= 2) add_divided(i, k - 2, 2, a / 2.0);
      if (k >= (rest ? 2 : 3)) add_divided(i, k - 3, 3, jerk / 6.0);
    }
    if (!rest) return;
    // In the first step no farther than at the largest acceleration, or jerk, throughout.
    const double step = at_(1);
    add({{column(1, i), 1.0}}, {0.0, 0.0, 0.5 * a * step * step, 0.0}, true);
    add({{column(1, i), 1.0}}, {0.0, 0.0, 0.0, jerk * step * step * step / 6.0}, true);
  }
  /// The divided difference of moments first .. first + order is at most `most`. Before a rest the motion is in the
  /// corner.
  void add_divided(std::size_t i, int first, int order, double most) {
    if (!(most < unlimited)) return;
    double scale = unlimited;  // the largest factor becomes 1
    Entries entries;
    for (int k = first; k <= first + order; ++k) {
      double product = 1.0;
      for (int l = first; l <= first + order; ++l) product *= l == k ? 1.0 : at_(k) - at_(l);
      if (k >= 0) entries.emplace_back(column(k, i), 1.0 / product);
      scale = std::min(scale, std::abs(product));
    }
    for (auto& entry : entries) entry.second *= scale;
    std::array<double, 4> powers{};
    powers[static_cast<std::size_t>(order)] = most * scale;
    add(entries, powers, true);
  }

  void add_feed() {
    if (!(scale_.feed < unlimited)) return;
    const double last = window_.in == nullptr ? 0.0 : plane_.angle_of(window_.in->direction);
    const double beside = last < 0.0 ? -0.4 : 0.4;
    for (int m = -1; m <= 5; ++m) {
      const AxisVector d = plane_.at_angle(m < 0 ? -beside : m > 4 ? last + beside : 0.25 * m * last);
      for (int k = 0; k < count_; ++k) {
        Entries entries = along(d, k + 1, 1.0);
        for (const auto& entry : along(d, k, -1.0)) entries.push_back(entry);
        add(entries, {0.0, scale_.feed * (at_(k + 1) - at_(k)), 0.0, 0.0}, false);
      }
    }
  }

  void add_places() {
    constexpr int corners = 24;
    for (int m = 0; m < corners && window_.in != nullptr; ++m) {
      const AxisVector d = plane_.at_angle(2.0 * std::numbers::pi * m / corners);
      add(along(d, corner_, 1.0), {std::max(window_.tolerance, 1e-9), 0.0, 0.0, 0.0}, false);
    }
    const AxisVector back = combined(-1.0, window_.out->direction, 0.0, window_.out->direction);
    for (int k = 0; k <= count_; ++k) {
      if (k < corner_) add_tube(k, plane_.angle_of(window_.in->direction), window_.in->radius);
      if (k > corner_) add_tube(k, plane_.angle_of(back), window_.out->radius);
    }
    // The first and the last moment are at most `between` away from the planes.
    const double between = (shares_.high - shares_.low) * scale_.speed;
    if (window_.in != nullptr) {
      const double room = between * norm(window_.before_normal);
      add(along(window_.before_normal, 0, -1.0), {window_.before, room, 0.0, 0.0}, false);
      const double room_after = between * norm(window_.after_normal);
      add(along(window_.after_normal, count_, 1.0), {window_.after, room_after, 0.0, 0.0}, false);
    }
  }
  void add_tube(int moment, double away, double radius) {
    if (!(radius < unlimited)) return;
    for (int m = -2; m <= 2; ++m) {
      const AxisVector d = plane_.at_angle(away + 0.25 * std::numbers::pi * m);
      if (dot(d, d) > 1e-12) add(along(d, moment, 1.0), {std::max(radius, 1e-9), 0.0, 0.0, 0.0}, false);
    }
  }

  /// How far a moment is from the corner, in units.
  double far(int moment, double time) const {
    if (window_.in == nullptr && moment == 0) return 0.0;
    return 1.001 * (scale_.speed * std::abs(at_(moment)) * time + window_.tolerance + 1e-3 * scale_.unit) / scale_.unit;
  }
  void solve(std::vector<unsigned char>& basis) {
    const std::size_t n = active_.size(), columns = (static_cast<std::size_t>(count_) + 1) * n;
    std::vector<double> high(columns), low(columns);
    costs_.assign(columns, 0.0);
    for (int k = 0; k <= count_; ++k) {
      for (std::size_t i = 0; i < n; ++i) high[static_cast<std::size_t>(column(k, i))] = far(k, time_);
    }
    for (std::size_t j = 0; j < columns; ++j) low[j] = -high[j];
    for (std::size_t i = 0; i < n; ++i) {
      if (window_.in != nullptr) costs_[static_cast<std::size_t>(column(0, i))] += window_.before_normal[active_[i]];
      costs_[static_cast<std::size_t>(column(count_, i))] -= window_.after_normal[active_[i]];
    }
    multipliers_ = rows_.multipliers(costs_, low, high, basis);
  }
  /// The longest way along both normals in this time, by the multipliers, in units. It grows with the time.
  double way(double time) const {
    double sum = 0.0;
    for (std::size_t r = 0; r < multipliers_.rows.size(); ++r) {
      if (multipliers_.rows[r] != 0.0) sum += std::abs(multipliers_.rows[r]) * value(sides_[r].powers, time);
    }
    const std::size_t n = active_.size();
    for (std::size_t j = 0; j < costs_.size(); ++j)
      sum += std::abs(costs_[j] - multipliers_.part[j]) * far(static_cast<int>(j / n), time);
    // Between the moments and the planes at full speed.
    const double left = window_.in == nullptr ? 0.0 : (shares_.high - shares_.low) * time;
    return sum + left * scale_.speed * std::max(norm(window_.before_normal), norm(window_.after_normal)) / scale_.unit;
  }

  const PlaneWindow& window_;
  const Machine& machine_;
  const Shares shares_;
  const double time_;  // s, that the multipliers are of
  struct {
    double feed = 0.0, speed = 0.0, unit = 0.0;  // m/s, m/s, m
  } scale_;
  int corner_ = 0, count_ = 0;  // moments
  Moments at_;
  std::vector<std::size_t> active_;  // axes
  LegPlane plane_;
  BoundRows rows_;
  std::vector<Side> sides_;
  std::vector<double> costs_;
  BoundRows::Multipliers multipliers_;
};

}  // namespace

double plane_time(const PlaneWindow& window, const Machine& machine, std::size_t dimensions,
                  const std::function<bool()>& more) {
  double speed = std::max(window.out->feed, window.in == nullptr ? 0.0 : window.in->feed), axes2 = 0.0;
  for (std::size_t a = 0; a < dimensions; ++a) axes2 += machine.axes[a].velocity_max * machine.axes[a].velocity_max;
  speed = std::min(speed, std::sqrt(axes2));
  if (!(speed < unlimited) || !(window.tolerance < unlimited)) return 0.0;
  std::vector<unsigned char> basis;
  const auto least = [&](const Shares& shares, double guess) {
    double best = 0.0;
    for (int i = 0; i < 4 && more(); ++i) {
      const double time = PlaneProgram(window, machine, dimensions, shares, guess, basis).least_time();
      best = std::max(best, time);
      if (std::abs(time - guess) < 1e-2 * guess) break;
      guess = time > 0.0 ? time : 0.7 * guess;  // beyond the least time the planes alone bound the way
    }
    return best;
  };
  const double guess = (window.before + window.after) / speed;
  if (window.in == nullptr) return least({0.0, 0.0}, guess);
  struct Sector {
    Shares shares;
    double time;
  };
  // A side takes some time even at full speed, and answers beyond `most` are cut to it.
  const double most = 4.0 * guess;
  const auto least_share = [&](double way, const AxisVector& normal) {
    return std::clamp((way / norm(normal) - window.tolerance) / (speed * most), 0.0, 0.4);
  };
  const double from = least_share(window.before, window.before_normal);
  const double to = 1.0 - least_share(window.after, window.after_normal);
  if (!(from > 0.0 && to < 1.0)) return 0.0;
  const double middle = std::clamp(window.before / (window.before + window.after), from + 0.1, to - 0.1);
  std::vector<Sector> sectors;
  double low = from;
  for (const double high : {middle - 0.08, middle, middle + 0.08, to}) {
    if (!(high > low)) continue;
    sectors.push_back({{low, high}, least({low, high}, guess)});
    low = high;
  }
  const auto first = [&] {
    return std::min_element(sectors.begin(), sectors.end(),
                            [](const Sector& a, const Sector& b) { return a.time < b.time; });
  };
  for (int i = 0; i < sectors_max && more(); ++i) {
    const auto smallest = first();
    const Sector whole = *smallest;
    if (whole.shares.high - whole.shares.low <= narrow) break;
    const double half = 0.5 * (whole.shares.low + whole.shares.high);
    const double start = whole.time > 0.0 ? whole.time : guess;
    const Shares left{whole.shares.low, half}, right{half, whole.shares.high};
    *smallest = {left, std::max(whole.time, least(left, start))};
    sectors.push_back({right, std::max(whole.time, least(right, start))});
  }
  return std::min(first()->time, most);
}

}  // namespace accdec
