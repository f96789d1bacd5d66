#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/formats/beyond_controller.hpp>
#include <accdec/formats/controller_file.hpp>
#include <accdec/formats/settings_table.hpp>

namespace accdec {
namespace {

using toml_input::Table;

/// Times as multiples of the sample period, s. @throws InputError at the first that is none
std::vector<double> whole_samples(const Table& table, std::string_view key, double period) {
  std::vector<double> times = table.numbers(key);
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double samples = times[i] / period;
    if (std::abs(samples - std::round(samples)) <= 1e-9 * std::max(1.0, samples)) continue;
    table.fail_at(key, i,
                  fmt::format("`{}` = {:.6g} ms is no multiple of the sample period, {:.6g} ms; allowed are {:.6g}, "
                              "{:.6g} ms, ..",
                              key, 1e3 * times[i], 1e3 * period, 1e3 * period * std::max(1.0, std::floor(samples)),
                              1e3 * period * std::max(2.0, std::floor(samples) + 1.0)));
  }
  return times;
}

/// One number for all stages, or one each.
void spread(const Table& table, std::string_view key, std::vector<double> times, std::vector<SettableStage>& stages,
            double SettableStage::*member) {
  if (times.empty()) return;
  if (times.size() != 1 && times.size() != stages.size())
    table.fail_at(key, fmt::format("`{}` has {} numbers for {} stage{}; allowed is one number, or one a stage", key,
                                   times.size(), stages.size(), stages.size() == 1 ? "" : "s"));
  for (std::size_t i = 0; i < stages.size(); ++i) stages[i].*member = times[times.size() == 1 ? 0 : i];
}

/// Sets of times in place of steps and caps: of all stages, and of those that differ.
void read_sets(const Table& table, double period, std::vector<SettableStage>& stages) {
  const auto own_key = [&](std::size_t stage) {
    const std::string key = fmt::format("length_set_{}_ms", stage + 1);
    return stage > 0 && table.has(key) ? key : "";
  };
  for (const std::size_t stage : {1, 2}) {
    const std::string key = own_key(stage);
    if (!key.empty() && stage >= stages.size())
      table.fail_at(key, fmt::format("`{}` is of stage {}; there {} {}", key, stage + 1,
                                     stages.size() == 1 ? "is" : "are", stages.size()));
    for (const std::string_view other : {"length_step_ms", "length_max_ms"}) {
      if (!key.empty() && table.has(other) && table.numbers(other).size() > 1)
        table.fail_at(other,
                      fmt::format("`{}` has a number for stage {}, whose times are those of `{}`; allowed is one "
                                  "number, for the other stages",
                                  other, stage + 1, key));
    }
  }
  const bool all = table.has("length_set_ms");
  for (const std::string_view key : {"length_step_ms", "length_max_ms"}) {
    if (all && table.has(key))
      table.fail_at(key, fmt::format("`{}` and `length_set_ms` are both given; allowed is either the set of all "
                                     "lengths, or a step and a cap",
                                     key));
  }
  for (std::size_t i = 0; i < stages.size(); ++i) {
    const std::string own = own_key(i);
    if (!all && own.empty()) continue;
    const std::string key = own.empty() ? "length_set_ms" : own;
    std::vector<double> set = whole_samples(table, key, period);
    std::sort(set.begin(), set.end());
    set.erase(std::unique(set.begin(), set.end()), set.end());
    std::erase(set, 0.0);
    if (set.empty())
      table.fail_at(key,
                    fmt::format("`{}` = 0 turns stage {} off; allowed is a smaller number of `stages`", key, i + 1));
    stages[i].length_set = std::move(set), stages[i].length_step = stages[i].length_max = 0.0;
  }
}

void read_stages(const Table& table, double period, ControllerSettings& settings) {
  const std::size_t known = settings.stages.size();
  auto asked = static_cast<std::size_t>(table.required_integer("stages"));
  if (all_on_grids(settings.families)) {
    if (table.has("stages") && asked > 1)
      table.fail_at("stages", fmt::format("`stages` = {}, but family = \"{}\" is one filter with one length; allowed "
                                          "is 1",
                                          asked, to_string(settings.families.front())));
    asked = 1;
  }
  if (known > 0 && table.has("stages") && asked > known)
    table.fail_at("stages", fmt::format("`stages` = {}, but the controller has {}", asked, known));
  if (known == 0 || table.has("stages")) settings.stages.resize(asked);
  for (SettableStage& stage : settings.stages) {
    if (stage.length_set.empty() || table.has("length_set_ms")) continue;
    for (const std::string_view key : {"length_step_ms", "length_max_ms"}) {
      if (table.has(key))
        table.fail_at(key, fmt::format("`{}` does not go with the controller's set of times; allowed is "
                                       "`length_set_ms`",
                                       key));
    }
  }
  spread(table, "length_step_ms", whole_samples(table, "length_step_ms", period), settings.stages,
         &SettableStage::length_step);
  spread(table, "length_max_ms", table.numbers("length_max_ms"), settings.stages, &SettableStage::length_max);
  for (std::size_t i = 0; i < settings.stages.size(); ++i) {
    const SettableStage& stage = settings.stages[i];
    const double least = stage.length_step > 0.0 ? stage.length_step : period;
    if (stage.length_max > 0.0 && stage.length_max < least * (1.0 - 1e-9))
      table.fail_at("length_max_ms",
                    fmt::format("`length_max_ms` = {:.6g} leaves stage {} no length; the shortest is {:.6g} ms",
                                1e3 * stage.length_max, i + 1, 1e3 * least));
  }
  read_sets(table, period, settings.stages);
}

void read_grid(const Table& table, double period, ControllerSettings& settings) {
  for (const GridStep& grid : grid_steps) {
    if (!table.has(grid.key)) continue;
    if (std::find(settings.families.begin(), settings.families.end(), grid.family) == settings.families.end())
      table.fail_at(grid.key, fmt::format("`{}` is of no use here; it goes with family = \"{}\"", grid.key,
                                          to_string(grid.family)));
    settings.*grid.step = *table.number(grid.key);
  }
  const double tau = settings.time_constant_step, nyquist = 0.5 / period;
  if (tau > 0.0 && tau < 0.1 * period)
    table.fail_at("time_constant_step_ms",
                  fmt::format("`time_constant_step_ms` = {:.6g} is below a tenth of the sample period; the least is "
                              "{:.6g}",
                              1e3 * tau, 100.0 * period));
  for (const char* key : {"cutoff_step_Hz", "shaper_frequency_step_Hz"}) {
    if (const auto step = table.number(key); step && *step < nyquist / most_numbers)
      table.fail_at(key, fmt::format("`{}` = {:.6g} gives more than {:.0f} frequencies up to {:.6g} Hz; the least is "
                                     "{:.6g}",
                                     key, *step, most_numbers, nyquist, nyquist / most_numbers));
  }
  // At the highest frequency the impulses are a sample apart.
  if (settings.shaper == nullptr) return;
  const double highest = settings.shaper->delay_periods / period;
  if (settings.shaper_frequency_step > highest)
    table.fail_at(
        "shaper_frequency_step_Hz",
        fmt::format("`shaper_frequency_step_Hz` = {:.6g} is above the highest frequency of {}, {:.6g} Hz, whose "
                    "impulses are a sample apart",
                    settings.shaper_frequency_step, settings.shaper->title, highest));
}

void read_families(const Table& table, double period, ControllerSettings& settings) {
  settings.families.clear();
  for (const std::string& word : texts_once(table, "family"))
    settings.families.push_back(*setting_family_from_string(word));
  const auto has = [&](SettingFamily family) {
    return std::find(settings.families.begin(), settings.families.end(), family) != settings.families.end();
  };
  const bool shaper = has(SettingFamily::shaper);
  if (shaper) settings.shaper = find_shaper(table.word("shaper"));
  if (!shaper && table.has("shaper"))
    table.fail_at("shaper", "`shaper` is of no use here; it goes with family = \"shaper\"");
  for (const SettingFamily falling : {SettingFamily::one_pole, SettingFamily::exponential}) {
    if (has(falling) && table.boolean("symmetric"))
      table.fail_at("symmetric", fmt::format("`symmetric` = true leaves nothing of family = \"{}\", whose taps fall",
                                             to_string(falling)));
  }
  if (table.has("shaper_frequency_step_Hz") && table.boolean("symmetric"))
    table.fail_at("symmetric",
                  "`symmetric` = true excludes impulses between samples; leave out either it or "
                  "`shaper_frequency_step_Hz`");
  read_grid(table, period, settings);
  if (settings.names_family()) return read_stages(table, period, settings);
  for (const std::string_view key :
       {"stages", "length_step_ms", "length_max_ms", "length_set_ms", "length_set_2_ms", "length_set_3_ms"}) {
    if (table.has(key))
      table.fail_at(key, fmt::format("`{}` is of no use with free taps; it goes with family = \"averages\"", key));
  }
}

/// The settings of the controller that the table names; none without a name.
/// @param files  whether it may name a file
std::optional<ControllerSettings> named_controller(const Table& table, double period, bool files) {
  if (!table.has("name") && !table.has("file")) return std::nullopt;
  if (table.has("name") && table.has("file"))
    table.fail_at("file", "`name` and `file` are both given; allowed is either");
  const std::string_view key = table.has("name") ? "name" : "file";
  std::string name = *table.text(key);
  if (key == "file" && !name.ends_with(".toml"))
    table.fail_at(key, "`file` must end in .toml; `name` names a built-in controller");
  if (!files && name.ends_with(".toml"))
    table.fail_at(key, fmt::format("`{}` names a file, and none is opened here; allowed is a built-in controller's "
                                   "`name`",
                                   key));
  // A file lies beside the task that names it.
  if (name.ends_with(".toml")) name = (std::filesystem::path(table.file()).parent_path() / name).string();
  if (name.ends_with(".toml") && !std::filesystem::exists(name))
    table.fail_at(
        key, fmt::format("`{}`: {} does not exist; a controller's file lies beside the task that names it", key, name));
  try {
    const Controller controller = find_controller(name);
    ControllerSettings settings = settings_of(controller, period);
    settings.controller = controller.title;
    return settings;
  } catch (const std::invalid_argument& why) {
    table.fail_at(key, why.what());
  }
}

/// Parts of the feed at which the control passes corners.
void read_corner_feed(const Table& table, ControllerSettings& settings) {
  constexpr std::string_view key = "corner_feed_step";
  if (!table.has(key)) return;
  if (!settings.names(DelayKind::corner_feed))
    table.fail_at(key, fmt::format("`{}` goes with delays = [\"corner-feed\"]", key));
  settings.corner_feed_step = *table.number(key);
}

/// The kinds of delays, with the words for them: the task's, or those that the control has for the kinds that are left.
void read_delays(const Table& table, ControllerSettings& settings) {
  if (table.has("delays")) {
    const ControllerSettings had = settings;
    settings.delays.clear(), settings.delay_words.clear();
    for (const std::string& word : texts_once(table, "delays")) {
      settings.delays.push_back(*delay_kind_from_string(word));
      if (!had.delay_words.empty()) settings.delay_words.emplace_back(had.word_of(settings.delays.back()));
    }
  }
  constexpr std::string_view key = "delay_words";
  if (!table.has(key)) return;
  settings.delay_words = table.texts(key);
  if (settings.delay_words.size() != settings.delays.size())
    table.fail_at(key, fmt::format("`{}` has {}, and `delays` has {}; one a kind is needed", key,
                                   settings.delay_words.size(), settings.delays.size()));
}

/// How the control measures that it is in-position.
void read_in_position(const Table& table, double period, ControllerSettings& settings) {
  const bool there = settings.names(DelayKind::in_position);
  for (const std::string_view key : {"in_position_of", "in_position_by", "in_position_latency_ms"}) {
    if (table.has(key) && !there) table.fail_at(key, fmt::format("`{}` goes with delays = [\"in-position\"]", key));
  }
  if (table.has("in_position_of")) settings.in_position_actual = table.word("in_position_of") == "actual";
  if (table.has("in_position_by")) settings.in_position_by_axis = table.word("in_position_by") == "axis";
  if (const auto latency = table.number("in_position_latency_ms")) {
    settings.in_position_latency = *latency;
    const double samples = *latency / period;
    if (std::abs(samples - std::round(samples)) > 1e-9 * std::max(1.0, samples))
      table.fail_at("in_position_latency_ms",
                    fmt::format("`in_position_latency_ms` = {:.12g} ms is no multiple of the sample period, {:.12g} ms",
                                1e3 * *latency, 1e3 * period));
  }
}

/// Names and units of the times, and the controller's title.
void read_parameters(const Table& table, ControllerSettings& settings) {
  if (const auto title = table.text("title")) settings.controller = *title;
  if (table.has("assumed")) settings.assumed = table.texts("assumed");
  const auto right_size = [&](std::string_view key, std::size_t size) {
    if (size == settings.stages.size()) return;
    table.fail_at(key, fmt::format("`{}` has {} elements for {} stages; one a stage is needed", key, size,
                                   settings.stages.size()));
  };
  if (!table.has("parameters")) {
    for (const std::string_view key : {"parameter_units", "parameter_unit_ms"}) {
      if (table.has(key)) table.fail_at(key, fmt::format("`{}` goes with `parameters`", key));
    }
    return;
  }
  const std::vector<std::string> names = table.texts("parameters"), units = table.texts("parameter_units");
  const std::vector<double> factors = table.numbers("parameter_unit_ms");
  right_size("parameters", names.size());
  if (table.has("parameter_units")) right_size("parameter_units", units.size());
  if (table.has("parameter_unit_ms")) right_size("parameter_unit_ms", factors.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    settings.stages[i].name = names[i];
    if (!units.empty()) {
      require_unit_of_time(table, "parameter_units", units[i]);
      settings.stages[i].unit = units[i];
    }
    if (!factors.empty()) settings.stages[i].unit_seconds = 1e-3 * factors[i];
  }
}

/// The family that a key of [design] is of; the first of several.
SettingFamily family_of_key(std::string_view key) {
  if (key == "shaper") return SettingFamily::shaper;
  const auto* grid =
      std::find_if(std::begin(grid_steps), std::end(grid_steps), [=](const GridStep& step) { return step.key == key; });
  return grid == std::end(grid_steps) ? SettingFamily::averages : grid->family;
}

}  // namespace

