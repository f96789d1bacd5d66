#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include <accdec/comparison/comparison_report.hpp>
#include <accdec/plot/html.hpp>

namespace accdec {
namespace {

using comparison::Attempt;
using comparison::ComparedCase;
using comparison::ComparisonData;

struct Share {
  std::size_t reached = 0, of = 0;
  double percent() const { return of > 0 ? 100.0 * static_cast<double>(reached) / static_cast<double>(of) : 0.0; }
};

/// The line of one solver.
struct Standing {
  std::string solver, library;
  Share all, infeasible;
  std::map<std::string, Share> by_difficulty;
  std::vector<double> times;  ///< s to the end, where the optimum was reached
  std::size_t claims = 0, wrong = 0, worse = 0, denied = 0, refused = 0, stopped = 0, failed = 0;

  void add(const ComparedCase& c, const Attempt& a) {
    const bool claimed = comparison::claims_solution(a) || a.claim == "infeasible" || a.claim == "unbounded";
    const bool late = a.claim == comparison::claim_killed || a.claim == "time limit";
    ++(!a.accepted ? refused : late ? stopped : claimed ? claims : failed);
    if (comparison::wrong_claim(c, a)) ++wrong;
    if (c.infeasible) {
      ++infeasible.of;
      infeasible.reached += a.success ? 1 : 0;
      return;
    }
    if (comparison::denies_solution(c, a)) ++denied;
    if (c.proof != "proved") return;
    for (Share* share : {&all, &by_difficulty[comparison::difficulty_of(c)]}) {
      ++share->of;
      share->reached += a.success ? 1 : 0;
    }
    if (a.success) times.push_back(a.time.median);
    if (comparison::claims_solution(a) && !a.success && std::isfinite(a.gap)) ++worse;
  }
};

/// The most optima first; among equals, the fastest first.
std::vector<Standing> standings_of(const ComparisonData& data) {
  std::vector<Standing> standings;
  for (std::size_t s = 0; s < data.solvers.size(); ++s) {
    Standing one;
    one.solver = data.solvers[s];
    one.library = data.header.at("solvers")[s].value("library", "");
    for (std::size_t c = 0; c < data.cases.size(); ++c) {
      for (int start = 0; start < data.starts; ++start) one.add(data.cases[c], data.attempt(c, start, s));
    }
    standings.push_back(std::move(one));
  }
  std::stable_sort(standings.begin(), standings.end(), [](const Standing& a, const Standing& b) {
    if (a.all.reached != b.all.reached) return a.all.reached > b.all.reached;
    return comparison::quartiles(a.times).median < comparison::quartiles(b.times).median;
  });
  return standings;
}

/// Difficulties of the problems with a proved optimum, with their numbers of problems.
std::vector<std::pair<std::string, std::size_t>> classes_of(const ComparisonData& data) {
  std::map<std::string, std::size_t> count;
  for (const ComparedCase& c : data.cases) {
    if (c.proof == "proved") ++count[comparison::difficulty_of(c)];
  }
  std::vector<std::pair<std::string, std::size_t>> classes;
  for (const char* difficulty : comparison::difficulties) {
    if (count.contains(difficulty)) classes.emplace_back(difficulty, count[difficulty]);
  }
  return classes;
}

std::string counts_text(const ComparisonData& data) {
  std::size_t proved = 0, infeasible = 0;
  for (const ComparedCase& c : data.cases) {
    proved += c.proof == "proved" ? 1 : 0;
    infeasible += c.infeasible ? 1 : 0;
  }
  std::string text = fmt::format("{} problems: {} with a proved optimum, {} proved to have no answer, {} open.",
                                 data.cases.size(), proved, infeasible, data.cases.size() - proved - infeasible);
  std::string classes;
  for (const auto& [name, count] : classes_of(data))
    classes += fmt::format("{}{} {}", classes.empty() ? "" : ", ", count, name);
  if (!classes.empty())
    text += fmt::format(
        " By the linear programs that the exact method needs for its proof (easy to 10, medium to 100, hard to 1000, "
        "very hard above): {}.",
        classes);
  return text + " A click on a heading sorts.";
}

constexpr const char* own_solver = R"([[external]]
name = "my solver"
command = "my-solver {nl} -AMPL"   # or {mps}, {cbf}, {dat-s}; {answer}, {seconds} and {suite} are replaced, too
reads = "nl"                       # the problem as AMPL's .nl, free MPS, CBF or sparse SDPA
answer = "sol"                     # AMPL's .sol; "names": lines with a name and a value; "values": a claim and all numbers
)";

std::string fairness_html(const ComparisonData& data) {
  const batch::Row& h = data.header;
  std::string text = html_paragraph(fmt::format(
      "Each run is a process of its own with {:g} s; {} starts, {} repeats. An optimum is reached if a verified answer "
      "is within {:g} of it, relative to the larger of 1 and the optimum. The time is that until the solver ended, by "
      "the wall clock, of the runs that reached it. Wrong claims are solutions that break a limit or cannot exist, "
      "\"infeasible\" where a solution is known, and any \"unbounded\". They count after the time limit, too.",
      h.value("time_limit_s", 0.0), data.starts, data.repeats, data.accuracy));
  text += html_paragraph(
      "Designs: solvers without whole variables search with rounding and repair around them. Solvers with whole "
      "variables get one problem with big-M rows. Taps that break a limit by a tolerance (0.01 %), or by the tangents "
      "of an MPS file (0.13 %), are replaced by others at the same delays. By more, the answer is refused. Margins: "
      "the "
      "`sigma` is recomputed from the taps, so that one too small by a tolerance (0.01 %) breaks nothing. The exact "
      "method is made for these problems, and the difficulty is counted in its own steps: neither is neutral.");
  text += html_paragraph(
      "Options are those of the suite, or the libraries' own, as below. They were not tuned for each solver alike. "
      "Solvers of the registry begin at a trapezoid, and at seeded changes of it if there are more starts. Programs "
      "get "
      "the same start in an .nl file, and none in the others. They count their own start, reading and writing. They "
      "are killed "
      "at kill_after_s, so that they can write what they have at the time limit. Solvers "
      "not listed here were not tried.");
  if (const std::string notes = h.value("notes", ""); !notes.empty()) text += html_paragraph(notes);
  if (data.session.contains("machine")) {
    const batch::Row& machine = data.session["machine"];
    text += html_paragraph(fmt::format("Machine: {}, {} cores, {} workers at a time.", machine.value("processor", "?"),
                                       machine.value("cores", 0), data.session.value("workers", 0)));
  }
  return text + solvers_html(data);
}

}  // namespace

