#include <fmt/format.h>

#include <accdec/design/exact/certificate.hpp>
#include <accdec/design/exact/interval.hpp>
#include <accdec/design/limit_rows.hpp>
#include <accdec/design/verifier.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

namespace accdec {
namespace {

using nlohmann::json;

struct Rejected : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct Range {
  int d1, d2, k1, k2;
};

class Checker {
 public:
  Checker(const Task& task, const json& certificate, double target)
      : task_(task), tree_(certificate.at("tree")), multipliers_(certificate.at("multipliers")), target_(target) {
    const Interval t(task.sample_period);
    for (std::size_t a = 0; a < task.machine.axes.size(); ++a) {
      const Axis& axis = task.machine.axes[a];
      double start = 0.0, stop = 0.0;
      for (const TaskCorner& c : task.corners) {
        // Lower ends: a slower leg asks for less.
        const double in = speed(c, a, true).magnitude().lo, out = speed(c, a, false).magnitude().lo;
        start = std::max({start, in, in == 0.0 ? out : 0.0});
        stop = std::max({stop, out, out == 0.0 ? in : 0.0});
      }
      start_.push_back(start);
      stop_.push_back(stop);
      const double fastest = std::max(start, stop);
      if (fastest == 0.0) continue;
      if (axis.acceleration_max < unlimited)
        tap_max_ = std::min(tap_max_, (Interval(axis.acceleration_max) * t / fastest).hi);
      if (axis.jerk_max < unlimited) jerk_max_ = std::min(jerk_max_, (Interval(axis.jerk_max) * t * t / fastest).hi);
      if (axis.force_max < unlimited && axis.damping == 0.0 && axis.mass > 0.0) {
        tap_max_ = std::min(tap_max_, (Interval(axis.force_max) * t / (Interval(axis.mass) * fastest)).hi);
      }
    }
  }

  std::size_t run() {
    std::vector<Range> root;
    for (const TaskCorner& c : task_.corners) {
      const int last = task_.design.order_max + 1;
      const int d1 = c.delay.value_or(0), d2 = c.delay.value_or(last);
      root.push_back({d1, d2, 0, d2 + last});
    }
    node(root, 0);
    if (next_ != tree_.size()) throw Rejected("the tree goes on after its end");
    return leaves_;
  }

 private:
  Interval speed(const TaskCorner& c, std::size_t axis, bool in) const {
    const auto a = static_cast<Eigen::Index>(axis);
    return in ? Interval(c.geometry.feed_in) * c.geometry.direction_in[a]
              : Interval(c.geometry.feed_out) * c.geometry.direction_out[a];
  }

  /// Largest order with which a design in the box can be shorter than the target; cuts delays that cannot. -1: none.
  int largest_order(std::vector<Range>& box) const {
    const int least = std::max(task_.design.order_min, 0);
    if (std::isinf(target_)) return task_.design.order_max;
    const double limit = target_ * (1.0 - 1e-9);
    double weights = 0.0, value = 0.0;
    for (std::size_t j = 0; j < box.size(); ++j)
      weights += task_.corners[j].weight, value += task_.corners[j].weight * box[j].d1;
    const int order =
        static_cast<int>(std::min<double>(task_.design.order_max, std::ceil((limit - value) / weights - 1.0) - 1.0));
    if (order < least) return -1;
    for (std::size_t j = 0; j < box.size(); ++j) {
      const double room = (limit - value - weights * (least + 1)) / task_.corners[j].weight;
      box[j].d2 = std::min(box[j].d2, box[j].d1 + static_cast<int>(std::clamp(room, 0.0, 1e8)));
    }
    return order;
  }

