#include "requests.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <accdec/design.hpp>
#include <accdec/design/design_settings.hpp>
#include <accdec/family.hpp>
#include <accdec/files.hpp>
#include <accdec/files/json_position.hpp>
#include <accdec/formats/design_report.hpp>
#include <accdec/formats/explanation.hpp>
#include <accdec/formats/task_json.hpp>
#include <accdec/formats/task_keys.hpp>
#include <accdec/formats/task_writer.hpp>
#include <accdec/result.hpp>
#include <accdec/study/baseline_table.hpp>
#include <accdec/task.hpp>
#include <accdec/task/settings_text.hpp>
#include <accdec/verify.hpp>

#include "held.hpp"
#include "machines.hpp"
#include "views.hpp"

namespace accdec::explore {
namespace {

using Json = nlohmann::ordered_json;

std::string dumped(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Answer problem(int status, std::string_view what) {
  return {status, "application/json", dumped({{"error", what}})};
}

Task task_of(const Question& question) {
  // Whoever may ask for designs must not have the program open files: a page sends the controller itself.
  Task task = parse_task_json(question.body, "task", {.response = Considered::all, .controller_files = false});
  require_small(task.corners.size());
  if (task.filter && make_filter(*task.filter).order() >= most_taps)
    throw std::invalid_argument(fmt::format(
        "the filter has more than {} taps, the most that the explorer computes with: accdec design takes any number",
        most_taps));
  return task;
}

DesignOptions options_of(const Question& question) {
  DesignOptions options;
  if (!question.whole) options.time_limit = question.seconds;
  options.cancel = question.cancel;
  options.exact.threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  return options;
}

Held& held_results() {
  static Held held;
  return held;
}

/// The result that a question is about. @throws std::invalid_argument  @throws InputError
Held::Result result_of(const Question& question) {
  if (question.held == 0) return std::make_shared<const DesignResult>(parse_result(question.body, "result"));
  if (Held::Result held = held_results().find(question.held)) return held;
  throw std::invalid_argument("the program holds this result no longer: change a number of the task and back");
}

/// The numbers to set at a control, in ms: averages, longest first, and the delay of pairs of impulses.
Json settings_json(const FilterSpec& spec, double period_ms) {
  FilterSpec shape = spec;
  shape.pairs = 0;
  Json averages = Json::array();
  for (const int length : moving_average_cascade(make_filter(shape))) averages.push_back(length * period_ms);
  Json settings{{"averages_ms", averages}, {"length_ms", (make_filter(spec).order() + 1) * period_ms}};
  if (spec.pairs > 0) settings["pair_delay_ms"] = spec.pair_delay * period_ms;
  if (spec.kind == Shape::blackman_sinc) settings["cutoff_Hz"] = 500.0 * spec.cutoff / period_ms;
  return settings;
}

/// A place for the motion at every corner. That of one is there, others are asked for when they are shown: all of them
/// may be a hundred megabytes.
Json views_json(const DesignResult& result, const Question& question, const Deadline& deadline) {
  constexpr int drawn_at_once = 2000;  // taps: 50 ms
  Json views(result.corners.size(), nullptr);
  const int order = result.filter ? result.filter->order() : longest_drawn;
  const bool now = order < drawn_at_once || (order < longest_drawn && !deadline.over());
  if (now && question.corner < views.size()) views[question.corner] = view_json(result, question.corner);
  return views;
}

Answer design(const Question& question) {
  const Deadline deadline(question.seconds);
  const Task task = task_of(question);
  DesignResult result =
      question.format == "given" ? design_given(task, options_of(question)) : design_task(task, options_of(question));
  Json proof{{"rechecked", false}, {"text", ""}};
  if (result.status == Status::optimal) {
    const ResultCheck check = verify_result(
        result, [&] { return deadline.over() || (question.cancel != nullptr && question.cancel->load()); });
    proof["rechecked"] = check.accepted;
    proof["text"] = check.accepted ? check.proof : check.reasons.front();
  }
  const ReportTable corners = corner_report(result);
  const std::size_t number = question.place.empty() ? 0 : held_results().keep(question.place, result);
  result.certificate.reset();  // thousands of numbers that the page would not read
  Json said{{"proof", proof},
            {"views", views_json(result, question, deadline)},
            {"setting", settings_answer(result)},
            {"exact_stop", result.filter && stops_exactly(result)},
            {"corners", {{"head", corners.head}, {"rows", corners.rows}}}};
  if (number > 0) said["held"] = number;
  if (const auto& given = result.task.filter) {
    said["parameters"] = describe_parameters(*given);
    said["settings"] = settings_json(*given, 1e3 * result.task.sample_period);
  }
  // The result as `design --json` writes it, digit by digit, but for what it saves: the page has today's filter apart.
  return {200, "application/json",
          fmt::format(R"({{"result": {}, {})", result_to_json(result), std::string_view(dumped(said)).substr(1))};
}

Json family_json(const Family& family, const FamilyResult& best) {
  Json json{{"name", family.name},
            {"title", family.title},
            {"status", to_string(best.result.status)},
            {"message", best.result.message}};
  if (!best.spec || !best.result.filter) return json;
  json["filter"] = task_to_json(best.result.task)["filter"];
  json["parameters"] = describe_parameters(*best.spec);
  json["settings"] = settings_json(*best.spec, 1e3 * best.result.task.sample_period);
  json["objective_s"] = best.result.objective();
  json["order"] = best.result.filter->order();
  json["delays_samples"] = Json::array();
  for (const CornerResult& corner : best.result.corners) json["delays_samples"].push_back(corner.delay);
  json["exact_stop"] = stops_exactly(best.result);
  return json;
}

Answer compare_families(const Question& question) {
  Task task = task_of(question);
  if (control_restricts(task))
    return {200, "application/json", dumped({{"families", Json::array()}, {"complete", true}})};
  task.filter.reset();
  const std::vector<FamilyResult> best = best_members(task, question.seconds, question.cancel);
  Json json{{"families", Json::array()}, {"complete", true}};
  for (std::size_t i = 0; i < best.size(); ++i) {
    if (families()[i].pairs > 0 && task.machine.modes.empty()) continue;  // nothing to cancel
    json["families"].push_back(family_json(families()[i], best[i]));
    if (best[i].result.status == Status::failed) json["complete"] = false;
  }
  if (const FilterSpec* own = task.baseline ? &*task.baseline : nullptr) {
    const Family* family = family_of(*own);
    json["own_family"] = family != nullptr ? Json(family->name) : Json(nullptr);
  }
  return {200, "application/json", dumped(json)};
}

Answer explain(const Question& question) {
  ExplainOptions options;
  options.design = options_of(question);
  options.design.time_limit = std::min(10.0, question.seconds);  // as that of `accdec explain`
  options.time_limit = question.seconds;
  const Explanation explanation = explain_task(task_of(question), options);
  const ExplanationWords words = explanation_words(explanation);
  Json json = Json::parse(explanation_to_json(explanation));
  json["words"] = {{"verdict", words.verdict},
                   {"above", words.above},
                   {"changes", {{"head", words.changes.head}, {"rows", words.changes.rows}}},
                   {"notes", words.notes}};
  return {200, "application/json", dumped(json)};
}

Answer export_file(const Question& question) {
  const bool binary = question.format == "npy";
  const char* const type = binary ? "application/octet-stream" : "text/plain; charset=utf-8";
  if (question.format == "result") {
    DesignResult result =
        question.held > 0 ? *result_of(question) : design_task(task_of(question), options_of(question));
    if (result.filter && result.task.baseline && !result.task.filter && !control_restricts(result.task))
      result.savings = study::savings(study::compare_with_baselines(result, 1.0));
    return {200, type, result_to_json(result)};
  }
  return {200, type, export_taps(*result_of(question), question.format)};
}

/// Why the tasks of a list cannot be designed; null for those that can. The list ends where the time is over.
Answer check(const Question& question) {
  if (json_too_deep(question.body)) return problem(400, "brackets nest more than 64 deep; no list of tasks does");
  const Json tasks = Json::parse(question.body, nullptr, false);
  if (!tasks.is_array()) return problem(400, "not a list of tasks");
  // Cancelled before it begins: what a design refuses is refused, nothing is searched.
  const std::atomic<bool> enough = true;
  const Deadline deadline(question.seconds);
  Json reasons = Json::array();
  for (const Json& one : tasks) {
    const std::string text = one.dump();
    try {
      const Question about{.name = "design", .body = text, .format = "", .cancel = &enough};
      design_task(task_of(about), options_of(about));
      reasons.push_back(nullptr);
    } catch (const std::exception& error) {
      reasons.push_back(error.what());
    }
    if (deadline.over() || (question.cancel != nullptr && question.cancel->load())) break;
  }
  return {200, "application/json", dumped(reasons)};
}

Json key_json(const Key& key) {
  static constexpr std::pair<KeyType, const char*> names[] = {
      {KeyType::number, "number"}, {KeyType::integer, "integer"}, {KeyType::boolean, "boolean"},
      {KeyType::text, "text"},     {KeyType::word, "word"},       {KeyType::numbers, "numbers"},
      {KeyType::texts, "texts"},   {KeyType::words, "words"},     {KeyType::table, "table"},
      {KeyType::tables, "tables"}};
  const auto* const name =
      std::find_if(std::begin(names), std::end(names), [&](const auto& n) { return n.first == key.type; });
  Json json{{"name", key.name},
            {"type", key.pairs ? "pairs" : name->second},
            {"meaning", key.meaning},
            {"required", key.required}};
  const auto text = [&](const char* member, const std::string& value) {
    if (!value.empty()) json[member] = value;
  };
  text("unit", key.unit), text("fallback", key.fallback), text("example", key.example);
  if (std::isfinite(key.range.low)) json["low"] = key.range.low;
  if (std::isfinite(key.range.high)) json["high"] = key.range.high;
  if (key.range.open_low) json["open_low"] = true;
  if (const auto value = default_number(key)) json["default"] = *value;
  if (!key.words.empty()) json["words"] = key.words;
  if (key.type == KeyType::numbers) json["most"] = key.most, json["lone"] = key.lone, json["whole"] = key.whole;
  if (key.per_axis) json["per_axis"] = true;
  if (key.of_period) json["of_period"] = true;
  if (!key.conditions.empty()) json["conditions"] = Json::parse(key.conditions);
  for (const Key& inner : key.keys) json["keys"].push_back(key_json(inner));
  return json;
}

Answer answer_unguarded(const Question& question) {
  if (question.name == "design") return design(question);
  if (question.name == "view")
    return {200, "application/json", dumped(view_json(*result_of(question), question.corner))};
  if (question.name == "families") return compare_families(question);
  if (question.name == "explain") return explain(question);
  if (question.name == "check") return check(question);
  if (question.name == "export") return export_file(question);
  if (question.name == "file") return {200, "text/plain; charset=utf-8", task_to_toml(task_of(question))};
  return problem(404, "no such question");
}

}  // namespace

void require_small(std::size_t corners) {
  if (corners > most_corners)
    throw std::invalid_argument(
        fmt::format("the task has {} corners; the explorer shows at most {}: accdec design takes any number", corners,
                    most_corners));
}

std::string start_json(const Task& task, const std::string& name) {
  Json json{{"name", name},
            {"task", task_to_json(task)},
            {"keys", Json::array()},
            {"shipped", Json::array()},
            {"formats", taps_formats}};
  for (const Key& key : task_file().keys) json["keys"].push_back(key_json(key));
  for (const cli::MachineFile& file : cli::machine_files())
    json["shipped"].push_back(
        {{"name", file.name},
         {"task", task_to_json(parse_task(file.text, std::string(file.name), {.response = Considered::all}))}});
  return dumped(json);
}

Answer answer(const Question& question) {
  const Deadline until(question.seconds);
  try {
    Answer given = answer_unguarded(question);
    // A cancelled search ends with what it has by then. If its time is not over, no page waits for it.
    const bool unwanted = question.cancel != nullptr && question.cancel->load() && !until.over();
    return unwanted ? Answer{204, "application/json", ""} : given;
  } catch (const InputError& error) {
    return problem(400, error.what());
  } catch (const std::invalid_argument& error) {
    return problem(400, error.what());
  } catch (const std::bad_alloc&) {
    return problem(500, "out of memory");
  } catch (const std::exception& error) {
    return problem(500, error.what());
  }
}

}  // namespace accdec::explore
