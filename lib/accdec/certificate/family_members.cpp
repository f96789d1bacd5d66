#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/certificate/family_members.hpp>

namespace accdec {

bool settable(const SettableStage& stage, int samples, double period) {
  const double time = samples * period;
  const auto same = [](double a, double b) { return std::abs(a - b) <= 1e-6 * b; };
  if (!stage.length_set.empty())
    return std::any_of(stage.length_set.begin(), stage.length_set.end(), [&](double t) { return same(time, t); });
  const double step = stage.length_step > 0.0 ? stage.length_step : period;
  if (!same(time, std::max(1.0, std::round(time / step)) * step)) return false;
  return stage.length_max <= 0.0 || time <= stage.length_max * (1.0 + 1e-9);
}

namespace {

/// Taps behind another moving average, not divided by its length: whole numbers stay whole.
std::vector<double> summed(const std::vector<double>& taps, int length) {
  std::vector<double> sums(taps.size() + static_cast<std::size_t>(length) - 1);
  double sum = 0.0;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    if (i < taps.size()) sum += taps[i];
    if (i >= static_cast<std::size_t>(length)) sum -= taps[i - static_cast<std::size_t>(length)];
    sums[i] = sum;
  }
  return sums;
}

/// The impulses of a shaper by its name in tasks, in any scale.
std::vector<double> impulses_of(std::string_view shaper) {
  if (shaper == "zv") return {1.0, 1.0};
  if (shaper == "zvd") return {1.0, 2.0, 1.0};
  if (shaper == "ei") return {21.0, 38.0, 21.0};  // 0.05 left: 1.05, 1.9, 1.05
  return {1.0, std::numbers::sqrt2, 1.0};         // mzv: 1 - 1/sqrt 2, sqrt 2 - 1
}

/// Impulses at samples.
struct Echo {
  std::vector<std::pair<std::size_t, double>> impulses;  ///< sample and weight, in the order of the samples
  std::string words;

  std::size_t order() const { return impulses.back().first; }

  std::vector<double> behind(const std::vector<double>& taps) const {
    std::vector<double> sum(taps.size() + order(), 0.0);
    for (const auto& [at, weight] : impulses) {
      for (std::size_t i = 0; i < taps.size(); ++i) sum[i + at] += weight * taps[i];
    }
    return sum;
  }
};

/// Equally far apart, samples. Between two samples an impulse is on both, most on the nearer.
Echo echo_of(const std::vector<double>& weights, double delay) {
  Echo echo{.impulses = {},
            .words = fmt::format(" with {} impulses {:.9g} {} apart", weights.size(), delay,
                                 delay == 1.0 ? "sample" : "samples")};
  for (std::size_t m = 0; m < weights.size(); ++m) {
    const double at = static_cast<double>(m) * delay, nearest = std::round(at);
    if (std::abs(at - nearest) < 1e-9) {
      echo.impulses.emplace_back(static_cast<std::size_t>(nearest), weights[m]);
      continue;
    }
    const double before = std::floor(at), behind = before + 1.0;
    echo.impulses.emplace_back(static_cast<std::size_t>(before), weights[m] * (behind - at));
    echo.impulses.emplace_back(static_cast<std::size_t>(behind), weights[m] * (at - before));
  }
  return echo;
}

/// All that a task's shaper can be set to, for filters of orders below `order_end`, the shortest first.
std::vector<Echo> echoes_of(const Task& task, int order_end) {
  const ShaperInfo& shaper = *task.settings->shaper;
  const std::vector<double> weights = impulses_of(shaper.name);
  const double apart = shaper.name == "mzv" ? 0.375 : 0.5;  // periods
  std::vector<Echo> echoes;
  const auto add = [&](double delay) {
    Echo echo = echo_of(weights, delay);
    const bool fits = static_cast<int>(echo.order()) < order_end;
    if (fits) echoes.push_back(std::move(echo));
    return fits;
  };
  const double step = task.settings->shaper_frequency_step;
  if (step > 0.0) {
    const double highest = apart / task.sample_period / step;
    for (double m = std::floor(highest * (1.0 + 1e-12)); m >= 1.0; --m) {
      if (!add(std::max(1.0, apart / (m * step * task.sample_period)))) break;
    }
    return echoes;
  }
  for (double delay = 1.0; add(delay);) ++delay;
  return echoes;
}

bool alike(const SettableStage& a, const SettableStage& b) {
  return a.length_step == b.length_step && a.length_max == b.length_max && a.length_set == b.length_set;
}

class Cascades {
 public:
  using Visit = std::function<void(const FamilyMember&, const std::string&)>;
  using Skip = std::function<bool(const AveragesOutline&)>;
  /// @param echoes  what can be behind the averages, the shortest first
  Cascades(const Task& task, std::vector<Echo> echoes, int order_end, const Visit& visit, const Skip& skip)
      : task_(task), echoes_(std::move(echoes)), order_end_(order_end), visit_(visit), skip_(skip) {}