  void node(std::vector<Range> box, int depth) {
    if (next_ >= tree_.size()) throw Rejected("the tree is cut off: not every pair of order and delay is refuted");
    if (depth > 500) throw Rejected("the tree is too deep");
    const json& entry = tree_[next_++];
    const std::vector<Range> whole = box;
    const int order = largest_order(box);
    if (order >= 0) {
      for (Range& r : box) r.k2 = std::min(r.k2, order + r.d2 + 1);
    }
    const bool empty = order < 0 || std::any_of(box.begin(), box.end(), [](const Range& r) { return r.k1 > r.k2; });
    if (entry.is_null()) {
      if (!empty) throw Rejected(fmt::format("{} is left out as too long, but is not", describe(box, order)));
      return;
    }
    if (entry.is_number_integer()) {
      leaf(entry.get<int>(), box, order, -1);
    } else if (entry.is_array() && entry.size() == 3 && entry[1].is_string()) {
      split(entry, whole, depth);
    } else if (entry.is_array() && entry.size() == 2 && task_.design.symmetric) {
      const int least = std::max(task_.design.order_min, 0);
      if (order >= least) leaf(entry[0].get<int>(), box, order, order);
      if (order - 1 >= least) leaf(entry[1].get<int>(), box, order - 1, order - 1);
    } else {
      throw Rejected("an entry of the tree is none of the known kinds");
    }
  }

  void split(const json& entry, const std::vector<Range>& box, int depth) {
    const int j = entry[0].get<int>(), at = entry[2].get<int>();
    if (j < 0 || j >= static_cast<int>(box.size())) throw Rejected("the tree splits a corner that is not there");
    std::vector<Range> first = box, second = box;
    Range &a = first[static_cast<std::size_t>(j)], &b = second[static_cast<std::size_t>(j)];
    const bool delay = entry[1] == "d";
    if (!delay && entry[1] != "k") throw Rejected("the tree splits neither a delay nor a sample");
    if (at < (delay ? a.d1 : a.k1) || at >= (delay ? a.d2 : a.k2)) throw Rejected("the tree splits outside the box");
    (delay ? a.d2 : a.k2) = at;
    (delay ? b.d1 : b.k1) = at + 1;
    node(first, depth + 1);
    node(second, depth + 1);
  }

  static std::string describe(const std::vector<Range>& box, int order) {
    std::string text = fmt::format("order up to {}", order);
    for (const Range& r : box) text += fmt::format(", d = {} .. {} (k = {} .. {})", r.d1, r.d2, r.k1, r.k2);
    return text;
  }

  const TaskCorner& corner(int j) const {
    if (j < 0 || j >= static_cast<int>(task_.corners.size()))
      throw Rejected("a multiplier names a corner that is not there");
    return task_.corners[static_cast<std::size_t>(j)];
  }
  const Axis& axis(int a) const {
    if (a < 0 || a >= static_cast<int>(task_.machine.axes.size()))
      throw Rejected("a multiplier names an axis that is not there");
    return task_.machine.axes[static_cast<std::size_t>(a)];
  }

  /// sum_i c_i b_i > rhs has to hold for every filter.
  struct Sum {
    std::vector<Interval> taps, cumulative;  // coefficients of b_i and of B_k
    Interval rhs;
    void tap(int i, const Interval& c) {
      if (i >= 0 && i < static_cast<int>(taps.size()))
        taps[static_cast<std::size_t>(i)] = taps[static_cast<std::size_t>(i)] + c;
    }
    void cumul(int k, const Interval& c) {
      const int n = static_cast<int>(taps.size()) - 1;
      if (k > n)
        rhs = rhs - c;
      else if (k > 0)
        cumulative[static_cast<std::size_t>(k)] = cumulative[static_cast<std::size_t>(k)] + c;
    }
  };

