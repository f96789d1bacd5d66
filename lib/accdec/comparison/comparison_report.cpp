#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/comparison/comparison_answer.hpp>
#include <accdec/comparison/comparison_report.hpp>
#include <accdec/files/csv_table.hpp>
#include <accdec/plot/html.hpp>

namespace accdec {
namespace {

using comparison::ComparisonData;

std::string settings_text(const ComparisonData& data) {
  const batch::Row& h = data.header;
  std::string longer;
  for (const comparison::ComparedCase& c : data.cases) {
    if (c.time_limit > 0.0 && c.time_limit != h.value("time_limit_s", 0.0))
      longer += fmt::format("{}{} ({}): {:g} s", longer.empty() ? " Other time limits, for all alike: " : ", ",
                            c.problem, c.question, c.time_limit);
  }
  if (!longer.empty()) longer += ".";
  return fmt::format(
      "{} problems (each size of a problem counts as one) from {} starts, {} algorithms, {} repeats in shuffled order. "
      "All runs have the same conditions. Each run has a process of its own. The evaluator ends it after {:g} s, and "
      "the process is killed after {:g} s. The objective may be evaluated {} times. The tolerance of the library's own "
      "convergence test is {:g}; these tests differ in kind. Rows must hold within a tenth of the tolerance by which "
      "they are judged. Every answer, and every point on the way, is judged by recomputation: every row and bound, "
      "scaled to 1, must hold within {:g}. The `sigma` of a margin is raised to what the taps need. It is a broken row "
      "only if it was too small by more than 0.01 % of that. On the way, solvers of the form `reduced` have their own "
      "`sigma`. The reference counts as reached within {:g} of max(1, reference). Some "
      "solvers take no equality rows, or only boxes. These, and those that the suite names, get the problem with "
      "positions substituted (form `reduced`, no second derivatives). Everything is judged in that form. Start 0 is a "
      "trapezoid. The other starts multiply its taps by random factors, the same for every solver. Whole designs "
      "(formulation `design`) are judged by simulating the motion instead: every limit must hold within 1e-9 of "
      "itself, and the solver must hold rows within 1e-9. There, the limit on evaluations is that of each single "
      "solve. "
      "Times are those of the solve alone, with what a first call in a process costs. The time to the end lasts until "
      "the solver ended. The time to accuracy lasts until the first feasible point within the accuracy of the "
      "reference. Every repeat is judged. If its answer does not reach the reference, it counts as infinitely slow by "
      "both times, whatever points it met on the way. A run has the median over its repeats. Runs that were refused or "
      "crashed are not repeated. Neither are runs that used up their time and ended ten times farther from the "
      "reference than counts as reached. Problems proved infeasible are not in the profiles: there, the right answer "
      "is to say so (infeasible recognised). A design search with these solvers can only say that it found no design. "
      "This is counted separately and not as recognised.{}",
      data.cases.size(), data.starts, data.solvers.size(), data.repeats, h.value("time_limit_s", 0.0),
      h.value("kill_after_s", 0.0), h.value("evaluation_limit", 0L), h.value("tolerance", 0.0),
      h.value("feasibility", 0.0), h.value("accuracy", 0.0), longer);
}

std::string session_text(const ComparisonData& data) {
  if (data.session.is_null()) return "";
  const batch::Row& s = data.session;
  const double all = s.value("wall_time_s", 0.0) * s.value("workers", 1);
  return fmt::format(
      "The last session computed {} entries in {:.1f} s with {} workers. {:.1f} s were spent inside the solvers "
      "({:.0f} "
      "% of that in the problems' functions), {:.1f} s judging answers, and {:.1f} s proving references. {:.2f} % of "
      "the workers' time went into processes, starts, building of problems, waiting and records.",
      s.value("entries", 0), s.value("wall_time_s", 0.0), s.value("workers", 1), s.value("solving_s", 0.0),
      100.0 * s.value("evaluating_s", 0.0) / std::max(1e-9, s.value("solving_s", 0.0)), s.value("judging_s", 0.0),
      s.value("references_s", 0.0), all > 0.0 ? 100.0 * s.value("bookkeeping_share", 0.0) : 0.0);
}

/// Says that there is no contradiction.
std::string no_contradiction(const ComparisonData& data) {
  return html_paragraph(
      fmt::format("No verified answer lies below a proved bound by more than {:g} of max(1, bound). No verified answer "
                  "is of a problem proved infeasible. Every problem is feasible or not as the suite says.",
                  data.accuracy));
}

/// Lists contradictions. If there are any, nothing on the page can be trusted.
std::string contradictions_html(const ComparisonData& data) {
  if (data.contradictions.empty()) return "";
  std::string html = "<h2>Contradictions</h2>\n<ul>\n";
  for (const std::string& c : data.contradictions) html += fmt::format("<li>{}</li>\n", html_escaped(c));
  return html + "</ul>\n";
}

/// Notes that a figure needs.
std::string figure_notes(const std::string& name) {
  const auto is = [&](const char* kind) { return name == kind || name == fmt::format("design-{}", kind); };
  if (is("performance")) {
    return html_paragraph(
        "The time counts until the first feasible point within the accuracy that is judged, so that polishing beyond "
        "it "
        "costs nothing. Only runs that ended with an answer as good count as solved: without the reference, the answer "
        "is all that a user has. Costs are divided by the least cost of the plain solvers. Variants are left out of "
        "it, "
        "because they would take wins from the solver that they vary. The next figure has the same runs, by the time "
        "until the solver ended by its own test. These tests differ in kind.");
  }
  if (is("data")) {
    return html_paragraph(
        "The number of evaluations is that of the objective or that of the rows, whichever is larger. Gradients, "
        "Jacobians and Hessians are free. So solvers with derivatives can be compared only with each other, and even "
        "then second derivatives are free. Solvers with values only can be compared with each other, too. A target "
        "counts as met whatever the final answer is.");
  }
  if (is("runtime"))
    return html_paragraph(
        "A target counts as met whatever the final answer is. So these curves may end higher than the shares of "
        "problems solved.");
  return "";
}

/// Some columns of a table, and only rows whose first cell is `first` (if any).
std::string part(const ComparisonTable& table, const std::vector<std::size_t>& columns, const std::string& first = "") {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
  for (const std::size_t c : columns) head.push_back(table.head[c]);
  for (const auto& row : table.rows) {
    if (!first.empty() && row.front() != first) continue;
    rows.emplace_back();
    for (const std::size_t c : columns) rows.back().push_back(row[c]);
  }
  return html_table({head, rows, "", true});
}

}  // namespace

std::string solvers_html(const ComparisonData& data) {
  const batch::Row& solvers = data.header.at("solvers");
  const bool any_options =
      std::any_of(solvers.begin(), solvers.end(), [](const batch::Row& s) { return s.contains("options"); });
  std::vector<std::string> head{"solver", "library", "search", "uses", "form", "asked of the library"};
  if (any_options) head.emplace_back("and for this entry");
  std::vector<std::vector<std::string>> rows;
  for (const batch::Row& solver : solvers) {
    rows.emplace_back();
    for (const char* key : {"name", "library", "search", "uses", "form", "settings"})
      rows.back().push_back(solver.value(key, ""));
    if (!any_options) continue;
    std::vector<std::string> options;
    if (const auto set = solver.find("options"); set != solver.end()) {
      for (const auto& [name, value] : set->items())
        options.push_back(fmt::format("{} = {}", name, value.is_string() ? value.get<std::string>() : value.dump()));
    }
    rows.back().push_back(fmt::format("{}", fmt::join(options, ", ")));
  }
  return html_table({head, rows});
}

std::vector<std::pair<std::string, std::string>> comparison_documents(const std::vector<std::string>& lines) {
  const ComparisonData data = comparison::read_comparison(lines);
  std::vector<std::pair<std::string, std::string>> documents;
  const ComparisonTable problems = problems_table(data), summary = summary_table(data),
                        confusion = confusion_table(data);
  for (const ComparisonTable& table : {problems, summary, confusion, runs_table(data), pairs_table(data)}) {
    documents.emplace_back(table.name + ".csv", csv_table(table.head, table.rows));
  }
  std::string html = html_head(data.header.value("title", "Comparison"));
  html += html_paragraph(answer_text(data)) + contradictions_html(data);
  const ComparisonTable answer = answer_table(data);
  html += html_table({answer.head, answer.rows, "answer", true});
  documents.emplace_back("answer.csv", csv_table(answer.head, answer.rows));

  html += "<h2>Profiles</h2>\n";
  std::string more_profiles;
  for (const auto& [name, figure] : comparison_figures(data)) {
    const std::string svg = render_svg(figure);
    const bool first = name == "performance" || name == "design-performance";
    (first ? html : more_profiles) += figure_notes(name) + html_figure(name, figure, svg);
    documents.emplace_back(name + ".png", convert_svg(svg, "png"));
    documents.emplace_back(name + ".svg", svg);
  }
  html += html_folded("More profiles: to the solver's end, by evaluations, pairs, run times", more_profiles);

  html += html_folded("What each solver came to", part(summary, {0, 3, 5, 6, 8, 9, 10, 11, 12, 7, 13, 14, 15, 16}));
  html += html_folded("Time and evaluations of the runs that reached the reference",
                      part(summary, {0, 8, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27}));
  html += html_folded("Claimed against verified, all solvers", part(confusion, {1, 2, 3, 4, 5, 6, 7}, "all"));
  html += html_folded("Problems and reference values", part(problems, {0, 1, 2, 11, 3, 4, 5, 6, 7, 8, 9, 10}));
  html += html_folded("Solvers, their libraries and options", solvers_html(data));
  std::string how = html_paragraph(settings_text(data));
  if (data.contradictions.empty()) how += no_contradiction(data);
  if (const std::string notes = data.header.value("notes", ""); !notes.empty()) how = html_paragraph(notes) + how;
  if (const std::string session = session_text(data); !session.empty()) how += html_paragraph(session);
  how += html_paragraph(
      "Not every point on the way is recorded. The time, or number of evaluations, to a target is that of a recorded "
      "point: the first within the target, or at the latest the first that is nearer by a tenth of the target's "
      "distance. This holds for times to accuracy, too. Each solver has the same line and symbol in all figures but "
      "those of pairs.");
  html += html_folded("How it was run and judged", how);
  html += html_paragraph(
      "Raw data: raw.jsonl. The table above: answer.csv. Every run: runs.csv. Confusion by solver: confusion.csv. "
      "Every "
      "pair: pairs.csv. How it was made: manifest.json.");
  documents.emplace_back("report.html", html + html_foot());
  const ComparisonTable leaderboard = leaderboard_table(data);
  documents.emplace_back("leaderboard.csv", csv_table(leaderboard.head, leaderboard.rows));
  documents.emplace_back("leaderboard.html", leaderboard_html(data));
  return documents;
}

}  // namespace accdec
