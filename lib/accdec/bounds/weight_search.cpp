#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include <accdec/bounds/envelope_system.hpp>
#include <accdec/bounds/weight_search.hpp>

namespace accdec {
namespace {

constexpr int steps_max = 60;
constexpr double steps_usual = 30.0;
constexpr double work_of_a_weight = 500.0;  // in a step, beside the linear system's
constexpr double side_pieces_max = 10.0;    // of a leg, on either side
// With a jerk limit, half as long pieces raise the bound of short programs; on long ones that search ends too early.
constexpr std::size_t fine_legs_max = 150;
constexpr double least_step = 0.5;
constexpr double roughest = 0.1, finest = 2e-4, finer = 0.6;  // smoothing, against the time of a piece

/// A part of a linear function: a weight's factor, and how the factor changes with the time of a leg.
struct Entry {
  std::size_t index = 0;
  double factor = 0.0;
  std::size_t time = 0;
  double change = 0.0;
};
struct Form {
  std::array<Entry, 4> entries{};
  std::size_t count = 0;
  void add(const Entry& entry) { entries[count++] = entry; }
};
/// `weight` times the norm of linear functions is taken off.
struct Norm {
  std::array<Form, program_axis_count> forms{};
  std::size_t count = 0;
  double weight = 0.0;
  std::size_t time = 0;
  double change = 0.0;  // of the weight with that time
  double unit = 0.0;    // s, of the smoothing
};

std::vector<std::vector<double>> shares_of(const WeightedSection& section, double coarse) {
  // Pieces are shorter near joints. With a jerk limit the acceleration bends there.
  const double growth = section.jerk() ? 1.6 : 1.3, finest_piece = section.jerk() ? 0.07 : 0.1;
  double mean = 0.0;
  for (const auto& leg : section.legs) mean += leg.guess / static_cast<double>(section.legs.size());
  std::vector<std::vector<double>> shares;
  for (const auto& leg : section.legs) {
    const double half = 0.5 * leg.guess, reach = std::min(half, leg.reach);
    const double piece = finest_piece * coarse * std::min(leg.reach, 2.0 * mean);
    const double most = side_pieces_max / std::min(1.0, coarse);
    const auto side = static_cast<std::size_t>(std::clamp(std::ceil(reach / piece), 1.0, most));
    std::vector<double> some;
    for (std::size_t k = 0; k <= side; ++k)
      some.push_back(0.5 * reach / half * std::pow(static_cast<double>(k) / static_cast<double>(side), growth));
    std::vector<double>& all = shares.emplace_back(some);
    if (all.back() > 0.49) all.pop_back(), all.push_back(0.5), some.pop_back();
    for (std::size_t k = some.size(); k-- > 0;) all.push_back(1.0 - some[k]);
  }
  return shares;
}

/// The first weight that shares a norm or a time with each.
std::vector<std::size_t> envelope(const MotionWeights& w) {
  std::vector<std::size_t> first(w.value.size(), 0);
  const auto put = [&](std::size_t begin, std::size_t count, std::size_t column) {
    for (std::size_t i = begin; i < begin + count; ++i) first[i] = std::min(column, i);
  };
  for (std::size_t leg = 0; leg < w.legs(); ++leg) {
    const std::size_t time = w.time(leg);
    const std::size_t last = leg > 0 ? std::min(w.time(leg - 1), w.p(leg - 1, w.pieces(leg - 1) - 1)) : 0;
    for (std::size_t k = 0; k < w.pieces(leg); ++k) {
      const std::size_t piece = w.p(leg, k), before = k > 0 ? w.p(leg, k - 1) : last;
      put(piece, w.axes(), piece > time ? std::min(time, before) : before);
      put(w.k(leg, k + 1), w.node(), piece >= w.p(leg, w.pieces(leg) / 2) ? std::min(time, w.k(leg, k)) : w.k(leg, k));
    }
    put(time, 1, last);
  }
  return first;
}

class WeightSearch {
 public:
  WeightSearch(const WeightedSection& section, MotionWeights weights)
      : section_(section),
        w_(std::move(weights)),
        system_(envelope(w_)),
        slope_(w_.value.size()),
        is_time_(w_.value.size()) {
    double speed2 = 0.0;
    for (const auto& axis : section.axes) speed2 += axis.velocity * axis.velocity;
    for (std::size_t leg = 0; leg < w_.legs(); ++leg) {
      time(leg) = section.legs[leg].guess;
      is_time_[w_.time(leg)] = true;
      const double speed2_most = std::min(speed2, std::pow(section.feed(leg), 2));
      for (std::size_t k = 0; k < w_.pieces(leg); ++k) {
        for (std::size_t a = 0; a < w_.axes(); ++a) w_.value[w_.p(leg, k) + a] = section.legs[leg].way[a] / speed2_most;
      }
    }
  }
  /// Products of a search.
  double work() const {
    return steps_usual * (system_.work() + work_of_a_weight * static_cast<double>(w_.value.size()));
  }