  void leaf(int index, const std::vector<Range>& box, int order, int symmetric_order) {
    if (index < 0 || index >= static_cast<int>(multipliers_.size()))
      throw Rejected("the tree names multipliers that are not there");
    ++leaves_;
    Sum sum;
    sum.taps.resize(static_cast<std::size_t>(order) + 1);
    sum.cumulative.resize(static_cast<std::size_t>(order) + 2);
    for (const json& row : multipliers_[static_cast<std::size_t>(index)]) add(row, box, sum);
    Interval suffix(0.0);
    for (std::size_t i = sum.taps.size(); i-- > 0;) {
      suffix = suffix + sum.cumulative[i + 1];
      sum.taps[i] = sum.taps[i] + suffix;
    }
    std::vector<double> least;
    for (const Interval& c : sum.taps) least.push_back(c.lo);
    if (symmetric_order >= 0) {
      const std::vector<double> plain = least;
      for (std::size_t i = 0; i < least.size(); ++i)
        least[i] = (0.5 * (Interval(plain[i]) + Interval(plain[plain.size() - 1 - i]))).lo;
    }
    // For any lambda: sum c b >= lambda + sum u min(0, c - lambda). The best is the c at which the cheapest taps are
    // full.
    const double room = 1.0 / tap_max_;
    if (static_cast<double>(least.size()) < room * (1.0 - 1e-12)) return;  // not even full taps reach a sum of 1
    std::vector<double> sorted = least;
    const auto full = static_cast<std::ptrdiff_t>(std::min(static_cast<double>(sorted.size() - 1), room));
    std::nth_element(sorted.begin(), sorted.begin() + full, sorted.end());
    const double lambda = sorted[static_cast<std::size_t>(full)];
    Interval bound(lambda);
    for (const double c : least) {
      if (c < lambda) bound = bound + Interval(tap_max_) * (Interval(c) - Interval(lambda));
    }
    bound = bound - sum.rhs;
    if (!(bound.lo > 0.0)) {
      throw Rejected(
          fmt::format("{} is not refuted by its multipliers (margin {:.3g})", describe(box, order), bound.lo));
    }
  }

  void add(const json& row, const std::vector<Range>& box, Sum& sum) const {
    const std::string kind = row.at(0).get<std::string>();
    const double y = row.at(row.size() - 1).get<double>();
    if (!(y >= 0.0) || !std::isfinite(y)) throw Rejected("a multiplier is negative or not a number");
    const Interval t(task_.sample_period), weight(y);
    if (kind == "jerk") {
      const int i = row.at(1).get<int>(), sign = row.at(2).get<int>() < 0 ? -1 : 1;
      if (std::isinf(jerk_max_)) throw Rejected("a multiplier names a limit that is not there");
      if (i < 0 || i > static_cast<int>(sum.taps.size())) return;
      const Interval c = weight * static_cast<double>(sign) / Interval(jerk_max_);
      sum.tap(i, c);
      sum.tap(i - 1, -1.0 * c);
      sum.rhs = sum.rhs + weight;
    } else if (kind == "force start" || kind == "force stop") {
      const int a = row.at(1).get<int>(), k = row.at(2).get<int>();
      if (k < 1 || k > static_cast<int>(sum.taps.size())) return;
      const Axis& x = axis(a);
      limit(x.force_max);
      const bool start = kind == "force start";
      const Interval scale = weight * (start ? start_ : stop_)[static_cast<std::size_t>(a)] / Interval(x.force_max);
      sum.tap(k - 1, scale * Interval(x.mass) / t);
      sum.cumul(k, scale * Interval(x.damping));
      sum.rhs = sum.rhs + weight;
      if (!start) sum.rhs = sum.rhs + scale * Interval(x.damping);
    } else if (kind == "error") {
      add_error(row, weight, box, sum);
    } else if (kind == "vibration") {
      add_vibration(row, weight, sum);
    } else {
      add_blend(kind, row, weight, box, sum);
    }
  }

  static void limit(double bound) {
    if (!(bound < unlimited)) throw Rejected("a multiplier names a limit that is not there");
  }

