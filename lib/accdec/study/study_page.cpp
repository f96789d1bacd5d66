#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/formats/task_writer.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/machine/mode_text.hpp>
#include <accdec/plot/html.hpp>
#include <accdec/study/study_page.hpp>

namespace accdec {
namespace {

std::string values_of(const study::Variation& v) {
  constexpr std::size_t shown = 12;
  if (v.values.size() <= shown) return fmt::format("{:g}", fmt::join(v.values, ", "));
  return fmt::format("{:g} to {:g}, {} values{}", v.values.front(), v.values.back(), v.values.size(),
                     v.logarithmic ? ", logarithmic" : "");
}

/// Points of one computation by outcome, with the range of their times.
struct Tally {
  std::size_t count = 0;
  double low = 0.0, high = 0.0;
};

std::map<std::string, Tally> outcomes_of(const std::string& computation, const StudyTable& table) {
  std::map<std::string, Tally> outcomes;
  const auto& time = table.numbers(computation + ".cycle_time_ms");
  for (std::size_t i = 0; i < table.size(); ++i) {
    const std::string& status = table.text(computation + ".status", i);
    Tally& tally = outcomes[status.empty() ? "not computed" : status];
    tally.low = tally.count == 0 ? time[i] : std::min(tally.low, time[i]);
    tally.high = tally.count == 0 ? time[i] : std::max(tally.high, time[i]);
    ++tally.count;
  }
  return outcomes;
}

std::string sentence_on(const std::string& computation, const StudyTable& table) {
  std::size_t answered = 0, proved = 0;
  std::optional<Tally> range;
  for (const auto& [outcome, tally] : outcomes_of(computation, table)) {
    if (outcome != "optimal" && outcome != "feasible") continue;
    answered += tally.count;
    if (outcome == "optimal") proved = tally.count;
    if (!range) range = tally;
    range->low = std::min(range->low, tally.low);
    range->high = std::max(range->high, tally.high);
  }
  const bool proves = computation == "optimum" || computation == "delays";
  std::string text = fmt::format("{}: {} of {} points have an answer", computation, answered, table.size());
  if (proves) text += fmt::format(", {} of them proved optimal", proved);
  if (range) text += fmt::format("; cycle times from {:g} to {:g} ms", range->low, range->high);
  return text + ".";
}

/// A limit's value, or "varied" if a variation sets its key for this axis, for all axes, or for a mode.
std::string value_or_varied(const Study& study, std::string_view table, std::string_view key, double value) {
  for (const study::Variation& v : study.points().variations()) {
    for (const std::string& k : v.keys) {
      if (k.starts_with(table) && k.ends_with(fmt::format(".{}", key))) return fmt::format("varied ({})", v.name);
    }
  }
  return value < unlimited ? fmt::format("{:.7g}", value) : "-";
}

std::string limits_html(const Study& study, const Task& task) {
  HtmlTable axes{{"axis"}, {}};
  for (const AxisLimit& limit : axis_limits)
    axes.head.push_back(fmt::format("{} / {}", to_string(limit.kind), limit_name(limit.kind).unit));
  for (const Axis& axis : task.machine.axes) {
    axes.rows.push_back({axis.name});
    for (const AxisLimit& limit : axis_limits)
      axes.rows.back().push_back(
          value_or_varied(study, "axis.", limit.key, limit_name(limit.kind).per_si * (axis.*limit.bound)));
  }
  HtmlTable corners{{"corner", "interior angle / deg", "feed in / (mm/min)", "feed out / (mm/min)", "tolerance / µm"},
                    {}};
  for (const TaskCorner& c : task.corners) {
    const Corner& geometry = c.geometry();
    const auto cell = [&](const char* key, double value) { return value_or_varied(study, "corner.", key, value); };
    corners.rows.push_back({c.name, cell("angle_deg", 180.0 / M_PI * std::acos(geometry.cos_interior())),
                            cell("feed_in_mm_min", 6e4 * geometry.feed_in),
                            cell("feed_out_mm_min", 6e4 * geometry.feed_out),
                            cell("error_max_um", 1e6 * c.error_max.value_or(unlimited))});
  }
  HtmlTable modes{{"vibration", "residual at most"}, {}};
  for (const Mode& mode : task.machine.modes)
    modes.rows.push_back({range_of(mode), mode.of_axis()
                                              ? fmt::format("{:g} µm of {}", 1e6 * mode.displacement_max,
                                                            task.machine.axes[static_cast<std::size_t>(mode.axis)].name)
                                              : fmt::format("{:g}", mode.residual_max)});
  return html_table(axes) + html_table(corners) + (modes.rows.empty() ? "" : html_table(modes));
}

/// The first of a few points of a case that makes a task.
std::optional<Task> sample_task(const Study& study, std::size_t c) {
  const std::size_t per_case = study.points().size() / study.points().cases().size();
  for (const std::size_t i : {std::size_t{0}, per_case / 2, per_case - 1}) {
    try {
      return study.task(c * per_case + i);
    } catch (const std::exception&) {
      continue;
    }
  }
  return std::nullopt;
}

}  // namespace

std::string study_answer(const Study& study, const StudyTable& table) {
  std::string html;
  constexpr std::size_t told = 3;
  for (std::size_t c = 0; c < std::min(told, study.computations.size()); ++c)
    html += html_paragraph(sentence_on(study.computations[c], table));
  if (table.cut_off() == 0) return html;
  return html +
         fmt::format(
             "<p>{} cut off by the study's time limit of {:g} s (their <code>stop</code> is "
             "<q>time limit</q>). What they state is verified, but how far they got depends on the machine and on "
             "how many "
             "workers shared it.</p>\n",
             table.cut_off() == 1 ? "1 computation was" : fmt::format("{} computations were", table.cut_off()),
             study.design.time_limit);
}

std::string study_outcomes(const Study& study, const StudyTable& table) {
  HtmlTable html{{"computed", "outcome", "points", "shortest / ms", "longest / ms"}, {}, "outcomes"};
  for (const std::string& name : study.computations) {
    for (const auto& [outcome, tally] : outcomes_of(name, table)) {
      const bool times = tally.low == tally.low;
      html.rows.push_back({name, outcome, fmt::format("{}", tally.count), times ? fmt::format("{:g}", tally.low) : "",
                           times ? fmt::format("{:g}", tally.high) : ""});
    }
  }
  return html_table(html);
}

std::string study_variations(const Study& study) {
  HtmlTable table{{"varied", "task keys", "values"}, {}};
  if (study.points().cases().size() > 1)
    table.rows.push_back({"case", "", fmt::format("{}", fmt::join(study.points().cases(), ", "))});
  for (const study::Variation& v : study.points().variations())
    table.rows.push_back({v.name, fmt::format("{}", fmt::join(v.keys, ", ")), values_of(v)});
  return html_table(table);
}

std::string study_base(const Study& study) {
  std::string html;
  const std::vector<std::string> paths = study.task_paths();
  for (std::size_t c = 0; c < paths.size(); ++c) {
    const std::string file = std::filesystem::path(paths[c]).filename().string();
    const std::string name =
        study.points().cases().size() > 1 ? fmt::format("{} ({})", study.points().cases()[c], file) : file;
    const std::optional<Task> task = sample_task(study, c);
    if (!task) {
      html += html_paragraph(fmt::format("{}: its first, middle and last points make no task.", name));
      continue;
    }
    html += fmt::format("<h3>{}</h3>\n", html_escaped(name));
    if (!task->title.empty()) html += html_paragraph(task->title);
    html += limits_html(study, *task);
    html += html_folded("The whole task, at the first values of what is varied",
                        fmt::format("<pre>{}</pre>\n", html_escaped(task_to_toml(*task))));
  }
  return html;
}

std::string study_rows(const StudyTable& table) {
  HtmlTable html{{}, std::vector<std::vector<std::string>>(table.first_rows().size()), "rows", true};
  for (std::size_t c = 0; c < table.columns().size(); ++c) {
    const bool any = std::any_of(table.first_rows().begin(), table.first_rows().end(),
                                 [&](const auto& row) { return !row[c].empty(); });
    if (!any) continue;
    html.head.push_back(table.columns()[c]);
    for (std::size_t i = 0; i < html.rows.size(); ++i) html.rows[i].push_back(table.first_rows()[i][c]);
  }
  constexpr std::size_t columns_on_paper = 14;
  return fmt::format("<div class=\"tall{}\">{}</div>\n", html.head.size() > columns_on_paper ? " unprinted" : "",
                     html_table(html));
}

}  // namespace accdec
