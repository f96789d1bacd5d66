#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <accdec/files/parse_toml.hpp>
#include <accdec/files/suggestion.hpp>
#include <accdec/files/text_file.hpp>
#include <accdec/files/toml_table.hpp>
#include <accdec/formats/controller_file.hpp>
#include <accdec/formats/controller_texts.hpp>
#include <accdec/formats/settings_table.hpp>

namespace accdec {
namespace {

using toml_input::Table;

Key text_of(std::string name, std::string meaning, std::string example, bool required = false) {
  return {.name = std::move(name),
          .type = KeyType::text,
          .meaning = std::move(meaning),
          .example = std::move(example),
          .required = required,
          .long_text = true};
}

/// A key of tasks, with another meaning here.
Key as_in_tasks(std::vector<Key> keys, std::string_view name, std::string meaning, std::string fallback) {
  Key key = *find_key(keys, name);
  key.meaning = std::move(meaning), key.fallback = std::move(fallback);
  return key;
}

Key time(std::string name, std::string meaning, std::string fallback, std::string example) {
  return {.name = std::move(name),
          .meaning = std::move(meaning),
          .unit = "ms",
          .range = {0.0, 1e6, true},
          .fallback = std::move(fallback),
          .example = std::move(example)};
}

std::vector<Key> stage_keys() {
  Key set = as_in_tasks(setting_keys(), "length_set_ms", "instead of step and cap: all times that can be set", "");
  return {
      text_of("parameter", "as the control prints it", "\"MD32410\"", true),
      {.name = "unit",
       .type = KeyType::text,
       .meaning = "unit in which it is entered, as the control prints it",
       .fallback = "ms",
       .example = "\"s\""},
      {.name = "unit_ms", .meaning = "ms in one unit", .range = {0.0, 1e6, true}, .fallback = "1", .example = "1000"},
      time("length_step_ms", "step of the time", "one sample", "0.1"),
      time("length_max_ms", "longest time", "no cap", "1000"),
      {.name = "length_max_samples",
       .type = KeyType::integer,
       .meaning = "longest time in cycles of the control",
       .unit = "samples",
       .range = {1, 1e6},
       .fallback = "no cap",
       .example = "200"},
      std::move(set)};
}

std::vector<Key> dialect_keys() {
  return {text_of("metric", "for lengths in mm and feeds in mm/min", "\"G710\""),
          text_of("dwell", "before the seconds of a dwell, in a block of its own", "\"G4 F\""),
          text_of("comment", "before a remark", "\";\"", true),
          {.name = "comment_end",
           .type = KeyType::text,
           .meaning = "behind a remark",
           .fallback = "the line's end",
           .example = "\")\""}};
}

FileKind make_controller_file() {
  FileKind file{.name = "controller", .title = "accdec controller"};
  Key families = as_in_tasks(setting_keys(), "family", "families that it has", "");
  families.required = true;
  file.keys = {
      text_of("title", "maker, control, kind of filter", "\"Siemens SINUMERIK 840D sl\"", true),
      text_of("note", "what else to set", "\"Set MD32402 = 4.\""),
      std::move(families),
      as_in_tasks(setting_keys(), "shaper", "with family = \"shaper\": impulses behind the averages", "zv"),
      *find_key(setting_keys(), "time_constant_step_ms"),
      *find_key(setting_keys(), "alpha_step"),
      *find_key(setting_keys(), "cutoff_step_Hz"),
      *find_key(setting_keys(), "shaper_frequency_step_Hz"),
      as_in_tasks(controller_keys(), "delays", "how it delays the second leg of a corner", "not known"),
      *find_key(controller_keys(), "delay_words"),
      *find_key(controller_keys(), "in_position_of"),
      *find_key(controller_keys(), "in_position_by"),
      *find_key(controller_keys(), "in_position_latency_ms"),
      *find_key(controller_keys(), "corner_feed_step"),
      {.name = "unknown",
       .type = KeyType::texts,
       .meaning = "what could not be found; nothing is printed as a fact without a source",
       .example = "[\"largest time\"]",
       .long_text = true},
      as_in_tasks(controller_keys(), "assumed", "what no source says and answers rely on; they name it", ""),
      {.name = "stage",
       .type = KeyType::tables,
       .meaning = "a time that it takes, in the order of the filter; 1 to 3",
       .keys = stage_keys()},
      {.name = "dialect",
       .type = KeyType::table,
       .meaning = "how its programs are written, beside `delay_words`",
       .keys = dialect_keys()},
      {.name = "source",
       .type = KeyType::tables,
       .meaning = "where a fact stands; at least one",
       .keys = {text_of("fact", "what stands there", "\"both times of type 4\"", true),
                text_of("where", "manual, edition and page, or address", "\"Function Manual, page 377\"", true)}}};
  return file;
}

ControllerStage read_stage(const Table& table) {
  ControllerStage stage{};
  stage.time.name = *table.text("parameter");
  stage.time.unit = table.text("unit").value_or("ms");
  require_unit_of_time(table, "unit", stage.time.unit);
  stage.time.unit_seconds = 1e-3 * table.required_number("unit_ms");
  stage.time.length_step = table.number("length_step_ms").value_or(0.0);
  stage.time.length_max = table.number("length_max_ms").value_or(0.0);
  stage.length_max_samples = table.integer("length_max_samples").value_or(0);
  stage.time.length_set = table.numbers("length_set_ms");
  std::sort(stage.time.length_set.begin(), stage.time.length_set.end());
  if (std::erase(stage.time.length_set, 0.0) > 0 && stage.time.length_set.empty())
    table.fail_at("length_set_ms", "`length_set_ms` = 0 leaves the filter off; leave out this [[stage]]");
  for (const std::string_view key : {"length_step_ms", "length_max_ms", "length_max_samples"}) {
    if (table.has(key) && !stage.time.length_set.empty())
      table.fail_at(key, fmt::format("`{}` and `length_set_ms` are both given; allowed is either the set of all times, "
                                     "or a step and a cap",
                                     key));
  }
  if (stage.time.length_max > 0.0 && stage.time.length_max < stage.time.length_step)
    table.fail_at("length_max_ms", "`length_max_ms` is below `length_step_ms`, which leaves no time");
  return stage;
}

/// The words of its programs.
void read_words(const Table& top, Controller& controller) {
  controller.delay_words = top.texts("delay_words");
  if (top.has("delay_words") && controller.delay_words.size() != controller.delays.size())
    top.fail_at("delay_words", fmt::format("`delay_words` has {}, and `delays` has {}; one a kind is needed",
                                           controller.delay_words.size(), controller.delays.size()));
  const auto dialect = top.table("dialect");
  if (!dialect) return;
  if (controller.delay_words.empty())
    top.fail_at("dialect", "[dialect] goes with `delay_words`, without which no corner can be written");
  controller.dialect = std::make_shared<const ControlDialect>(
      ControlDialect{dialect->text("metric").value_or(""), dialect->text("dwell").value_or(""),
                     *dialect->text("comment"), dialect->text("comment_end").value_or("")});
}

Controller read_controller(const Table& top, std::string name) {
  Controller controller;
  controller.name = std::move(name);
  controller.title = *top.text("title");
  controller.note = top.text("note").value_or("");
  for (const std::string& word : texts_once(top, "family"))
    controller.families.push_back(*setting_family_from_string(word));
  for (const std::string& word : texts_once(top, "delays")) controller.delays.push_back(*delay_kind_from_string(word));
  read_words(top, controller);
  controller.in_position_actual = top.has("in_position_of") && top.word("in_position_of") == "actual";
  controller.in_position_by_axis = top.has("in_position_by") && top.word("in_position_by") == "axis";
  controller.in_position_latency = top.number("in_position_latency_ms").value_or(0.0);
  controller.corner_feed_step = top.number("corner_feed_step").value_or(controller.corner_feed_step);
  controller.unknown = top.texts("unknown");
  controller.assumed = top.texts("assumed");
  controller.time_constant_step = top.number("time_constant_step_ms").value_or(0.0);
  controller.alpha_step = top.number("alpha_step").value_or(0.0);
  controller.cutoff_step = top.number("cutoff_step_Hz").value_or(0.0);
  controller.shaper_frequency_step = top.number("shaper_frequency_step_Hz").value_or(0.0);
  for (const Table& stage : top.tables("stage")) controller.stages.push_back(read_stage(stage));
  for (const Table& source : top.tables("source"))
    controller.sources.push_back({*source.text("fact"), *source.text("where")});
  const auto& families = controller.families;
  if (std::find(families.begin(), families.end(), SettingFamily::shaper) != families.end())
    controller.shaper = find_shaper(top.word("shaper"));
  const bool times = ControllerSettings{.families = families}.names_family();
  if (times && (controller.stages.empty() || controller.stages.size() > 3))
    top.fail(fmt::format("{} [[stage]] tables; this family needs 1 to 3", controller.stages.size()));
  std::vector<SettingFamily> timed = families;
  std::erase(timed, SettingFamily::taps);
  if (times && controller.stages.size() > 1 && all_on_grids(timed))
    top.tables("stage")[1].fail(
        fmt::format("a second [[stage]], but family = \"{}\" is one filter with one length; "
                    "allowed is one [[stage]]",
                    to_string(timed.front())));
  if (!times && !controller.stages.empty()) top.fail("free taps have no [[stage]]; leave it out");
  if (controller.sources.empty()) top.fail("no [[source]]; nothing counts as a fact without one");
  return controller;
}

/// Whole samples in a time; none if it is no multiple of the period.
std::optional<double> samples_in(double time, double period) {
  const double samples = time / period, whole = std::round(samples);
  if (!(whole >= 1.0) || std::abs(samples - whole) > 1e-9 * std::max(1.0, whole)) return std::nullopt;
  return whole;
}

/// A stage's times that are whole samples.
SettableStage sampled(const ControllerStage& given, double period) {
  SettableStage stage = given.time;
  const auto refuse = [&] {
    throw std::invalid_argument(
        fmt::format("no time of {} is a multiple of the sample period, {:.6g} ms", stage.name, 1e3 * period));
  };
  if (!stage.length_set.empty()) {
    std::erase_if(stage.length_set, [&](double time) { return !samples_in(time, period); });
    if (stage.length_set.empty()) refuse();
    return stage;
  }
  if (stage.length_step > 0.0) {
    constexpr int most = 1000;
    int steps = 1;
    while (steps <= most && !samples_in(steps * stage.length_step, period)) ++steps;
    if (steps > most) refuse();
    stage.length_step = *samples_in(steps * stage.length_step, period) * period;
  }
  if (given.length_max_samples > 0) {
    const double cap = given.length_max_samples * period;
    stage.length_max = stage.length_max > 0.0 ? std::min(stage.length_max, cap) : cap;
  }
  const double least = stage.length_step > 0.0 ? stage.length_step : period;
  if (stage.length_max > 0.0 && stage.length_max < least * (1.0 - 1e-9)) refuse();
  return stage;
}

/// The message at the first of these keys that the task file has.
InputError error_at_first(const std::vector<std::pair<const char*, const char*>>& keys, const std::string& task,
                          const std::string& message) {
  const toml::table tree = toml_input::parse_toml(read_text_file(task), task);
  for (const auto& [table, key] : keys) {
    const auto found = tree[table][key];
    if (found.node() == nullptr) continue;
    const toml::source_position at = found.node()->source().begin;
    return {task, static_cast<long>(at.line), static_cast<long>(at.column), message};
  }
  return {task, 0, 0, message};
}

}  // namespace

const FileKind& controller_file() {
  static const FileKind file = make_controller_file();
  return file;
}

Controller parse_controller(std::string_view text, const std::string& path) {
  const std::vector<Key>& keys = controller_file().keys;
  const toml::table tree = toml_input::parse_toml(text, path);
  toml_input::check_keys(tree, path, "the controller (top level)", "", keys).raise();
  return read_controller(Table(tree, path, "the controller (top level)", "", keys),
                         std::filesystem::path(path).stem().string());
}

std::span<const Controller> controllers() {
  static const std::vector<Controller> all = [] {
    std::vector<Controller> read;
    for (const ControllerText& file : controller_texts())
      read.push_back(parse_controller(file.text, std::string(file.name) + ".toml"));
    return read;
  }();
  return all;
}

Controller find_controller(const std::string& name_or_path) {
  if (name_or_path.ends_with(".toml")) return parse_controller(read_text_file(name_or_path), name_or_path);
  std::vector<std::string> names;
  for (const Controller& controller : controllers()) {
    if (controller.name == name_or_path) return controller;
    names.push_back(controller.name);
  }
  throw std::invalid_argument(unknown_name("controller", name_or_path, names) +
                              "; a file of your own is named by its path, which ends in .toml");
}

ControllerSettings settings_of(const Controller& controller, double period) {
  const double step = controller.shaper_frequency_step, least = 0.5 / period / most_numbers;
  if (step > 0.0 && step < least)
    throw std::invalid_argument(
        fmt::format("its step of {:.6g} Hz gives more than {:.0f} frequencies at a sample "
                    "period of {:.6g} ms; the least is {:.6g} Hz",
                    step, most_numbers, 1e3 * period, least));
  ControllerSettings settings;
  settings.families = controller.families;
  settings.shaper = controller.shaper;
  if (controller.time_constant_step > 0.0) settings.time_constant_step = controller.time_constant_step;
  if (controller.alpha_step > 0.0) settings.alpha_step = controller.alpha_step;
  if (controller.cutoff_step > 0.0) settings.cutoff_step = controller.cutoff_step;
  settings.shaper_frequency_step = controller.shaper_frequency_step;
  settings.delays = controller.delays, settings.delay_words = controller.delay_words;
  settings.dialect = controller.dialect, settings.from_file = true;
  settings.assumed = controller.assumed;
  settings.corner_feed_step = controller.corner_feed_step;
  settings.in_position_actual = controller.in_position_actual;
  settings.in_position_by_axis = controller.in_position_by_axis;
  settings.in_position_latency = std::round(controller.in_position_latency / period) * period;
  for (const ControllerStage& stage : controller.stages) settings.stages.push_back(sampled(stage, period));
  return settings;
}

InputError error_at_delays(const std::string& task, const std::string& message) {
  return error_at_first({{"controller", "delays"}, {"controller", "name"}, {"controller", "file"}}, task, message);
}

InputError error_at_controller(const std::string& task, const std::string& message) {
  return error_at_first({{"controller", "name"}, {"controller", "file"}}, task, message);
}

InputError error_at_family(const std::string& task, const std::string& message) {
  return error_at_first({{"design", "family"}, {"controller", "name"}, {"controller", "file"}}, task, message);
}

}  // namespace accdec