  void add_error(const json& row, const Interval& weight, const std::vector<Range>& box, Sum& sum) const {
    const int j = row.at(1).get<int>();
    const TaskCorner& c = corner(j);
    if (!c.error_max) throw Rejected("a multiplier names a limit that is not there");
    const Range& r = box[static_cast<std::size_t>(j)];
    const Interval cosine(std::nextafter(c.geometry.cos_interior(), -2.0),
                          std::nextafter(c.geometry.cos_interior(), 2.0));
    const Interval sine = square_root((Interval(1.0) - cosine) * (Interval(1.0) + cosine));
    const Interval ca = interval_cos(row.at(2).get<double>()), sa = interval_sin(row.at(2).get<double>());
    const double fastest = std::max(c.feed_in, c.feed_out);
    const Interval wp = weight * ca * Interval(c.feed_in) / Interval(fastest);
    const Interval wq = weight * (cosine * ca + sine * sa) * Interval(c.feed_out) / Interval(fastest);
    Interval p = wp, q = wq;
    if (r.k1 < r.k2 || r.d1 < r.d2) {
      // Within a box p and q are only bounded below; a weight below zero by more than rounding would need an upper
      // bound.
      if (wp.hi < 0.0 || wq.hi < 0.0) throw Rejected("a tangent cut does not apply to a whole box");
      p.lo = std::max(p.lo, 0.0), q.lo = std::max(q.lo, 0.0);
      // Where rounding leaves the sign open, the most that a negative weight could take away: p <= N, q <= k - d.
      if (wp.lo < 0.0) {
        p = Interval(0.0);
        sum.rhs = sum.rhs + Interval(-wp.lo) * static_cast<double>(sum.taps.size());
      }
      if (wq.lo < 0.0) {
        q = Interval(0.0);
        sum.rhs = sum.rhs + Interval(-wq.lo) * static_cast<double>(std::max(0, r.k2 - r.d1));
      }
    }
    const int n = static_cast<int>(sum.taps.size()) - 1, m = r.k1 - r.d2;
    for (int i = std::max(0, r.k2 + 1); i <= n; ++i) sum.tap(i, p * static_cast<double>(i - r.k2));
    for (int i = 0; i <= std::min(n, m - 1); ++i) sum.tap(i, q * static_cast<double>(m - i));
    const Interval error(std::max(*c.error_max, 0.5 * position_floor));
    sum.rhs = sum.rhs + weight * error / (t() * Interval(fastest));
  }

  Interval t() const { return Interval(task_.sample_period); }

  void add_vibration(const json& row, const Interval& weight, Sum& sum) const {
    const int m = row.at(1).get<int>();
    if (m < 0 || m >= static_cast<int>(task_.machine.modes.size()))
      throw Rejected("a multiplier names a mode that is not there");
    const Mode& mode = task_.machine.modes[static_cast<std::size_t>(m)];
    const double f = row.at(2).get<double>();
    if (!(f >= mode.frequency_low && f <= mode.frequency_high))
      throw Rejected("a multiplier's frequency is outside its band");
    const Interval w = two_pi() * Interval(f) * t();
    for (std::size_t i = 0; i < sum.taps.size(); ++i) {
      sum.taps[i] = sum.taps[i] + weight * interval_cos(w * static_cast<double>(i) - Interval(row.at(3).get<double>()));
    }
    sum.rhs = sum.rhs + weight * Interval(mode.residual_max);
  }