  void run() { stage(0, 0); }

 private:
  void stage(std::size_t s, int order) {
    if (s == task_.settings->stages.size()) return echo(order);
    const int room = order_end_ - 1 - order;
    for (int length = 1; length - 1 <= room; ++length) {
      // One sample is a stage that is off. Stages that are alike are in any order.
      const SettableStage& stage_here = task_.settings->stages[s];
      if (length > 1 && !settable(stage_here, length, task_.sample_period)) continue;
      if (s > 0 && alike(stage_here, task_.settings->stages[s - 1]) && length > lengths_.back()) break;
      lengths_.push_back(length);
      stage(s + 1, order + length - 1);
      lengths_.pop_back();
    }
  }

  void echo(int order) {
    std::vector<double> taps;
    for (const Echo& echo : echoes_) {
      const int all = order + static_cast<int>(echo.order());
      if (all >= order_end_) return;
      if (all < task_.design.order_min || (skip_ && skip_({lengths_, echo.impulses}))) continue;
      if (taps.empty()) {
        taps = {1.0};
        for (const int length : lengths_) taps = summed(taps, length);
      }
      visit_(member_of(echo.behind(taps)),
             fmt::format("averages of {} samples{}", fmt::join(lengths_, ", "), echo.words));
    }
  }

  const Task& task_;
  std::vector<Echo> echoes_;
  int order_end_;
  const Visit& visit_;
  const Skip& skip_;
  std::vector<int> lengths_;
};

/// Poles in series: of every stage its constants, equal stages with falling ones.
class PolesInSeries {
 public:
  PolesInSeries(const Task& task, int order_end, const Cascades::Visit& visit)
      : task_(task), order_end_(order_end), visit_(visit) {}

  void run() { stage(0, {1.0}); }

 private:
  void stage(std::size_t s, const std::vector<double>& taps) {
    const auto& stages = task_.settings->stages;
    if (s == stages.size()) {
      if (static_cast<int>(taps.size()) > task_.design.order_min && static_cast<int>(taps.size()) <= order_end_)
        visit_(member_of(taps), fmt::format("poles of {} samples", fmt::join(constants_, ", ")));
      return;
    }
    for (int constant = 0; constant <= order_end_; ++constant) {
      if (constant > 0 && !settable(stages[s], constant, task_.sample_period)) continue;
      if (s > 0 && alike(stages[s], stages[s - 1]) && constant > constants_.back()) return;
      constants_.push_back(constant);
      const std::vector<double> longer = constant > 0 ? taps_of_poles(constants_, order_end_) : taps;
      const bool fits = static_cast<int>(longer.size()) <= order_end_;
      if (fits) stage(s + 1, longer);
      constants_.pop_back();
      if (!fits) return;
    }
  }

  const Task& task_;
  int order_end_;
  const Cascades::Visit& visit_;
  std::vector<int> constants_;
};

/// The numbers that a task's grid has for a family, in the order of their size: multiples of its step up to its end.
std::vector<double> numbers_of(const Task& task, SettingFamily family, int order) {
  const ControllerSettings& settings = *task.settings;
  double step = settings.alpha_step, end = 6.0;
  if (family == SettingFamily::exponential) {
    step = settings.time_constant_step > 0.0 ? settings.time_constant_step : task.sample_period;
    end = task.sample_period * (task.design.order_max + 1);
  } else if (family == SettingFamily::windowed_sinc) {
    step = settings.cutoff_step;
    end = 1.0 / (task.sample_period * order);
  }
  std::vector<double> numbers;
  for (int i = 1; i * step <= end * (1.0 + 1e-9); ++i) numbers.push_back(std::min(i * step, end));
  return numbers;
}

void visit_grid(const Task& task, SettingFamily family, int order_end, const Cascades::Visit& visit) {
  if (task.design.order_min <= 0 && order_end > 0) visit(member_of({1.0}), "no filter");
  const int least = family == SettingFamily::windowed_sinc ? 2 : 1;
  for (int order = std::max(least, task.design.order_min); order < order_end; ++order) {
    if (!settable(task.settings->stages.front(), order + 1, task.sample_period)) continue;
    for (const double number : numbers_of(task, family, order))
      visit(member_of(grid_taps(family, order, number, task.sample_period)),
            fmt::format("{} of {} samples and {:.6g}", to_string(family), order + 1, number));
  }
}

}  // namespace

