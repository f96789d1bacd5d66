#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include <accdec/families/family_search.hpp>
#include <accdec/families/grid_family.hpp>
#include <accdec/families/poles.hpp>
#include <accdec/families/settable_search.hpp>
#include <accdec/files.hpp>
#include <accdec/filter.hpp>

namespace accdec {
namespace {

/// All members of a family with so many stages by their orders, with the stages' lengths of the one visited last.
class Members {
 public:
  Members(const Task& task, SettingFamily family, int stages_on)
      : task_(task),
        family_(family),
        stages_on_(stages_on),
        shaper_(family == SettingFamily::shaper ? task.settings->shaper : nullptr),
        pairs_(shaper_ != nullptr ? shaper_->pairs : 0),
        delays_(shaper_ != nullptr ? shaper_delays(task, task.design.order_max) : std::vector{0.0}) {
    for (const SettableStage& stage : task.settings->stages) {
      lengths_.push_back(stage_options(family, stage, task.sample_period, task.design.order_max + 1));
      std::vector<char> allowed(static_cast<std::size_t>(task.design.order_max) + 2, 0);
      for (const int length : lengths_.back()) allowed[static_cast<std::size_t>(length)] = 1;
      allowed_.push_back(std::move(allowed));
      if (find_grid_family(family) != nullptr) break;  // it has one time
    }
    for (std::size_t s = 1; s < lengths_.size(); ++s) as_before_.push_back(lengths_[s] == lengths_[s - 1]);
    current_.assign(lengths_.size(), 0);
    if (family == SettingFamily::one_pole) poles_ = all_poles(lengths_, task.design.order_max);
  }

  void visit(int order, const MemberVisitor& visit) {
    if (const GridFamily* grid = find_grid_family(family_)) return visit_grid(*grid, order, visit);
    if (family_ == SettingFamily::one_pole) return visit_poles(order, visit);
    for (const double delay : delays_) {
      pair_delay_ = delay;
      const int left = order - FilterSpec{.pairs = pairs_, .pair_delay = delay}.full_order();
      if (left < 0 || !stage(0, stages_on_, left, visit)) return;
    }
  }

  /// 0: off.
  std::vector<int> lengths() const {
    std::vector<int> lengths = current_;
    if (family_ != SettingFamily::one_pole) std::replace(lengths.begin(), lengths.end(), 1, 0);
    return lengths;
  }

  /// The real number of the member visited last, in steps; 0: off, or the family has none.
  int multiple() const { return multiple_; }

 private:
  void visit_poles(int order, const MemberVisitor& visit) {
    const auto shorter = [](const Poles& poles, int than) { return poles.order < than; };
    auto at = std::lower_bound(poles_.begin(), poles_.end(), order, shorter);
    for (; at != poles_.end() && at->order == order; ++at) {
      current_ = at->constants;
      const auto off = std::count(current_.begin(), current_.end(), 0);
      if (static_cast<std::ptrdiff_t>(current_.size()) - off != stages_on_) continue;
      if (!visit(cut_poles({current_.begin(), current_.end()}), {})) return;
    }
  }

  void visit_grid(const GridFamily& grid, int order, const MemberVisitor& visit) {
    if (allowed_.front()[static_cast<std::size_t>(order) + 1] == 0) return;
    current_.front() = order + 1;
    multiple_ = 0;
    if (order == 0) return static_cast<void>(visit({.kind = Shape::boxcar}, {}));
    if (order < grid.least_order) return;
    const int last = largest_multiple(task_, family_, order);
    for (multiple_ = 1; multiple_ <= last; ++multiple_) {
      if (!visit(grid_member(task_, family_, order, multiple_), {})) return;
    }
  }