  double largest(const std::function<bool()>& more, std::optional<MotionWeights>* of) {
    double best = 0.0, smooth = roughest;
    for (int i = 0, better = 0; i < steps_max && (smooth > finest || i < better + 6) && more(); ++i) {
      const double step = advance(smooth);
      if (!std::isfinite(step)) break;
      if (step > 0.9) smooth = std::max(finest, finer * smooth);
      const double time = weighted_time(section_, w_);
      if (time > best * (1.0 + 2e-5)) better = i;
      if (of != nullptr && time > best) *of = w_;
      best = std::max(best, time);
    }
    return best;
  }

 private:
  double& time(std::size_t leg) { return w_.value[w_.time(leg)]; }

  /// One step. @returns its length; 1: a whole Newton step
  double advance(double smooth) {
    system_.clear();
    std::fill(slope_.begin(), slope_.end(), 0.0);
    smooth_ = smooth;
    for (std::size_t leg = 0; leg < w_.legs(); ++leg) {
      ways_ = 0.0;
      for (std::size_t k = 0; k < w_.pieces(leg); ++k) add_piece(leg, k);
      add_way(leg);
      if (leg + 1 < w_.legs()) add_joint(leg);
    }
    std::vector<double> change(slope_.size());
    for (std::size_t i = 0; i < change.size(); ++i) change[i] = -slope_[i];
    for (std::size_t i = 0; i < change.size(); ++i) {
      if (!is_time_[i]) system_.add(i, i, 1e-12 * system_.diagonal(i) - 1e-30);
    }
    system_.solve(change);
    double step = 1.0;
    for (std::size_t leg = 0; leg < w_.legs(); ++leg) {
      // Times that change by much go only a part of their way, by themselves.
      double& moved = change[w_.time(leg)];
      const double part = moved / time(leg), most = std::clamp(part, -0.2, 0.25);
      if (part != most) step = std::min(step, most / part);
      moved = most * time(leg);
    }
    const double weights = std::max(step, least_step);
    for (std::size_t i = 0; i < change.size(); ++i) w_.value[i] += (is_time_[i] ? 1.0 : weights) * change[i];
    return step;
  }

  void take_off(const Norm& norm) {
    if (!(norm.weight > 0.0)) return;
    const double round = smooth_ * norm.unit / norm.weight;
    double s2 = round * round;
    std::array<double, program_axis_count> v{};
    for (std::size_t a = 0; a < norm.count; ++a) {
      const Form& form = norm.forms[a];
      for (std::size_t x = 0; x < form.count; ++x) v[a] += form.entries[x].factor * w_.value[form.entries[x].index];
      s2 += v[a] * v[a];
    }
    const double s = std::sqrt(s2), bend = norm.weight / s, true_bend = bend * round * round / s2;
    if (norm.change != 0.0) slope_[norm.time] -= norm.change * s;
    for (std::size_t a = 0; a < norm.count; ++a) {
      const Form& form = norm.forms[a];
      const double pull = bend * v[a];
      for (std::size_t x = 0; x < form.count; ++x) {
        const Entry& e = form.entries[x];
        slope_[e.index] -= pull * e.factor;
        if (norm.change != 0.0) system_.add(e.index, norm.time, -norm.change * v[a] / s * e.factor);
        for (std::size_t y = 0; y <= x; ++y)
          system_.add(e.index, form.entries[y].index, -bend * e.factor * form.entries[y].factor);
        if (e.change == 0.0) continue;
        const double moved = e.change * w_.value[e.index];
        slope_[e.time] -= pull * moved;
        system_.add(e.index, e.time, -pull * e.change);
        for (std::size_t y = 0; y < form.count; ++y)
          system_.add(form.entries[y].index, e.time, -true_bend * form.entries[y].factor * moved);
      }
    }
    // Half of what the norm's slope turns by.
    const double turn = 0.5 * norm.weight / (s * s2);
    for (std::size_t a = 0; a < norm.count; ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        const Form &f = norm.forms[a], &g = norm.forms[b];
        for (std::size_t x = 0; x < f.count; ++x) {
          for (std::size_t y = 0; y < (a == b ? x + 1 : g.count); ++y)
            system_.add(f.entries[x].index, g.entries[y].index,
                        turn * v[a] * v[b] * f.entries[x].factor * g.entries[y].factor);
        }
      }
    }
  }

