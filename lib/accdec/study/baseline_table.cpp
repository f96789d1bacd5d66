#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/files.hpp>
#include <accdec/files/shown_text.hpp>
#include <accdec/formats/design_report.hpp>
#include <accdec/study/baseline_table.hpp>

namespace accdec::study {
namespace {

void add_row(TextTable& table, std::string name, std::string parameters, const DesignResult& result,
             const DesignResult& design, std::string note = "") {
  if (!result.filter) {
    table.add({std::move(name), "-", "-", "-", "-", "-", "-", result.message});
    return;
  }
  std::vector<int> delays;
  for (const CornerResult& corner : result.corners) delays.push_back(corner.delay);
  if (stops_exactly(result)) note += note.empty() ? "exact stop" : ", exact stop";
  const std::string more =
      design.filter ? fmt::format("{:.1f}", 100.0 * (result.objective() / design.objective() - 1.0)) : "-";
  table.add({std::move(name), std::move(parameters), std::to_string(result.filter->order()),
             fmt::format("{}", fmt::join(delays, " ")), shown_ms(result.cycle_time), shown_ms(result.corner_time), more,
             std::move(note)});
}

std::string rows(const BaselineTable& t) {
  TextTable table({"filter", "parameters", "N", "d", "cycle ms", "corners ms", "more %", "note"});
  for (const std::size_t left : {std::size_t{0}, std::size_t{1}, std::size_t{7}}) table.left(left);
  add_row(table, "designed", "free taps", t.design, t.design,
          t.design.status == Status::optimal ? "proved" : t.design.message);
  if (t.own) {
    const Task& task = t.own->task;
    add_row(table, "yours: " + shape_title(task.filter->kind, task.filter->pairs, task.filter->outer),
            describe_parameters(*task.filter), *t.own, t.design);
  }
  // Families without a filter, grouped by the reason.
  std::vector<std::pair<std::string, std::string>> without;
  for (std::size_t i = 0; i < t.families.size(); ++i) {
    const FamilyResult& family = t.families[i];
    const std::string& title = families()[i].title;
    if (family.spec) {
      add_row(table, title, describe_parameters(*family.spec), family.result, t.design);
      continue;
    }
    if (families()[i].pairs > 0 && t.design.task.machine.modes.empty()) continue;  // nothing to cancel
    const auto same = std::find_if(without.begin(), without.end(),
                                   [&](const auto& other) { return other.first == family.result.message; });
    if (same == without.end())
      without.emplace_back(family.result.message, title);
    else
      same->second += "; " + title;
  }
  std::string text = fmt::format("\nat {:g} ms\n{}", 1e3 * t.design.task.sample_period, table.str());
  for (const auto& [why, titles] : without) text += fmt::format("{}: {}\n", titles, why);
  return text;
}

const Family& baseline_of(const BaselineTable& table, const FamilyResult& family) {
  return families()[static_cast<std::size_t>(&family - table.families.data())];
}

std::string symbols() {
  return "\n" + legend({"N", "d", "cycle", "corners"});
}

}  // namespace

const FamilyResult* BaselineTable::best() const {
  const FamilyResult* least = nullptr;
  for (const FamilyResult& family : families) {
    if (family.result.filter && (least == nullptr || family.result.objective() < least->result.objective())) {
      least = &family;
    }
  }
  return least;
}

const FamilyResult* BaselineTable::best_of_own() const {
  const Family* family = own ? family_of(*own->task.filter) : nullptr;
  if (family == nullptr || families.empty()) return nullptr;
  const FamilyResult& result = families[static_cast<std::size_t>(family - accdec::families().data())];
  return result.result.filter ? &result : nullptr;
}

bool BaselineTable::complete() const {
  return std::none_of(families.begin(), families.end(),
                      [](const FamilyResult& f) { return f.result.status == Status::failed; });
}

std::optional<double> BaselineTable::saving() const {
  if (best() == nullptr || !design.filter) return std::nullopt;
  return 1.0 - design.objective() / best()->result.objective();
}

BaselineTable compare_with_baselines(const Task& task, const DesignOptions& options) {
  Task open = task;
  open.filter.reset();
  DesignOptions half = options;
  half.time_limit = 0.5 * options.time_limit;
  const auto began = std::chrono::steady_clock::now();
  const DesignResult design = design_task(open, half);
  DesignOptions rest = options;
  rest.time_limit = options.time_limit - seconds_since(began);
  return compare_with_baselines(design, task, rest);
}

BaselineTable compare_with_baselines(const DesignResult& design, const Task& task, const DesignOptions& options) {
  const auto began = std::chrono::steady_clock::now();
  BaselineTable table{design, {}, std::nullopt};
  if (const auto& own = task.baseline ? task.baseline : task.filter) {
    Task given = task;
    given.filter = own;
    table.own = design_delays(given, options);
  }
  table.families = best_members(design.task, options.time_limit - seconds_since(began), options.cancel);
  return table;
}

BaselineTable compare_with_baselines(const DesignResult& design, double seconds) {
  BaselineTable table{design, {}, std::nullopt};
  if (design.task.baseline) {
    Task given = design.task;
    given.filter = design.task.baseline;
    table.own = design_delays(given);
  }
  if (seconds > 0.0) table.families = best_members(design.task, seconds);
  return table;
}

namespace {

/// Taps of a response at a shorter period: each is spread over the samples that one was.
void spread(std::vector<double>& taps, int times) {
  std::vector<double> finer;
  for (const double tap : taps) finer.insert(finer.end(), static_cast<std::size_t>(times), tap / times);
  taps = std::move(finer);
}

}  // namespace

Task at_shorter_period(Task task, int times) {
  task.sample_period /= times;
  spread(task.machine.prefilter_taps, times);
  for (Axis& axis : task.machine.axes) spread(axis.response_taps, times);
  // N + 1 taps last (N + 1) T.
  task.design.order_min = std::max(0, (task.design.order_min + 1) * times - times);
  task.design.order_max = (task.design.order_max + 1) * times - 1;
  task.filter.reset();
  task.baseline.reset();
  for (TaskCorner& corner : task.corners) {
    if (corner.delay) *corner.delay *= times;
  }
  return task;
}

std::string baseline_text(const BaselineTable& table, const BaselineTable& quarter) {
  std::string text = rows(table) + rows(quarter) + symbols();
  if (!table.saving() || !quarter.saving())
    return text + "\nno saving can be stated: a design or every family is missing\n";
  const auto percent = [](double share) { return std::round(1000.0 * share) / 10.0 + 0.0; };
  const double here = percent(*table.saving()), there = percent(*quarter.saving());
  const auto name = [](const BaselineTable& t) -> const std::string& { return baseline_of(t, *t.best()).title; };
  if (here < 0.0 || there < 0.0)
    return text + "\nno saving can be stated: a search was stopped before it was as good\n";
  const bool all = table.complete() && quarter.complete();
  text += fmt::format("\nsaved against the best family{}: {:.1f} % at {:g} ms ({}), {:.1f} % at {:g} ms ({})\n",
                      all ? "" : " of those searched to the end", here, 1e3 * table.design.task.sample_period,
                      name(table), there, 1e3 * quarter.design.task.sample_period, name(quarter));
  if (here > there + 0.05 && all && quarter.design.status == Status::optimal) {
    text +=
        fmt::format("{:.1f} of these {:.1f} % are rounding to whole samples: a shorter sample period saves them too\n",
                    here - std::max(0.0, there), here);
  }
  return text;
}

std::string baseline_text(const BaselineTable& table) {
  return rows(table) + symbols();
}

std::optional<Savings> savings(const BaselineTable& table) {
  if (!table.own || !table.own->filter || !table.design.filter) return std::nullopt;
  Savings saved;
  saved.today = table.own->objective();
  saved.total = saved.today - table.design.objective();
  saved.complete = !table.families.empty() && table.complete();
  double before = saved.today;
  const auto step = [&](double time) {
    const double gained = before - time;
    before = time;
    return gained;
  };
  if (const FamilyResult* retuned = table.best_of_own()) saved.by_retuning = step(retuned->result.objective());
  if (const FamilyResult* best = table.best()) {
    saved.family = baseline_of(table, *best).name;
    saved.by_family = step(best->result.objective());
    saved.by_taps = step(table.design.objective());
  }
  return saved;
}

std::string savings_text(const BaselineTable& table) {
  if (!table.own) return "";
  const FilterSpec& today = *table.own->task.filter;
  const std::string parameters = describe_parameters(today);
  std::string text = fmt::format("\ntoday: {}, order {}{}: ", shape_title(today.kind, today.pairs, today.outer),
                                 make_filter(today).order(), parameters.empty() ? "" : ", " + parameters);
  const std::optional<Savings> saved = savings(table);
  if (!saved) return text + table.own->message + "\n";
  std::vector<int> delays;
  for (const CornerResult& corner : table.own->corners) delays.push_back(corner.delay);
  text += fmt::format("{} ms with delay{} {}; the design saves {} ms ({:.1f} %)\n", shown_ms(saved->today),
                      delays.size() == 1 ? "" : "s", fmt::join(delays, " "), shown_ms(saved->total),
                      100.0 * saved->total / saved->today);
  if (!saved->by_family) return text;
  const auto add = [&](const char* limit, const std::string& how, double saving) {
    text += fmt::format("  {}{} ms ({:.1f} %) by {}\n", limit, shown_ms(saving), 100.0 * saving / saved->today, how);
  };
  // A family that was not searched to the end may be better still.
  const char *at_least = saved->complete ? "" : "at least ", *at_most = saved->complete ? "" : "at most ";
  const auto member = [](const FamilyResult& family) {
    const std::string own = describe_parameters(*family.spec);
    return fmt::format("order {}{}{}", family.result.filter->order(), own.empty() ? "" : ", ", own);
  };
  if (saved->by_retuning) add("", "retuning what you have: " + member(*table.best_of_own()), *saved->by_retuning);
  if (table.best() != table.best_of_own()) {
    add(at_least,
        fmt::format("a{} family: {}, {}", saved->by_retuning ? " further" : "nother",
                    baseline_of(table, *table.best()).title, member(*table.best())),
        *saved->by_family);
  }
  add(at_most, "free taps", *saved->by_taps);
  if (!saved->complete) text += "  (not every family was searched to the end; give --time-limit longer)\n";
  return text;
}

}  // namespace accdec::study
