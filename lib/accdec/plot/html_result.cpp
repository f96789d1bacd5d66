#include <fmt/format.h>

#include <accdec/formats/design_report.hpp>
#include <accdec/formats/task_writer.hpp>
#include <accdec/plot/html.hpp>
#include <accdec/plot/html_result.hpp>
#include <accdec/task/settings_text.hpp>

namespace accdec {
namespace {

/// The result of the design, in one or two sentences.
std::string answer(const DesignResult& result) {
  std::string text = settings_answer(result);
  const bool set = !text.empty();
  if (!set) text = fmt::format("{:.6g} ms", 1e3 * result.cycle_time);
  if (set)
    text.pop_back();  // its line feed
  else if (result.status == Status::optimal)
    text += ", proved: no filter and delays within the limits are shorter.";
  else if (result.lower_bound)
    text += fmt::format("; proved not below {:.6g} ms{}.", 1e3 * *result.lower_bound,
                        result.gap ? fmt::format(", a gap of {:.3g} %", 100.0 * *result.gap) : "");
  else
    text += ".";
  if (const VerificationReport& v = result.verification; v.performed && !v.worst.empty())
    text += fmt::format(" {}; worst: {}.",
                        v.feasible ? "All limits hold in simulation" : "NOT all limits hold in simulation", v.worst);
  return text;
}

std::string numbers(const DesignResult& result) {
  HtmlTable table{{"quantity", "value", "unit"}, {}, "numbers"};
  const auto add = [&](const char* what, const std::string& value, const char* unit) {
    table.rows.push_back({what, value, unit});
  };
  add("status", std::string(to_string(result.status)), "");
  add("cycle time", fmt::format("{:.9g}", 1e3 * result.cycle_time), "ms");
  add("corners by themselves", fmt::format("{:.9g}", 1e3 * result.corner_time), "ms");
  if (result.family_bound)
    add("proved lower bound of the family", fmt::format("{:.9g}", 1e3 * *result.family_bound), "ms");
  if (result.free_taps) add("free taps, best known", fmt::format("{:.9g}", 1e3 * *result.free_taps), "ms");
  if (result.lower_bound) add("proved lower bound", fmt::format("{:.9g}", 1e3 * *result.lower_bound), "ms");
  add("filter order", fmt::format("{}", result.filter->order()), "");
  add("taps", fmt::format("{}", result.filter->order() + 1), "");
  add("sample period", fmt::format("{:g}", 1e3 * result.task.sample_period), "ms");
  add("mean delay of the filter", fmt::format("{:.6g}", 1e3 * result.task.sample_period * result.filter->mean_delay()),
      "ms");
  if (const SolverReport& s = result.solver; !s.name.empty()) {
    add("solver", fmt::format("{}{}{}", s.name, s.version.empty() ? "" : " ", s.version), "");
    add("time to solve", fmt::format("{:.3g}", 1e3 * s.wall_time), "ms");
  }
  return html_table(table);
}

std::string taps(const Filter& filter) {
  HtmlTable table{{"tap", "weight"}, {}, "taps"};
  for (int i = 0; i <= filter.order(); ++i)
    table.rows.push_back({fmt::format("{}", i), fmt::format("{}", filter.tap(i))});
  return html_table(table);
}

}  // namespace

std::string html_result_page(const DesignResult& result, const Figure& figure, const std::string& svg) {
  const ReportTable corners = corner_report(result), limits = limit_report(result);
  std::string html = html_head(result.task.title.empty() ? "accdec" : result.task.title);
  html += html_paragraph(answer(result));
  html += html_figure("figure", figure, svg);
  html += html_table({corners.head, corners.rows, "corners"});
  html += html_table({limits.head, limits.rows, "limits"});
  if (!limits.note.empty()) html += html_paragraph(limits.note);
  html += html_folded("Numbers of the design", numbers(result));
  html += html_folded("Taps", taps(*result.filter));
  html +=
      html_folded("The task, as a task file", fmt::format("<pre>{}</pre>\n", html_escaped(task_to_toml(result.task))));
  return html + html_foot();
}

}  // namespace accdec