  void add_piece(std::size_t leg, std::size_t k) {
    const double length = w_.length(leg, k);
    Norm norm;
    norm.time = w_.time(leg);
    norm.unit = time(leg) / static_cast<double>(w_.pieces(leg));
    for (std::size_t a = 0; a < w_.axes(); ++a) add_acceleration(leg, k, a, norm);
    norm.change = 0.0;
    norm.weight = section_.feed(leg);
    norm.count = w_.axes();
    for (std::size_t a = 0; a < w_.axes(); ++a) {
      Form& form = norm.forms[a] = {};
      form.add({w_.k(leg, k + 1) + a, 1.0});
      form.add({w_.k(leg, k) + a, -1.0});
      form.add({w_.p(leg, k) + a, -length});
    }
    if (norm.weight < unlimited) {
      take_off(norm);
    } else {
      const auto forms = norm.forms;
      norm.count = 1;
      for (std::size_t a = 0; a < w_.axes(); ++a) {
        norm.forms[0] = forms[a];
        norm.weight = section_.axes[a].velocity;
        take_off(norm);
      }
    }
    if (k > 0) add_tube(leg, k, norm);
  }

  /// At two places of a piece.
  void add_acceleration(std::size_t leg, std::size_t k, std::size_t a, Norm norm) {
    const double length = w_.length(leg, k), h = time(leg);
    const auto& axis = section_.axes[a];
    norm.count = 1;
    const bool jerk = axis.jerk < unlimited;
    for (const double part : {0.2113248654051871, 0.7886751345948129}) {
      norm.weight = 0.5 * length * axis.acceleration;
      Form& form = norm.forms[0] = {};
      form.add({w_.k(leg, k) + a, h * (1.0 - part), norm.time, 1.0 - part});
      form.add({w_.k(leg, k + 1) + a, h * part, norm.time, part});
      if (jerk) form.add({w_.m(leg, k + 1) + a, 1.0 / length}), form.add({w_.m(leg, k) + a, -1.0 / length});
      take_off(norm);
    }
    for (std::size_t end = k; jerk && end <= k + 1; ++end) {
      norm.weight = 0.5 * length * axis.jerk * h;
      norm.change = norm.weight / h;
      norm.forms[0] = {};
      norm.forms[0].add({w_.m(leg, end) + a, 1.0});
      take_off(norm);
    }
  }

