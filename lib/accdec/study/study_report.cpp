#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/plot/html.hpp>
#include <accdec/study/compute.hpp>
#include <accdec/study/study_report.hpp>

namespace accdec {
namespace {

std::string values_of(const study::Variation& v) {
  constexpr std::size_t shown = 12;
  if (v.values.size() <= shown) return fmt::format("{:g}", fmt::join(v.values, ", "));
  return fmt::format("{:g} to {:g}, {} values{}", v.values.front(), v.values.back(), v.values.size(),
                     v.logarithmic ? ", logarithmic" : "");
}

std::string variations_table(const Study& study) {
  std::string html = "<table><tr><th>Varied</th><th>Task keys</th><th>Values</th></tr>\n";
  if (study.plan().cases().size() > 1) {
    html += fmt::format("<tr><td>case</td><td></td><td>{}</td></tr>\n",
                        html_escaped(fmt::format("{}", fmt::join(study.plan().cases(), ", "))));
  }
  for (const study::Variation& v : study.plan().variations()) {
    html += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td></tr>\n", html_escaped(v.name),
                        html_escaped(fmt::format("{}", fmt::join(v.keys, ", "))), values_of(v));
  }
  return html + "</table>\n";
}

std::string summary_table(const Study& study, const StudyTable& table) {
  std::string html =
      "<table><tr><th>Computed</th><th>Outcome</th><th>Points</th><th>Shortest / ms</th><th>Longest / ms</th></tr>\n";
  for (const std::string& name : study.computations) {
    struct Tally {
      std::size_t count = 0;
      double low = 0.0, high = 0.0;
    };
    std::map<std::string, Tally> outcomes;
    const auto& status = table.texts(name + ".status");
    const auto& time = table.numbers(name + ".cycle_time_ms");
    for (std::size_t i = 0; i < table.size(); ++i) {
      Tally& tally = outcomes[status[i].empty() ? "not computed" : status[i]];
      tally.low = tally.count == 0 ? time[i] : std::min(tally.low, time[i]);
      tally.high = tally.count == 0 ? time[i] : std::max(tally.high, time[i]);
      ++tally.count;
    }
    for (const auto& [outcome, tally] : outcomes) {
      const bool times = tally.low == tally.low;
      html += fmt::format("<tr><td>{}</td><td>{}</td><td class=n>{}</td><td class=n>{}</td><td class=n>{}</td></tr>\n",
                          html_escaped(name), outcome, tally.count, times ? fmt::format("{:g}", tally.low) : "",
                          times ? fmt::format("{:g}", tally.high) : "");
    }
  }
  return html + "</table>\n";
}

/// A sentence on optima that the time limit ended early; empty without any.
std::string cut_off_note(const Study& study, const StudyTable& table) {
  std::size_t count = 0;
  for (const std::string& name : study.computations) {
    const auto& messages = table.texts(name + ".message");
    count += static_cast<std::size_t>(
        std::count_if(messages.begin(), messages.end(), [](const std::string& m) { return study::cut_off(m); }));
  }
  if (count == 0) return "";
  return fmt::format(
      "<p>{} cut off by the study's time limit of {:g} s (their <code>message</code> begins with <q>stopped</q>). What "
      "they state is verified, "
      "but how far they got depends on the machine and on how many workers shared it.</p>\n",
      count == 1 ? "1 computation was" : fmt::format("{} computations were", count), study.design.time_limit);
}

}  // namespace

std::vector<std::pair<std::string, std::string>> study_documents(const Study& study,
                                                                 const std::vector<std::string>& lines,
                                                                 std::vector<std::string>* empty) {
  std::vector<std::pair<std::string, std::string>> documents;
  std::string jsonl;
  for (const std::string& line : lines) jsonl += line + '\n';
  documents.emplace_back("rows.jsonl", std::move(jsonl));
  const StudyTable table(study, lines);
  documents.emplace_back("rows.csv", table.csv());

  const auto bad = static_cast<std::size_t>(
      std::count_if(table.texts("point").begin(), table.texts("point").end(), [](const auto& p) { return p != "ok"; }));
  std::string html = html_head(study.title);
  if (!study.notes.empty()) html += fmt::format("<p>{}</p>\n", html_escaped(study.notes));
  html += fmt::format(
      "<p>{} points{}. Every row stands in rows.csv and rows.jsonl; how it was made, in manifest.json.</p>\n",
      table.size(), bad == 0 ? "" : fmt::format(", {} of them without an answer (column <code>reason</code>)", bad));
  html += cut_off_note(study, table) + variations_table(study) + summary_table(study, table);
  for (const StudyFigure& f : study.figures) {
    const Figure figure = make_study_figure(f, table);
    if (empty && !has_data(figure.panels.front())) empty->push_back(f.name);
    const std::string svg = render_svg(figure);
    html += html_figure(f.name, svg);
    documents.emplace_back(f.name + ".png", convert_svg(svg, "png"));
    documents.emplace_back(f.name + ".svg", svg);
  }
  documents.emplace_back("report.html", html + "</body></html>\n");
  return documents;
}

}  // namespace accdec
