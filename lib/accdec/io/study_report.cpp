#include <accdec/io/study_report.hpp>

#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace accdec {
namespace {

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      default: out += c;
    }
  }
  return out;
}

constexpr std::string_view style =
    "body{font:16px/1.45 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem;color:#1a1a1a;background:#fff}"
    "table{border-collapse:collapse;margin:1rem 0}td,th{border:1px solid #bbb;padding:.25rem .6rem;text-align:left}"
    "td.n{text-align:right}figure{margin:2rem 0}svg{max-width:100%;height:auto}";

std::string values_of(const study::Variation& v) {
  constexpr std::size_t shown = 12;
  if (v.values.size() <= shown) return fmt::format("{:g}", fmt::join(v.values, ", "));
  return fmt::format("{:g} to {:g}, {} values{}", v.values.front(), v.values.back(), v.values.size(), v.logarithmic ? ", logarithmic" : "");
}

std::string variations_table(const Study& study) {
  std::string html = "<table><tr><th>Varied</th><th>Task keys</th><th>Values</th></tr>\n";
  if (study.plan().cases().size() > 1) {
    html += fmt::format("<tr><td>case</td><td></td><td>{}</td></tr>\n", escaped(fmt::format("{}", fmt::join(study.plan().cases(), ", "))));
  }
  for (const study::Variation& v : study.plan().variations()) {
    html += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td></tr>\n", escaped(v.name), escaped(fmt::format("{}", fmt::join(v.keys, ", "))), values_of(v));
  }
  return html + "</table>\n";
}

std::string summary_table(const Study& study, const StudyTable& table) {
  std::string html = "<table><tr><th>Computed</th><th>Outcome</th><th>Points</th><th>Shortest / ms</th><th>Longest / ms</th></tr>\n";
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
      html += fmt::format("<tr><td>{}</td><td>{}</td><td class=n>{}</td><td class=n>{}</td><td class=n>{}</td></tr>\n", escaped(name), outcome, tally.count,
                          times ? fmt::format("{:g}", tally.low) : "", times ? fmt::format("{:g}", tally.high) : "");
    }
  }
  return html + "</table>\n";
}

/// The drawing alone: its XML prologue names a DTD, and a report must point nowhere.
std::string inline_svg(const std::string& svg) {
  const std::size_t start = svg.find("<svg");
  return start == std::string::npos ? "" : svg.substr(start);
}

}  // namespace

std::vector<std::pair<std::string, std::string>> study_documents(const Study& study, const std::vector<std::string>& lines) {
  std::vector<std::pair<std::string, std::string>> documents;
  std::string jsonl;
  for (const std::string& line : lines) jsonl += line + '\n';
  documents.emplace_back("rows.jsonl", std::move(jsonl));
  const StudyTable table(study, lines);
  documents.emplace_back("rows.csv", table.csv());

  const auto bad = static_cast<std::size_t>(std::count_if(table.texts("point").begin(), table.texts("point").end(), [](const auto& p) { return p != "ok"; }));
  std::string html = fmt::format("<!DOCTYPE html>\n<html lang=en><head><meta charset=utf-8><title>{0}</title><style>{1}</style></head><body>\n<h1>{0}</h1>\n",
                                 escaped(study.title), style);
  if (!study.notes.empty()) html += fmt::format("<p>{}</p>\n", escaped(study.notes));
  html += fmt::format("<p>{} points{}. Every row stands in rows.csv and rows.jsonl; how it was made, in manifest.json.</p>\n", table.size(),
                      bad == 0 ? "" : fmt::format(", {} of them without an answer (column <code>reason</code>)", bad));
  html += variations_table(study) + summary_table(study, table);
  for (const StudyFigure& f : study.figures) {
    const std::string svg = render_svg(make_study_figure(f, table));
    html += fmt::format("<figure id=\"{}\">\n{}\n</figure>\n", f.name, inline_svg(svg));
    documents.emplace_back(f.name + ".png", convert_svg(svg, "png"));
    documents.emplace_back(f.name + ".svg", svg);
  }
  documents.emplace_back("report.html", html + "</body></html>\n");
  return documents;
}

}  // namespace accdec