  /// Equal stages are in any order: their lengths fall. @param on  stages from here on that are not off
  bool stage(std::size_t s, int on, int left, const MemberVisitor& visit) {
    if (on > static_cast<int>(lengths_.size() - s)) return true;
    const int most = s > 0 && as_before_[s - 1] ? current_[s - 1] : left + 1;
    if (s + 1 == lengths_.size()) {
      if (left + 1 > most || allowed_[s][static_cast<std::size_t>(left) + 1] == 0 || on != (left > 0 ? 1 : 0))
        return true;
      current_[s] = left + 1;
      return offer(visit);
    }
    for (const int length : lengths_[s]) {
      if (length > most || length - 1 > left || (length > 1 && on == 0)) break;
      current_[s] = length;
      if (!stage(s + 1, on - (length > 1 ? 1 : 0), left - (length - 1), visit)) return false;
    }
    return true;
  }

  bool offer(const MemberVisitor& visit) {
    const FilterSpec spec = settable_spec(family_, current_, shaper_, pair_delay_);
    return visit(spec, spec.lengths);
  }

  const Task& task_;
  SettingFamily family_;
  int stages_on_;
  const ShaperInfo* shaper_;
  int pairs_, multiple_ = 0;
  std::vector<double> delays_;  ///< between impulses, samples; 0: there are none
  double pair_delay_ = 0.0;
  std::vector<std::vector<int>> lengths_;  ///< of each stage, rising
  std::vector<std::vector<char>> allowed_;
  std::vector<bool> as_before_;  ///< of each stage from the second on: whether it is like the one before
  std::vector<Poles> poles_;     ///< of the family one-pole
  std::vector<int> current_;
};

/// Searches one family for what is below the best so far. @param stages_on  of averages and poles: how many are not off
void search_family(const Task& task, SettingFamily family, int stages_on, const std::function<bool()>& stop,
                   SettableDesign& best) {
  const Family& like = *find_family(family == SettingFamily::one_pole ? "exponential" : "averages");
  Members members(task, family, stages_on);
  const FamilySearch* search = nullptr;
  double cheapest = best.cost;
  std::vector<int> lengths;
  int multiple = 0;
  const FamilySearch::Members visit_order = [&](int order, const MemberVisitor& visit) {
    members.visit(order, [&](const FilterSpec& spec, std::span<const int> own) {
      const bool more = visit(spec, own);
      if (search->best() && search->cost() < cheapest)
        cheapest = search->cost(), lengths = members.lengths(), multiple = members.multiple();
      return more;
    });
  };
  FamilySearch found(task, like, best.cost, visit_order);
  search = &found;
  found.run(stop);
  best.complete = best.complete && found.complete();
  best.tried += found.tried();
  if (!found.best()) return;
  best.cost = found.cost();
  best.delays = found.delays();
  ChosenSettings chosen = chosen_settings(task, family, *found.best(), lengths, multiple);
  chosen.delays = best.delays.kinds;
  chosen.width = best.delays.width;
  best.chosen = std::move(chosen);
}

/// The lengths that step, cap or set of a stage allow, samples, rising; without that of a stage that is off.
/// @param most  samples: longer ones are left out
std::vector<int> settable_lengths(const SettableStage& stage, double period, int most) {
  std::vector<int> lengths;
  const auto samples = [=](double time) { return std::lround(std::min(time / period, 1e9)); };
  if (!stage.length_set.empty()) {
    for (const double length : stage.length_set) {
      if (samples(length) <= most) lengths.push_back(static_cast<int>(samples(length)));
    }
    return lengths;
  }
  const long step = stage.length_step > 0.0 ? std::max(1L, samples(stage.length_step)) : 1L;
  const double cap = stage.length_max > 0.0 ? std::floor(stage.length_max / period * (1.0 + 1e-9)) : 1e9;
  const long last = static_cast<long>(std::min<double>(cap, most));
  for (long length = step; length <= last; length += step) lengths.push_back(static_cast<int>(length));
  return lengths;
}

/// A time as it is entered: with nine decimals, or nine digits where these are more. In minutes a millisecond
/// is 1.7e-5.
double entered(double time) {
  if (!(time > 0.0)) return 0.0;
  const double unit = std::pow(10.0, std::max(9.0, 8.0 - std::floor(std::log10(time))));
  return std::round(time * unit) / unit;
}

/// Settings of stages in a controller's words, off stages as 0. @param lengths  samples, one a stage; 0: off
std::vector<Setting> values_of(const ControllerSettings& settings, const std::vector<int>& lengths, double period) {
  std::vector<Setting> values;
  for (std::size_t s = 0; s < lengths.size(); ++s) {
    const SettableStage& stage = settings.stages[s];
    const double time = lengths[s] * period;
    values.push_back({stage.name, entered(time / stage.unit_seconds), stage.unit});
  }
  return values;
}

/// The frequency to which a filter's shaper is set. @param filter  with a shaper that these settings allow
Setting shaper_setting(const ControllerSettings& settings, const FilterSpec& filter, double period) {
  const ShaperInfo& shaper = *shaper_of(filter);
  double frequency = shaper.delay_periods / (filter.pair_delay * period);
  // A multiple of the step, without digits that rounding made.
  if (const double step = settings.shaper_frequency_step; step > 0.0)
    frequency = std::stod(fmt::format("{:.15g}", std::round(frequency / step) * step));
  return {std::string(shaper.title), frequency, "Hz"};
}

}  // namespace

std::vector<int> stage_options(SettingFamily family, const SettableStage& stage, double period, int most) {
  const int off = family == SettingFamily::one_pole ? 0 : 1;
  std::vector<int> lengths = settable_lengths(stage, period, most);
  std::erase_if(lengths, [off](int length) { return length <= off; });
  lengths.insert(lengths.begin(), off);
  return lengths;
}

FilterSpec settable_spec(SettingFamily family, const std::vector<int>& lengths, const ShaperInfo* shaper,
                         double pair_delay) {
  if (family == SettingFamily::one_pole) return cut_poles({lengths.begin(), lengths.end()});
  FilterSpec spec{.kind = Shape::averages};
  if (shaper != nullptr) spec.pairs = shaper->pairs, spec.outer = shaper->outer, spec.pair_delay = pair_delay;
  for (const int length : lengths) {
    if (length > 1) spec.lengths.push_back(length), spec.order += length - 1;
  }
  if (spec.lengths.empty()) spec.lengths.push_back(1);
  std::sort(spec.lengths.begin(), spec.lengths.end(), std::greater<>());
  return spec;
}

ChosenSettings chosen_settings(const Task& task, SettingFamily family, const FilterSpec& filter,
                               const std::vector<int>& lengths, int multiple) {
  ChosenSettings chosen{.family = family, .filter = filter};
  chosen.values = values_of(*task.settings, lengths, task.sample_period);
  if (multiple > 0) chosen.values.push_back(grid_setting(task, family, multiple));
  if (shaper_of(filter) != nullptr) chosen.values.push_back(shaper_setting(*task.settings, filter, task.sample_period));
  return chosen;
}

std::vector<double> shaper_delays(const Task& task, int order_max) {
  const ShaperInfo& shaper = *task.settings->shaper;
  const double longest = static_cast<double>(order_max) / shaper.pairs, step = task.settings->shaper_frequency_step;
  std::vector<double> delays;
  if (step <= 0.0) {
    for (int delay = 1; delay <= longest; ++delay) delays.push_back(delay);
    return delays;
  }
  const double all = shaper.delay_periods / (step * task.sample_period);  // of the lowest frequency
  for (auto m = static_cast<int>(all * (1.0 + 1e-12)); m >= 1 && all / m <= longest + shaper_snap; --m)
    delays.push_back(std::max(1.0, all / m));
  return delays;
}

SettableDesign best_settings(const Task& task, double seconds, const std::atomic<bool>* cancel) {
  const auto began = std::chrono::steady_clock::now();
  const auto stop = [=] { return seconds_since(began) >= seconds || (cancel != nullptr && cancel->load()); };
  SettableDesign best;
  best.complete = true;
  // Members of few stages are few, too. They are looked at in any time, and their best bounds the others.
  for (int stages_on = 0; stages_on <= static_cast<int>(task.settings->stages.size()); ++stages_on) {
    for (const SettingFamily family : task.settings->families) {
      const bool cascade = find_grid_family(family) == nullptr && family != SettingFamily::taps;
      if (cascade || (stages_on == 1 && family != SettingFamily::taps))
        search_family(task, family, stages_on, stop, best);
    }
  }
  return best;
}

}  // namespace accdec
