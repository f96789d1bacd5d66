#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/formats/beyond_controller.hpp>
#include <accdec/formats/settings_table.hpp>

namespace accdec {
namespace {

using toml_input::Table;

template <class Enum>
std::string words_of(const std::vector<Enum>& list) {
  std::vector<std::string> words;
  for (const Enum one : list) words.emplace_back(to_string(one));
  return fmt::format("{}", fmt::join(words, ", "));
}

/// A controller of the user's own can have it.
constexpr const char* other_ways = "a controller's `file` of your own may have more";

bool is_multiple(double time, double step) {
  const double steps = time / step;
  return step <= 0.0 || (std::round(steps) >= 1.0 && std::abs(steps - std::round(steps)) <= 1e-9 * steps);
}

bool takes(const SettableStage& stage, double time) {
  const auto same = [=](double other) { return std::abs(time - other) <= 1e-9 * other; };
  if (!stage.length_set.empty()) return std::any_of(stage.length_set.begin(), stage.length_set.end(), same);
  return is_multiple(time, stage.length_step) && (stage.length_max <= 0.0 || time <= stage.length_max * (1.0 + 1e-9));
}

void refuse_times(const Table& design, const ControllerSettings& had, const ControllerSettings& asked) {
  for (std::size_t i = 0; i < asked.stages.size(); ++i) {
    const SettableStage &most = had.stages[i], &stage = asked.stages[i];
    const auto refuse = [&](std::string_view key, double time, const std::string& allowed) {
      design.fail_at(key, fmt::format("`{}` = {:.6g} ms is beyond {}, stage {}: allowed are {}; {}", key, 1e3 * time,
                                      had.controller, i + 1, allowed, other_ways));
    };
    if (most.length_max > 0.0 && stage.length_max > most.length_max * (1.0 + 1e-9))
      refuse("length_max_ms", stage.length_max, fmt::format("times up to {:.6g} ms", 1e3 * most.length_max));
    if (stage.length_step > 0.0 && !is_multiple(stage.length_step, most.length_step))
      refuse("length_step_ms", stage.length_step, fmt::format("multiples of {:.6g} ms", 1e3 * most.length_step));
    for (const double time : stage.length_set) {
      if (takes(most, time)) continue;
      const std::string own = fmt::format("length_set_{}_ms", i + 1);
      std::vector<double> set = most.length_set;
      for (double& one : set) one *= 1e3;
      refuse(design.has(own) ? own : "length_set_ms", time,
             set.empty() ? fmt::format("multiples of its step of {:.6g} ms up to its longest time, {:.6g} ms",
                                       1e3 * most.length_step, 1e3 * most.length_max)
                         : fmt::format("{:.6g} ms", fmt::join(set, ", ")));
    }
  }
}

}  // namespace

void refuse_beyond_controller(const std::optional<Table>& design, const Table& controller,
                              const ControllerSettings& had, const ControllerSettings& asked) {
  const auto has = [](const auto& list, auto one) { return std::find(list.begin(), list.end(), one) != list.end(); };
  if (design && had.names_family()) {
    for (const SettingFamily family : asked.families) {
      if (!has(had.families, family))
        design->fail_at("family", fmt::format("{} has no family \"{}\"; allowed are {}; {}", had.controller,
                                              to_string(family), words_of(had.families), other_ways));
    }
    refuse_times(*design, had, asked);
    const ControllerSettings unknown;
    for (const GridStep& grid : grid_steps) {
      // A step that its file does not give is not known.
      if (design->has(grid.key) && had.*grid.step != unknown.*grid.step &&
          !is_multiple(asked.*grid.step, had.*grid.step))
        design->fail_at(grid.key, fmt::format("`{}` is finer than that of {}; allowed are multiples of its own; {}",
                                              grid.key, had.controller, other_ways));
    }
  }
  if (had.delays.empty()) return;
  for (const DelayKind kind : asked.delays) {
    const bool slows = kind == DelayKind::corner_feed && had.names(DelayKind::continuous);
    if (!has(had.delays, kind) && !slows)
      controller.fail_at("delays", fmt::format("{} has no delay of the kind \"{}\"; allowed are {}{}; {}",
                                               had.controller, to_string(kind), words_of(had.delays),
                                               had.names(DelayKind::continuous) ? ", corner-feed" : "", other_ways));
  }
}

}  // namespace accdec