  void add_tube(std::size_t leg, std::size_t k, Norm norm) {
    const auto& of = section_.legs[leg];
    const double h = time(leg);
    norm.count = w_.axes();
    norm.weight = of.radius / h;
    norm.change = -norm.weight / h;
    for (std::size_t a = 0; a < w_.axes(); ++a) {
      Form& form = norm.forms[a] = {};
      form.add({w_.p(leg, k - 1) + a, 1.0});
      form.add({w_.p(leg, k) + a, -1.0});
    }
    take_off(norm);
    AxisVector change{};
    for (std::size_t a = 0; a < w_.axes(); ++a) change[a] = w_.value[w_.p(leg, k - 1) + a] - w_.value[w_.p(leg, k) + a];
    add_along(leg, k, norm.unit);
    ways_ -= of.radius * accdec::norm(change) + 0.5 * std::abs(dot(change, of.way));
  }
  /// |d . way|/(2 h) of the change d of p.
  void add_along(std::size_t leg, std::size_t k, double unit) {
    const auto& way = section_.legs[leg].way;
    const double h = time(leg), weight = 0.5 / h, round = smooth_ * unit / weight;
    double v = 0.0;
    for (std::size_t a = 0; a < w_.axes(); ++a)
      v += way[a] * (w_.value[w_.p(leg, k - 1) + a] - w_.value[w_.p(leg, k) + a]);
    const double s = std::sqrt(round * round + v * v), bend = weight / s * (1.0 - 0.5 * v * v / (s * s));
    slope_[w_.time(leg)] += weight * s / h;
    const auto index = [&](std::size_t i) { return w_.p(leg, i < w_.axes() ? k - 1 : k) + i % w_.axes(); };
    const auto factor = [&](std::size_t i) { return i < w_.axes() ? way[i] : -way[i - w_.axes()]; };
    for (std::size_t i = 0; i < 2 * w_.axes(); ++i) {
      slope_[index(i)] -= weight * v / s * factor(i);
      system_.add(index(i), w_.time(leg), weight / h * v / s * factor(i));
      for (std::size_t j = 0; j <= i; ++j) system_.add(index(i), index(j), -bend * factor(i) * factor(j));
    }
  }

  void add_way(std::size_t leg) {
    const double h = time(leg);
    const std::size_t at = w_.time(leg);
    slope_[at] += 1.0;
    for (const std::size_t k : {std::size_t{0}, w_.pieces(leg) - 1}) {
      for (std::size_t a = 0; a < w_.axes(); ++a) {
        const std::size_t index = w_.p(leg, k) + a;
        const double half = 0.5 * section_.legs[leg].way[a];
        ways_ += half * w_.value[index];
        slope_[index] += half / h;
        slope_[at] -= half * w_.value[index] / (h * h);
        system_.add(index, at, -half / (h * h));
      }
    }
    system_.add(at, at, std::max(2.0 * ways_ / (h * h * h), 0.5 / h));
  }

  void add_joint(std::size_t leg) {
    const std::size_t last = w_.pieces(leg) - 1;
    const double h = time(leg), g = time(leg + 1);
    Norm norm;
    norm.count = w_.axes();
    norm.weight = section_.legs[leg].tolerance;
    norm.unit = h / static_cast<double>(w_.pieces(leg));
    for (std::size_t a = 0; a < w_.axes(); ++a) {
      norm.forms[a].add({w_.p(leg, last) + a, 1.0 / h, w_.time(leg), -1.0 / (h * h)});
      norm.forms[a].add({w_.p(leg + 1, 0) + a, -1.0 / g, w_.time(leg + 1), 1.0 / (g * g)});
    }
    take_off(norm);
  }

  const WeightedSection& section_;
  MotionWeights w_;
  EnvelopeSystem system_;
  std::vector<double> slope_;
  std::vector<bool> is_time_;
  double smooth_ = 0.0;
  double ways_ = 0.0;  // of a leg, times its time
};

}  // namespace

double largest_weighted_time(const WeightedSection& section, double& work_left, const std::function<bool()>& more,
                             std::optional<MotionWeights>* best) {
  const double legs = static_cast<double>(section.legs.size()), axes = static_cast<double>(section.axes.size());
  for (const double coarse : {0.5, 1.0, 1.5, 2.5, 5.0, 20.0}) {
    if (coarse < 1.0 && (!section.jerk() || section.legs.size() > fine_legs_max)) continue;
    // Every leg has two pieces or more, each with a K and a p for every axis.
    if (steps_usual * work_of_a_weight * 4.0 * axes * legs > work_left) break;
    WeightSearch search(section, {section.axes.size(), section.jerk(), shares_of(section, coarse)});
    if (search.work() > work_left) continue;
    work_left -= search.work();
    return search.largest(more, best);
  }
  return 0.0;
}

}  // namespace accdec