void require_unit_of_time(const Table& table, std::string_view key, const std::string& unit) {
  for (const std::string_view frequency : {"Hz", "hz", "HZ", "kHz", "rad/s", "1/s"}) {
    if (unit != frequency) continue;
    table.fail_at(key,
                  fmt::format("`{}` = \"{}\" is a unit of frequencies; allowed are those of times, such as s, ms or "
                              "cycles: what is entered is the time over `unit_ms`",
                              key, unit));
  }
}

bool all_on_grids(const std::vector<SettingFamily>& families) {
  return std::all_of(families.begin(), families.end(), [](SettingFamily family) {
    return family == SettingFamily::exponential || family == SettingFamily::gaussian ||
           family == SettingFamily::windowed_sinc;
  });
}

std::vector<std::string> texts_once(const Table& table, std::string_view key) {
  std::vector<std::string> words = table.texts(key);
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (std::find(words.begin(), words.begin() + static_cast<std::ptrdiff_t>(i), words[i]) !=
        words.begin() + static_cast<std::ptrdiff_t>(i))
      table.fail_at(key, i, fmt::format("`{}` names \"{}\" twice; allowed is once", key, words[i]));
  }
  return words;
}

std::optional<ControllerSettings> read_settings(const std::optional<Table>& design,
                                                const std::optional<Table>& controller, double period, bool files) {
  const auto named = controller ? named_controller(*controller, period, files) : std::nullopt;
  const bool family = design && design->has("family"), times = named && named->names_family();
  if (design && !family && !times) {
    for (const Key& key : setting_keys()) {
      if (design->has(key.name))
        design->fail_at(key.name, fmt::format("`{}` goes with `family`; allowed is family = \"{}\"", key.name,
                                              to_string(family_of_key(key.name))));
    }
  }
  ControllerSettings settings = named.value_or(ControllerSettings{});
  if (family)
    read_families(*design, period, settings);
  else if (design && times)
    read_stages(*design, period, settings);
  if (controller) {
    read_delays(*controller, settings);
    read_in_position(*controller, period, settings);
    read_corner_feed(*controller, settings);
    read_parameters(*controller, settings);
  }
  if (named) refuse_beyond_controller(design, *controller, *named, settings);
  if (!settings.names_family() && settings.delays.empty()) return std::nullopt;
  return settings;
}

}  // namespace accdec