FamilyMember member_of(std::vector<double> taps) {
  const double sum = std::accumulate(taps.begin(), taps.end(), 0.0);
  const std::size_t n = taps.size();
  FamilyMember member{std::move(taps), std::vector<double>(n + 1), std::vector<double>(n + 1),
                      std::vector<double>(n + 1), std::vector<double>(n + 1)};
  for (double& tap : member.taps) tap /= sum;
  // Four sums side by side: each waits for its own last addition.
  double gone = 0.0, left = 0.0, way_left = 0.0, way_gone = 0.0;
  for (std::size_t k = 0, back = n; back-- > 0; ++k) {
    member.gone[k + 1] = gone += member.taps[k];
    member.way_gone[k + 1] = way_gone += gone;
    member.way_left[back] = way_left += left;
    member.left[back] = left += member.taps[back];
  }
  return member;
}

std::vector<double> grid_taps(SettingFamily family, int order, double number, double period) {
  std::vector<double> taps(static_cast<std::size_t>(order) + 1);
  const double half = 0.5 * order;
  for (int i = 0; i <= order; ++i) {
    double& tap = taps[static_cast<std::size_t>(i)];
    const double from_middle = std::abs(i - half);
    if (family == SettingFamily::exponential) {
      tap = std::exp(-i * period / number);
    } else if (family == SettingFamily::gaussian) {
      tap = std::exp(-0.5 * std::pow(number * from_middle / half, 2));
    } else {
      const double turn = std::numbers::pi * from_middle / half,
                   x = 2.0 * std::numbers::pi * number * period * from_middle;
      const double window = 0.42 + 0.5 * std::cos(turn) + 0.08 * std::cos(2.0 * turn);
      const bool end = i == 0 || i == order;
      tap = end ? 0.0 : std::max(0.0, window) * (x == 0.0 ? 1.0 : std::max(0.0, std::sin(x) / x));
    }
  }
  return taps;
}

std::vector<double> taps_of_poles(const std::vector<int>& constants, int most) {
  // The rest of the step: what each pole still holds, in the order of the poles. Its rounding is added, so that an
  // exact 1e-4 ends here as it does by the logarithm.
  std::vector<double> held, taps;
  for (const int constant : constants) {
    if (constant > 0) held.push_back(0.0);
  }
  if (held.empty()) return {1.0};
  double rest = 1.0;
  for (int i = 0; rest > 1e-4 * (1.0 + 1e-10) && i <= most; ++i) {
    double arrives = i == 0 ? 1.0 : 0.0;
    std::size_t s = 0;
    rest = 0.0;
    for (const int constant : constants) {
      if (constant <= 0) continue;
      const double all = held[s] + arrives, stays = all * std::exp(-1.0 / constant);
      held[s++] = stays, arrives = -all * std::expm1(-1.0 / constant), rest += stays;
    }
    taps.push_back(arrives);
  }
  return taps;
}

void visit_family(const Task& task, SettingFamily family, int order_end,
                  const std::function<void(const FamilyMember&, const std::string&)>& visit,
                  const std::function<bool(const AveragesOutline&)>& skip) {
  order_end = std::min(order_end, task.design.order_max + 1);
  switch (family) {
    case SettingFamily::taps: return;
    case SettingFamily::averages: return Cascades(task, {Echo{{{0, 1.0}}, ""}}, order_end, visit, skip).run();
    case SettingFamily::shaper: return Cascades(task, echoes_of(task, order_end), order_end, visit, skip).run();
    case SettingFamily::one_pole: return PolesInSeries(task, order_end, visit).run();
    case SettingFamily::exponential:
    case SettingFamily::gaussian:
    case SettingFamily::windowed_sinc: return visit_grid(task, family, order_end, visit);
  }
}

}  // namespace accdec
