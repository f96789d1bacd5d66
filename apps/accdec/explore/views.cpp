#include "views.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <accdec/machine.hpp>
#include <accdec/machine/limit_unit.hpp>
#include <accdec/machine/signed_value.hpp>
#include <accdec/plot/figure_style.hpp>
#include <accdec/plot/path_plane.hpp>
#include <accdec/task/simulation.hpp>
#include <accdec/task/verified_contour.hpp>

namespace accdec::explore {
namespace {

using Json = nlohmann::ordered_json;

/// To eight digits of the largest: enough for a picture, and less than half of the text.
std::vector<double> rounded(std::vector<double> values) {
  double peak = 0.0;
  for (const double v : values) peak = std::max(peak, std::abs(v));
  if (!(peak > 0.0) || !std::isfinite(peak)) return values;
  const double scale = std::pow(10.0, std::clamp(7.0 - std::floor(std::log10(peak)), 0.0, 22.0));
  for (double& v : values) v = std::round(v * scale) / scale;
  return values;
}

/// Dashes of the n-th moving axis, px on and off, as figures draw it.
Json dashes_of(int n) {
  const std::string_view gnuplot = figure_style::dashes[static_cast<std::size_t>(n) % figure_style::dashes.size()];
  if (gnuplot.front() != '(') return Json::array();  // solid
  return Json::parse(fmt::format("[{}]", gnuplot.substr(1, gnuplot.size() - 2)));
}

/// The points of a picture: every sample, or of a long motion two for each of many groups of samples. A group is
/// narrower than a pixel, and no peak is lost.
class Points {
 public:
  explicit Points(Eigen::Index samples) : samples_(samples), group_(samples > most ? 1 + 2 * samples / most : 1) {}

  /// The smallest and the largest value of every group, in their order.
  std::vector<double> curve(const std::vector<double>& values) const {
    std::vector<double> shown;
    visit([&](auto first, auto end) {
      const auto [low, high] = std::minmax_element(values.begin() + first, values.begin() + end);
      shown.push_back(*std::min(low, high));
      if (group_ > 1) shown.push_back(*std::max(low, high));
    });
    return rounded(std::move(shown));
  }
  /// The first sample of every group, and the one that `other` names of it.
  template <typename Other>
  std::vector<Eigen::Index> samples(const Other& other) const {
    std::vector<Eigen::Index> shown;
    visit([&](auto first, auto end) {
      shown.push_back(first);
      if (group_ > 1) shown.push_back(other(first, end));
    });
    return shown;
  }
  /// The point of a sample.
  Eigen::Index of(Eigen::Index sample) const { return group_ == 1 ? sample : 2 * (sample / group_); }

 private:
  static constexpr Eigen::Index most = 4000;

  template <typename Visit>
  void visit(const Visit& visit) const {
    for (Eigen::Index first = 0; first < samples_; first += group_) visit(first, std::min(first + group_, samples_));
  }

  Eigen::Index samples_, group_;
};

/// The motion at one corner, in the units of people.
class View {
 public:
  View(const DesignResult& result, std::size_t index)
      : task_(result.task),
        corner_(task_.corners[index]),
        legs_(corner_.geometry()),
        sampled_(simulate_response(*result.filter, legs_, result.corners[index].delay, task_.sample_period,
                                   task_.machine, result.corners[index].feed_part)),
        motion_(sampled_.motion()),
        points_(motion_.velocity.rows()) {}

  Json json() const {
    std::vector<double> time, speed;
    for (const Eigen::Index n : points_.samples([](auto, auto end) { return end - 1; }))
      time.push_back(time_of(static_cast<double>(n)));
    for (Eigen::Index n = 0; n < motion_.velocity.rows(); ++n)
      speed.push_back(motion_.velocity.row(n).norm() * limit_name(LimitKind::velocity).per_si);
    return {{"name", corner_.name},
            {"time_ms", rounded(std::move(time))},
            {"events",
             {{"start", points_.of(motion_.start)},
              {"blend", points_.of(motion_.corner)},
              {"stop", points_.of(motion_.stop)}}},
            {"path", path_json()},
            {"speed_mm_s", points_.curve(speed)},
            {"quantities", quantities_json()}};
  }

