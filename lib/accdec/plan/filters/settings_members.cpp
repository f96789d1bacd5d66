#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

#include <accdec/families/grid_family.hpp>
#include <accdec/families/poles.hpp>
#include <accdec/families/settable_search.hpp>
#include <accdec/plan/filters/settings_members.hpp>

namespace accdec {
namespace {

template <class Number>
Number nearest(const std::vector<Number>& options, double length) {
  const auto above = std::lower_bound(options.begin(), options.end(), length);
  if (above == options.begin()) return options.front();
  if (above == options.end()) return options.back();
  return *above - length < length - *(above - 1) ? *above : *(above - 1);
}

}  // namespace

bool same_taps(const Filter& a, const Filter& b) {
  return std::ranges::equal(a.taps(), b.taps(), [](double x, double y) { return std::abs(x - y) <= 1e-12; });
}

std::vector<int> SettableMember::key() const {
  std::vector<int> key = lengths;
  const double whole = std::floor(spec.pair_delay);
  key.push_back(static_cast<int>(whole));
  key.push_back(static_cast<int>(1e9 * (spec.pair_delay - whole)));
  key.push_back(static_cast<int>(family));
  return key;
}

SettableMembers::SettableMembers(const Task& task) : task_(task) {
  const int longest = task.design.order_max + 1;
  for (const SettableStage& stage : task.settings->stages) {
    poles_.push_back(stage_options(SettingFamily::one_pole, stage, task.sample_period, longest));
    averages_.push_back(stage_options(SettingFamily::averages, stage, task.sample_period, longest));
  }
  if (task.settings->shaper != nullptr) delays_ = shaper_delays(task, task.design.order_max);
  for (const SettingFamily family : families()) list(family);
  std::stable_sort(all_.begin(), all_.end(),
                   [](const SettableMember& a, const SettableMember& b) { return a.order() < b.order(); });
}

std::vector<SettingFamily> SettableMembers::families() const {
  std::vector<SettingFamily> families = task_.settings->families;
  std::erase(families, SettingFamily::taps);
  return families;
}

std::size_t SettableMembers::stages(SettingFamily family) const {
  return find_grid_family(family) != nullptr ? 2 : averages_.size();
}

std::vector<int> SettableMembers::options(SettingFamily family, std::size_t stage) const {
  if (const GridFamily* grid = find_grid_family(family); grid != nullptr && stage == 1) {
    std::vector<int> multiples(static_cast<std::size_t>(largest_multiple(task_, family, grid->least_order)));
    std::iota(multiples.begin(), multiples.end(), 1);
    return multiples;
  }
  return family == SettingFamily::one_pole ? poles_[stage] : averages_[stage];
}

void SettableMembers::add_grid(SettingFamily family, int length, double multiple,
                               std::vector<SettableMember>& members) const {
  const int order = length - 1, most_multiples = order > 0 ? largest_multiple(task_, family, order) : 0;
  if (order < task_.design.order_min || order > task_.design.order_max) return;
  SettableMember member{.family = family, .lengths = {length, 0}};
  if (order == 0) {
    member.spec = {.kind = Shape::boxcar};
  } else {
    if (order < find_grid_family(family)->least_order || most_multiples < 1) return;
    member.lengths[1] = static_cast<int>(std::clamp<double>(std::round(multiple), 1.0, most_multiples));
    member.spec = grid_member(task_, family, order, member.lengths[1]);
  }
  members.push_back(std::move(member));
}

void SettableMembers::add(SettingFamily family, const std::vector<double>& lengths, double pair_delay,
                          std::vector<SettableMember>& members) const {
  if (find_grid_family(family) != nullptr)
    return add_grid(family, nearest(averages_.front(), lengths[0]), lengths[1], members);
  SettableMember member{.family = family};
  for (std::size_t s = 0; s < stages(family); ++s)
    member.lengths.push_back(nearest(options(family, s), s < lengths.size() ? lengths[s] : 1.0));
  // Equal stages are in any order.
  for (std::size_t s = 1; s < member.lengths.size(); ++s) {
    if (averages_[s] == averages_[s - 1] && member.lengths[s] > member.lengths[s - 1])
      std::swap(member.lengths[s], member.lengths[s - 1]), s = 0;
  }
  const ShaperInfo* shaper = shaper_behind(family);
  if (shaper != nullptr && (!(pair_delay > 0.0) || delays_.empty())) return;
  member.spec = settable_spec(family, member.lengths, shaper, shaper != nullptr ? nearest(delays_, pair_delay) : 0.0);
  if (member.order() < task_.design.order_min || member.order() > task_.design.order_max) return;
  members.push_back(std::move(member));
}

std::vector<SettableMember> SettableMembers::spread() const {
  std::vector<SettableMember> members;
  for (const SettingFamily family : families()) {
    std::vector<double> pair_delays{0.0};
    if (const ShaperInfo* shaper = shaper_behind(family)) {
      pair_delays.clear();
      const int longest = task_.design.order_max / shaper->pairs;
      for (int d = 1; d <= longest; d = std::max(d + 1, d * 4 / 3)) pair_delays.push_back(d);
      for (const Mode& mode : task_.machine.modes) {
        const double middle = 0.5 * (mode.frequency_low + mode.frequency_high);
        pair_delays.push_back(shaper->delay_periods / middle / task_.sample_period);
      }
    }
    for (const double delay : pair_delays) {
      for (double order = 1.0; order <= task_.design.order_max; order = std::max(order + 1.0, order * 4.0 / 3.0)) {
        if (const GridFamily* grid = find_grid_family(family)) {
          const int length = static_cast<int>(order) + 1;
          const int last = largest_multiple(task_, family, std::max(length - 1, grid->least_order));
          for (double multiple = 1.0; multiple <= last; multiple = std::max(multiple + 1.0, multiple * 4.0 / 3.0))
            add(family, {order + 1.0, multiple}, 0, members);
          continue;
        }
        if (family == SettingFamily::one_pole) {
          const double constant = order / -std::log(pole_rest);
          add(family, {constant, 0.0, 0.0}, 0, members);
          if (stages(family) > 1) add(family, {0.75 * constant, 0.75 * constant, 0.0}, 0, members);
          continue;
        }
        for (const double part : {0.0, 0.25, 0.5}) {
          const double ramp = part * order, rest = order - ramp;
          add(family, {rest + 1.0, ramp + 1.0, 1.0}, delay, members);
          add(family, {ramp + 1.0, rest + 1.0, 1.0}, delay, members);
          if (stages(family) > 2) add(family, {rest + 1.0, 0.5 * ramp + 1.0, 0.5 * ramp + 1.0}, delay, members);
        }
      }
    }
  }
  return members;
}

std::vector<SettableMember> SettableMembers::like(const FilterSpec& filter) const {
  std::vector<SettableMember> members;
  std::vector<double> lengths(filter.lengths.begin(), filter.lengths.end());
  if (filter.kind == Shape::boxcar || filter.kind == Shape::trapezoid)
    lengths = {filter.order - filter.ramp + 1.0, filter.ramp + 1.0};
  for (const SettingFamily family : families()) {
    const bool of_averages = family == SettingFamily::averages || family == SettingFamily::shaper;
    if (of_averages && !lengths.empty()) add(family, lengths, filter.pair_delay, members);
  }
  return members;
}

std::optional<SettableMember> SettableMembers::same(const FilterSpec& filter) const {
  const Filter own = make_filter(filter);
  const auto is = [&](const SettableMember& member) {
    return member.order() == own.order() && same_taps(make_filter(member.spec), own);
  };
  for (const std::vector<SettableMember>& members : {like(filter), all_}) {
    if (const auto at = std::ranges::find_if(members, is); at != members.end()) return *at;
  }
  return std::nullopt;
}

std::vector<SettableMember> SettableMembers::at_feed(double velocity, double acceleration, double jerk) const {
  FilterSpec ramps{.kind = Shape::averages};
  const double longest = task_.design.order_max + 1.0;
  for (const double time : {velocity / acceleration, jerk < unlimited ? acceleration / jerk : 0.0})
    ramps.lengths.push_back(static_cast<int>(std::clamp(std::ceil(time / task_.sample_period), 1.0, longest)));
  std::vector<SettableMember> members = like(ramps);
  if (!members.empty()) return members;
  // Other families are about as long.
  const int order = ramps.lengths[0] + ramps.lengths[1] - 2;
  for (const SettableMember& member : spread()) {
    if (member.order() >= order) return {member};
  }
  return {};
}

int SettableMembers::coarse_step(const SettableMember& member) const {
  constexpr int least = 4;  // shorter steps end at neighbours that differ by little
  return std::max(least, *std::max_element(member.lengths.begin(), member.lengths.end()) / 8);
}

std::vector<SettableMember> SettableMembers::around(const SettableMember& member, int step) const {
  std::vector<SettableMember> members;
  const std::vector<double> lengths(member.lengths.begin(), member.lengths.end());
  const auto moved = [&](std::size_t s, int by) {
    // To another option, however far it is.
    const std::vector<int> all = options(member.family, s);
    const int now = member.lengths[s], to = nearest(all, now + by);
    if (to != now) return static_cast<double>(to);
    const auto at = std::find(all.begin(), all.end(), now);
    if (by > 0) return static_cast<double>(at + 1 == all.end() ? now : *(at + 1));
    return static_cast<double>(at == all.begin() ? now : *(at - 1));
  };
  for (std::size_t s = 0; s < lengths.size(); ++s) {
    for (const int by : {-step, step}) {
      std::vector<double> one = lengths;
      one[s] = moved(s, by);
      add(member.family, one, member.spec.pair_delay, members);
      for (std::size_t other = 0; other < lengths.size(); ++other) {
        if (other == s) continue;
        std::vector<double> two = one;
        two[other] = moved(other, -by);
        add(member.family, two, member.spec.pair_delay, members);
      }
      if (member.spec.pairs > 0) add(member.family, lengths, moved_delay(member.spec.pair_delay, by), members);
    }
  }
  return members;
}

void SettableMembers::sort_near(const SettableMember& member) {
  const auto distance = [&](const SettableMember& other) {
    double sum = member.family == other.family ? std::abs(member.spec.pair_delay - other.spec.pair_delay) : 1e6;
    for (std::size_t s = 0; s < std::min(member.lengths.size(), other.lengths.size()); ++s)
      sum += std::abs(member.lengths[s] - other.lengths[s]);
    return sum;
  };
  std::stable_sort(all_.begin(), all_.end(),
                   [&](const SettableMember& a, const SettableMember& b) { return distance(a) < distance(b); });
}

const ShaperInfo* SettableMembers::shaper_behind(SettingFamily family) const {
  return family == SettingFamily::shaper ? task_.settings->shaper : nullptr;
}

double SettableMembers::moved_delay(double delay, int by) const {
  const double to = nearest(delays_, delay + by);
  if (to != delay) return to;
  const auto at = std::find(delays_.begin(), delays_.end(), delay);
  if (by > 0) return at + 1 < delays_.end() ? *(at + 1) : delay;
  return at == delays_.begin() ? delay : *(at - 1);
}

void SettableMembers::list_grid(SettingFamily family) {
  for (const int length : averages_.front()) {
    const int last = length > 1 ? largest_multiple(task_, family, length - 1) : 1;
    for (int multiple = 1; multiple <= last; ++multiple) {
      if (static_cast<long>(all_.size()) >= most) return static_cast<void>(listed_ = false);
      add_grid(family, length, multiple, all_);
    }
  }
}

void SettableMembers::list_poles() {
  for (const Poles& poles : all_poles(poles_, task_.design.order_max)) {
    if (static_cast<long>(all_.size()) >= most) return static_cast<void>(listed_ = false);
    add(SettingFamily::one_pole, {poles.constants.begin(), poles.constants.end()}, 0.0, all_);
  }
}

void SettableMembers::list(SettingFamily family) {
  if (find_grid_family(family) != nullptr) return list_grid(family);
  if (family == SettingFamily::one_pole) return list_poles();
  const ShaperInfo* shaper = shaper_behind(family);
  std::vector<int> lengths;
  const std::function<void(int, double)> stage = [&](int left, double delay) {
    const std::size_t s = lengths.size();
    if (!listed_) return;
    if (s == stages(family)) {
      if (static_cast<long>(all_.size()) >= most) return static_cast<void>(listed_ = false);
      add(family, {lengths.begin(), lengths.end()}, delay, all_);
      return;
    }
    for (const int length : options(family, s)) {
      if (length - 1 > left) break;
      if (s > 0 && averages_[s] == averages_[s - 1] && length > lengths[s - 1]) break;
      lengths.push_back(length);
      stage(left - (length - 1), delay);
      lengths.pop_back();
    }
  };
  if (shaper == nullptr) return stage(task_.design.order_max, 0.0);
  for (const double delay : delays_)
    stage(task_.design.order_max - FilterSpec{.pairs = shaper->pairs, .pair_delay = delay}.full_order(), delay);
}

ChosenSettings SettableMembers::chosen(const SettableMember& member) const {
  std::vector<int> lengths = member.lengths;
  int multiple = 0;
  if (find_grid_family(member.family) != nullptr) {
    // The second number is a multiple. If the filter is off, each multiple is as good as another.
    if (lengths.front() > 1) multiple = lengths[1];
    lengths.resize(1);
  }
  if (member.family != SettingFamily::one_pole) std::replace(lengths.begin(), lengths.end(), 1, 0);
  return chosen_settings(task_, member.family, member.spec, lengths, multiple);
}

}  // namespace accdec