ComparisonTable leaderboard_table(const ComparisonData& data) {
  ComparisonTable table{"leaderboard", {"solver", "library", "optima reached / %", "reached", "of"}, {}};
  const auto classes = classes_of(data);
  for (const auto& [name, count] : classes) table.head.push_back(name + " / %");
  for (const char* head : {"median time / s", "upper quartile / s", "infeasibility recognised", "wrong claims",
                           "claimed solved, but worse", "claimed infeasible, but is not", "claims", "out of time",
                           "refused", "without a claim"})
    table.head.emplace_back(head);
  for (const Standing& s : standings_of(data)) {
    std::vector<std::string> row{s.solver, s.library, fmt::format("{:.1f}", s.all.percent()),
                                 std::to_string(s.all.reached), std::to_string(s.all.of)};
    for (const auto& [name, count] : classes) {
      const auto share = s.by_difficulty.find(name);
      row.push_back(share == s.by_difficulty.end() ? "" : fmt::format("{:.1f}", share->second.percent()));
    }
    const comparison::Quartiles time = comparison::quartiles(s.times);
    for (const double t : {time.median, time.upper}) row.push_back(std::isfinite(t) ? fmt::format("{:.3g}", t) : "");
    for (const std::size_t n :
         {s.infeasible.reached, s.wrong, s.worse, s.denied, s.claims, s.stopped, s.refused, s.failed})
      row.push_back(std::to_string(n));
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::string leaderboard_html(const ComparisonData& data) {
  const ComparisonTable table = leaderboard_table(data);
  std::string html = html_head("Leaderboard: " + data.header.value("title", "Comparison"));
  html += html_paragraph(counts_text(data)) + html_table({table.head, table.rows, "leaderboard", true});
  html += "<h2>Fairness</h2>\n" + fairness_html(data);
  html += "<h2>How to join</h2>\n" +
          html_paragraph(
              "Add these lines to the suite and run accdec compare again with the same --out: only the new "
              "solver runs, and nothing has to be built. accdec instances writes the same problems as files.");
  html += fmt::format("<pre>{}</pre>\n", html_escaped(own_solver));
  return html + html_foot();
}

}  // namespace accdec