 private:
  /// ms from the corner's command. @param sample  or a fraction between two
  double time_of(double sample) const { return (sample - motion_.corner) * task_.sample_period * 1e3; }

  bool moves(std::size_t axis) const {
    const auto a = static_cast<Eigen::Index>(axis);
    return std::max(std::abs(legs_.direction_in[a]), std::abs(legs_.direction_out[a])) >= 1e-12;
  }
  std::vector<double> values(std::size_t axis, LimitKind kind) const {
    std::vector<double> values;
    for (const AxisState& state :
         axis_states(sampled_, task_.machine.axes[axis], static_cast<Eigen::Index>(axis), task_.sample_period,
                     still_part * std::max(legs_.feed_in, legs_.feed_out)))
      values.push_back(signed_value(state, kind) * limit_unit(kind, task_.machine.axes[axis].name).per_si);
    return values;
  }

  /// An axis has its dashes in every chart.
  int line_of(std::size_t axis) const {
    int line = 0;
    for (std::size_t a = 0; a < axis; ++a) line += moves(a) ? 1 : 0;
    return line;
  }
  /// @param high, low  bounds of magnitudes above and below zero, SI
  /// @param line  which one of the dashes
  Json curve_json(const std::string& name, const std::vector<double>& values, double high, double low, LimitKind kind,
                  int line) const {
    const auto bound = [&](double signed_bound) {
      return std::abs(signed_bound) < unlimited ? Json(signed_bound * limit_unit(kind, name).per_si) : Json(nullptr);
    };
    return {{"name", name},
            {"dash", dashes_of(line)},
            {"bounds", {bound(high), bound(-low)}},
            {"values", points_.curve(values)}};
  }
  /// @param like  the name of an axis: those that turn have units of their own
  static void add_quantity(LimitKind kind, Json axes, Json& quantities, std::string_view like = "") {
    const std::string_view unit = kind == LimitKind::force_speed ? "%" : limit_unit(kind, like).name;
    if (!axes.empty())
      quantities.push_back({{"kind", limit_word(kind, like)}, {"unit", unit}, {"axes", std::move(axes)}});
  }

  /// Every axis that moves; a load only of those where it is limited.
  void add_axes(const AxisLimit& limit, Json& quantities) const {
    for (const std::string_view like : {"x", "a"}) {
      Json axes = Json::array();
      for (std::size_t a = 0; a < task_.machine.axes.size(); ++a) {
        const Axis& axis = task_.machine.axes[a];
        const double bound = axis.*limit.bound;
        if (is_rotary(axis.name) == is_rotary(like) && moves(a) && (!limit.load || bound < unlimited))
          axes.push_back(curve_json(axis.name, values(a, limit.kind), bound, bound, limit.kind, line_of(a)));
      }
      add_quantity(limit.kind, std::move(axes), quantities, like);
    }
  }

  /// A limit that is a curve of force by speed: in percent of that.
  void add_force_use(Json& quantities) const {
    Json axes = Json::array();
    for (std::size_t a = 0; a < task_.machine.axes.size(); ++a) {
      const Axis& axis = task_.machine.axes[a];
      if (!moves(a) || !(axis.force_speed_max < unlimited)) continue;
      std::vector<double> used = values(a, LimitKind::force_speed);
      for (double& force : used) force *= 100.0 / axis.force_speed_max;
      axes.push_back(curve_json(axis.name, used, 100.0, unlimited, LimitKind::force_speed, line_of(a)));
    }
    add_quantity(LimitKind::force_speed, std::move(axes), quantities);
  }