  void add_blend(const std::string& kind, const json& row, const Interval& weight, const std::vector<Range>& box,
                 Sum& sum) const {
    const int j = row.at(1).get<int>(), a = row.at(2).get<int>(), k = row.at(3).get<int>();
    const TaskCorner& c = corner(j);
    const Axis& x = axis(a);
    if (k < 1 || k > 100'000'000) throw Rejected("a multiplier names a sample that is not there");
    const Range& r = box[static_cast<std::size_t>(j)];
    if (r.d1 != r.d2) throw Rejected("a limit of the blend is used for several delays at once");
    const Interval in = speed(c, static_cast<std::size_t>(a), true), out = speed(c, static_cast<std::size_t>(a), false);
    const int d = r.d1;
    const Interval y = weight * (row.at(4).get<int>() < 0 ? -1.0 : 1.0);
    // Past the end of a short filter a row has no terms left and may be dropped, which is taking its multiplier as 0.
    const int n = static_cast<int>(sum.taps.size()) - 1;
    const auto tap = [&](int i) { return i >= 0 && i <= n; };
    const auto response = [&](int at) { return at >= 1 && at <= n; };
    const bool touches = tap(k - 1) || tap(k - 1 - d) || (kind == "blend jerk" && (tap(k - 2) || tap(k - 2 - d))) ||
                         (kind == "blend force" && (response(k) || response(k - d)));
    if (!touches) return;
    const auto acceleration = [&](int at, const Interval& f) {
      sum.tap(at - 1, -1.0 * f * in / t());
      sum.tap(at - 1 - d, f * out / t());
    };
    if (kind == "blend acceleration") {
      limit(x.acceleration_max);
      acceleration(k, y / Interval(x.acceleration_max));
    } else if (kind == "blend jerk") {
      limit(x.jerk_max);
      const Interval f = y / (t() * Interval(x.jerk_max));
      acceleration(k, f);
      acceleration(k - 1, -1.0 * f);
    } else if (kind == "blend force") {
      limit(x.force_max);
      const Interval f = y / Interval(x.force_max), drag = f * Interval(x.damping);
      acceleration(k, f * Interval(x.mass));
      sum.rhs = sum.rhs - drag * in;
      sum.cumul(k, -1.0 * drag * in);
      sum.cumul(k - d, drag * out);
    } else {
      throw Rejected("a multiplier is of no known kind");
    }
    sum.rhs = sum.rhs + weight;
  }

  const Task& task_;
  const json& tree_;
  const json& multipliers_;
  double target_, tap_max_ = 1.0, jerk_max_ = unlimited;
  std::vector<double> start_, stop_;
  std::size_t next_ = 0, leaves_ = 0;
};

}  // namespace

CheckReport check_certificate(const Task& task, const DesignResult& result) {
  try {
    if (result.certificate.empty()) return {false, "there is no certificate"};
    const json certificate = json::parse(result.certificate);
    if (certificate.at("schema") != "accdec.certificate/1") {
      return {false, "the certificate's schema is unknown; known is accdec.certificate/1"};
    }
    const std::string kind = certificate.at("kind").get<std::string>();
    if (kind == "constant feed") {
      if (result.status != Status::infeasible)
        return {false, "the certificate is one of infeasibility, the status is not"};
      const auto found = contradictions(task);
      if (found.empty()) return {false, "no limit is broken at constant feed"};
      return {true, found.front()};
    }
    if (kind != "branch and bound") return {false, "the certificate's kind is unknown: " + kind};
    double target = unlimited;
    if (result.status == Status::infeasible) {
      if (!certificate.at("bound_samples").is_null())
        return {false, "the certificate proves a bound, not that nothing exists"};
    } else {
      if (!result.lower_bound) return {false, "the result claims no lower bound"};
      const double claimed = result.status == Status::optimal ? result.cycle_time : *result.lower_bound;
      target = claimed / task.sample_period;
      if (result.status == Status::optimal && *result.lower_bound < result.cycle_time * (1.0 - 1e-9)) {
        return {false, "the status is optimal, but the lower bound is below the cycle time"};
      }
      if (!certificate.at("bound_samples").is_null()) {
        const double proved = certificate.at("bound_samples").get<double>();
        if (proved < target * (1.0 - 1e-9))
          return {false, fmt::format("the certificate proves {} samples, the result claims {}", proved, target)};
        target = proved;
      }
    }
    const std::size_t leaves = Checker(task, certificate, target).run();
    return {true, std::isinf(target) ? fmt::format("{} parts refuted: nothing holds all limits", leaves)
                                     : fmt::format("{} parts refuted: nothing is shorter than {:.9g} s", leaves,
                                                   target * task.sample_period)};
  } catch (const Rejected& e) {
    return {false, e.what()};
  } catch (const json::exception& e) {
    return {false, std::string("the certificate cannot be read: ") + e.what()};
  }
}

}  // namespace accdec