  /// Power has a bound of its own for driving, above zero, and for braking, below. If one axis has all the power, the
  /// bounds of the supply are on its curve, too.
  void add_power(Json& quantities) const {
    const Machine& machine = task_.machine;
    std::vector<std::pair<const Axis*, std::vector<double>>> working;
    for (std::size_t a = 0; a < machine.axes.size(); ++a) {
      std::vector<double> power = moves(a) ? values(a, LimitKind::power) : std::vector<double>();
      if (std::any_of(power.begin(), power.end(), [](double p) { return p != 0.0; }))
        working.emplace_back(&machine.axes[a], std::move(power));
    }
    const bool alone = working.size() == 1;
    Json axes = Json::array();
    std::vector<double> sum;
    for (const auto& [axis, power] : working) {
      const double high = alone ? std::min(axis->power_max, machine.power_total_max) : axis->power_max;
      const double low =
          alone ? std::min(axis->regeneration_max, machine.regeneration_total_max) : axis->regeneration_max;
      if (high < unlimited || low < unlimited)
        axes.push_back(curve_json(axis->name, power, high, low, LimitKind::power,
                                  line_of(static_cast<std::size_t>(axis - machine.axes.data()))));
      sum.resize(power.size(), 0.0);
      for (std::size_t n = 0; n < power.size(); ++n) sum[n] += power[n];
    }
    add_quantity(LimitKind::power, std::move(axes), quantities);
    if (working.size() < 2 || !limits_supply(machine)) return;
    add_quantity(LimitKind::power_total,
                 Json::array({curve_json("sum", sum, machine.power_total_max, machine.regeneration_total_max,
                                         LimitKind::power_total, 0)}),
                 quantities);
  }

  Json quantities_json() const {
    Json quantities = Json::array();
    for (const AxisLimit& limit : axis_limits) {
      if (limit.kind == LimitKind::power)
        add_power(quantities);
      else if (limit.kind == LimitKind::force_speed)
        add_force_use(quantities);
      else if (limit.kind != LimitKind::regeneration)
        add_axes(limit, quantities);
    }
    return quantities;
  }

  Json path_json() const {
    const auto [across, up, along, inwards] = plane_of(legs_, task_.machine);
    constexpr double micrometres = 1e6;
    std::vector<double> x, y, off;
    Json between = Json::array();
    const PathDistance path = path_distance(motion_.position, legs_);
    for (std::size_t i = 0; i < path.time.size(); ++i) {
      const double distance = micrometres * path.distance[i];
      if (path.time[i] == std::floor(path.time[i]))
        off.push_back(distance);
      else
        between.push_back({time_of(path.time[i]), distance});
    }
    // The place nearest to the corner is always drawn.
    const auto nearest = [&](Eigen::Index first, Eigen::Index end) {
      Eigen::Index found = 0;
      motion_.position.middleRows(first, end - first).rowwise().squaredNorm().minCoeff(&found);
      return first + found;
    };
    for (const Eigen::Index n : points_.samples(nearest)) {
      const Eigen::VectorXd s = motion_.position.row(n).transpose() * micrometres;
      x.push_back(s.dot(across)), y.push_back(s.dot(up));
    }
    const auto flat = [&, &across = across, &up = up](const Eigen::VectorXd& u) {
      return Json{u.dot(across), u.dot(up)};
    };
    const auto units = [&](const Eigen::VectorXd& u) {
      return Json::array({plane_unit(u, task_.machine, false), plane_unit(u, task_.machine, true)});
    };
    return {{"names", {along, inwards}},
            {"units", Json::array({units(across), units(up)})},
            {"x_um", rounded(std::move(x))},
            {"y_um", rounded(std::move(y))},
            {"in", flat(legs_.direction_in)},
            {"out", flat(legs_.direction_out)},
            {"off_um", points_.curve(off)},
            {"between", std::move(between)}};  // ms, um: where the path is farther off than at both samples
  }

  const Task& task_;
  const TaskCorner& corner_;
  const Corner& legs_;
  const SampledResponse sampled_;
  const SampledMotion& motion_;
  const Points points_;
};

}  // namespace

Json view_json(const DesignResult& result, std::size_t index) {
  if (!result.filter || index >= result.corners.size()) throw std::invalid_argument("there is no such corner to draw");
  if (result.filter->order() >= longest_drawn)
    throw std::invalid_argument(fmt::format("a filter of more than {} taps is not drawn", longest_drawn));
  return View(result, index).json();
}

}  // namespace accdec::explore
