#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/comparison/comparison_run.hpp>
#include <accdec/comparison/suite_keys.hpp>
#include <accdec/formats/task_edit.hpp>
#include <accdec/solver.hpp>

namespace accdec {
namespace {

Key number(std::string name, std::string meaning, std::string unit, double high, std::string fallback,
           std::string example) {
  return {.name = std::move(name),
          .meaning = std::move(meaning),
          .unit = std::move(unit),
          .range = {0.0, high, true},
          .fallback = std::move(fallback),
          .example = std::move(example)};
}
Key integer(std::string name, std::string meaning, Range range, std::string fallback, std::string example) {
  return {.name = std::move(name),
          .type = KeyType::integer,
          .meaning = std::move(meaning),
          .range = range,
          .fallback = std::move(fallback),
          .example = std::move(example)};
}
Key names(std::string name, std::string meaning, std::vector<std::string> words, std::string noun,
          std::string example) {
  return {.name = std::move(name),
          .type = KeyType::words,
          .meaning = std::move(meaning),
          .words = std::move(words),
          .noun = std::move(noun),
          .example = std::move(example)};
}
Key word(std::string name, std::string meaning, std::vector<std::string> words, std::string fallback,
         std::string example) {
  Key key = names(std::move(name), std::move(meaning), std::move(words), "", std::move(example));
  key.type = KeyType::word;
  key.fallback = std::move(fallback);
  return key;
}
Key free_table(std::string name, std::string meaning, std::string example) {
  Key key = text_key(std::move(name), std::move(meaning), "", std::move(example));
  key.type = KeyType::table;
  key.free = true;
  return key;
}

Key sizes(std::string fallback) {
  return {.name = "sizes",
          .type = KeyType::numbers,
          .meaning = "factors by which each problem is sampled finer than written",
          .range = {1.0, 1000.0},
          .most = 20,
          .fallback = std::move(fallback),
          .example = "[1, 2, 4]",
          .whole = true};
}

std::vector<Key> setting_keys() {
  const comparison::ComparisonSettings s;
  const auto text_of = [](double x) { return fmt::format("{}", x); };
  Key targets{.name = "targets",
              .type = KeyType::numbers,
              .meaning = "accuracies of the data profiles and runtime distributions",
              .range = {0.0, 1e6, true},
              .most = 8,
              .fallback = fmt::format("[{}]", fmt::join(s.targets, ", ")),
              .example = "[1e-1, 1e-2]"};
  return {
      integer("starts", "starting points: a trapezoid and seeded perturbations of it", {1, 1000}, text_of(s.starts),
              "2"),
      integer("seed", "seed of the perturbations and of the order of runs", {0, 2e9},
              text_of(static_cast<double>(s.seed)), "7"),
      integer("repeats", "number of timings of each run", {1, 1000}, text_of(s.repeats), "9"),
      number("time_limit_s", "time limit of a run", "s", 1e6, text_of(s.time_limit), "1"),
      number("kill_after_s", "time after which the process of a run is killed", "s", 1e7, "2 time_limit_s + 1", "10"),
      integer("evaluation_limit", "largest number of evaluations in a run", {1, 2e9},
              fmt::format("{}", s.evaluation_limit), "100000"),
      number("tolerance", "tolerance set in the libraries", "", 1.0, text_of(s.tolerance), "1e-9"),
      number("feasibility", "accepted violation of a row scaled to 1", "", 1.0, text_of(s.feasibility), "1e-6"),
      number("accuracy", "relative distance within which the reference counts as reached", "", 1.0, text_of(s.accuracy),
             "1e-3"),
      targets,
      number("reference_time_limit_s", "time limit of the exact method for a reference", "s", 1e6,
             text_of(s.reference_time_limit), "60"),
      sizes("[1]")};
}

std::vector<std::string> questions() {
  std::vector<std::string> names;
  for (const auto question : {comparison::Question::margin, comparison::Question::delay, comparison::Question::design})
    names.emplace_back(comparison::to_string(question));
  return names;
}

std::vector<Key> problem_keys() {
  Key set = free_table("set", "keys of the task to change", "{ \"corner.*.error_max_um\" = 60 }");
  set.conditions = fmt::format(R"({{"propertyNames": {{"pattern": {}}}}})", task_key_pattern());
  Key delays{.name = "delay_samples",
             .type = KeyType::numbers,
             .meaning = "delays of margin, and where delay imposes limits: one number, or one a corner",
             .unit = "samples",
             .range = {0.0, most_taps},
             .most = 10'000,
             .fallback = "chosen",
             .example = "12",
             .whole = true,
             .lone = true};
  Key order = integer("order", "order N at size 1", {1, most_taps}, "", "30");
  order.unit = "taps less 1";
  return {required(text_key("name", "name of the problem", "", "\"flat corner\"")),
          text_key("family", "group of problems in tables", "other", "\"convex\""),
          required(text_key("task", "task file, relative to the suite", "", "\"../corner/flat-angle.toml\"")),
          set,
          required(names("formulation",
                         "`margin`: least corner error at `delay_samples`; `delay`: least weighted delay, continuous; "
                         "`design`: whole delays and taps",
                         questions(), "formulation", "[\"margin\", \"delay\"]")),
          required(order),
          sizes("those of the suite"),
          delays,
          number("time_limit_s", "time limit of a run of this problem", "s", 1e6, "that of the suite", "10"),
          word("expected", "whether there is an answer", {"feasible", "infeasible", "unknown"}, "feasible",
               "\"infeasible\"")};
}

std::vector<Key> hypercube_keys() {
  Key ranges = required(free_table("ranges",
                                   "the least and the largest value of keys of the task; those of `corner.*` "
                                   "are drawn for each corner by itself",
                                   "{ \"corner.*.angle_deg\" = [20, 170] }"));
  ranges.conditions = fmt::format(R"({{"propertyNames": {{"pattern": {}}}, "additionalProperties": {{"type": "array", )"
                                  R"("items": {{"type": "number"}}, "minItems": 2, "maxItems": 2}}}})",
                                  task_key_pattern());
  const auto pair = [](std::string name, std::string meaning, Range range, std::string fallback, std::string example) {
    return Key{.name = std::move(name),
               .type = KeyType::numbers,
               .meaning = std::move(meaning),
               .range = range,
               .most = 2,
               .fallback = std::move(fallback),
               .example = std::move(example),
               .lone = true};
  };
  Key corners = pair("corners", "the least and the largest number of corners, each a copy of the task's only one",
                     {1, 100}, "those of the task", "[1, 12]");
  corners.whole = true;
  return {required(text_key("name", "name of the problems, followed by a number", "", "\"jerk\"")),
          text_key("family", "group of problems in tables", "its name", "\"convex\""),
          required(text_key("task", "task file, relative to the suite", "", "\"../corner/power.toml\"")),
          required(integer("count", "number of problems", {1, 10'000}, "", "50")),
          integer("seed", "seed of the hypercube", {0, 2e9}, "1", "7"),
          ranges,
          corners,
          pair("order_factor",
               "order N over a simple estimate of the least one: the fastest start, a ramp of the acceleration where "
               "jerk is limited, and half a period of the slowest mode",
               {0.1, 100}, "[1.2, 2]", "[1, 3]"),
          required(names("formulation", "as of a problem; `margin` needs delays, and none are drawn",
                         {std::string(to_string(comparison::Question::delay)),
                          std::string(to_string(comparison::Question::design))},
                         "formulation of a hypercube", "\"design\"")),
          number("time_limit_s", "time limit of a run of these problems", "s", 1e6, "that of the suite", "10"),
          word("expected", "whether they have an answer", {"feasible", "infeasible", "unknown"}, "unknown",
               "\"feasible\"")};
}

std::vector<Key> variant_keys() {
  Key solver = required(word("solver", "solver that the options belong to", solver_names(), "", "\"ipopt\""));
  solver.noun = "solver";
  solver.allowed = "allowed is a name of `accdec solvers`";
  return {required(text_key("name", "name in tables and figures", "", "\"ipopt, monotone\"")), solver,
          word("form", "positions as rows or substituted into their bounds", {"sparse", "reduced"},
               "what `reduced` says", "\"reduced\""),
          free_table("options", "options by the library's own names", "{ mu_strategy = \"monotone\" }")};
}

std::vector<Key> external_keys() {
  Key memory = integer("memory_max_MB", "memory that each of its processes may have, counted as addresses", {1, 1e7},
                       "no limit", "4000");
  memory.unit = "MB";
  return {
      required(text_key("name", "name in tables and figures", "", "\"my solver\"")),
      required(text_key("command",
                        "program and arguments, without a shell, so that redirections are refused outside of quotes; "
                        "quotes keep spaces; {nl}, {mps}, {cbf} or {dat-s} (the problem), {answer}, "
                        "{seconds} and {suite} (its folder) are replaced; other braces are doubled; OMP_NUM_THREADS "
                        "and OPENBLAS_NUM_THREADS are 1 unless they are set",
                        "", "\"couenne {nl} -AMPL\"")),
      word("reads",
           "format of the problem, as in `accdec instances`; `mps` holds whole designs only, the others every problem "
           "that they can",
           {"nl", "mps", "cbf", "dat-s"}, "nl", "\"mps\""),
      word(
          "answer",
          "`sol`: AMPL's solution file; `values`: a line with a claim (solved, acceptable, infeasible, unbounded, "
          "failed, "
          "time limit), then a number for each variable; `names`: lines with a variable's name in the file (X1, X2, .. "
          "in MPS) and its value, others are 0, the claim by words like \"optimal\" and \"infeasible\"; where "
          "`command` "
          "has no {answer}, `sol` is the file beside {nl} and the others are what the program prints on standard "
          "output",
          {"sol", "values", "names"}, "sol", "\"names\""),
      memory};
}

FileKind make_suite_file() {
  std::vector<std::string> entries = solver_names_with_forms();
  entries.emplace_back("all");
  Key notes = text_key("notes", "text below the title of the report", "", "\"Every algorithm.\"");
  notes.empty_text = notes.long_text = true;
  FileKind file{.name = "suite", .title = "accdec suite"};
  Key solvers = names("solvers", "solvers that take part; may be left out if there are other entries", entries,
                      "solver", "[\"ipopt\", \"nlopt-slsqp/reduced\"]");
  solvers.allowed = "allowed are `all`, or names of `accdec solvers`, NAME/sparse and NAME/reduced, and `exact`";
  Key reduced = names("reduced", "solvers that get the reduced form although they accept equality rows", solver_names(),
                      "solver", "[\"nlopt-cobyla\"]");
  reduced.allowed = "allowed are names of `accdec solvers`";
  file.keys = {text_key("title", "title of the report", "the file's name", "\"Solvers compared\""), notes, solvers};
  for (Key& key : setting_keys()) file.keys.push_back(std::move(key));
  file.keys.push_back(reduced);
  file.keys.push_back(tables_key("variant", "a further entry: a solver with options of its own", variant_keys()));
  file.keys.push_back(
      tables_key("external", "a further entry: a program that reads problems from files", external_keys()));
  file.keys.push_back(tables_key("problem", "a task and what is asked of it", problem_keys()));
  file.keys.push_back(tables_key("hypercube", "problems drawn at random, as a Latin hypercube", hypercube_keys()));
  file.conditions =
      R"({"allOf": [{"anyOf": [{"required": ["solvers"]}, {"required": ["variant"]}, {"required": ["external"]}]},)"
      R"( {"anyOf": [{"required": ["problem"]}, {"required": ["hypercube"]}]}]})";
  return file;
}

}  // namespace

std::vector<std::string> solver_names() {
  std::vector<std::string> names;
  for (const auto& solver : solvers::registry()) names.push_back(solver->name());
  return names;
}

std::vector<std::string> solver_names_with_forms() {
  std::vector<std::string> names = solver_names();
  names.emplace_back(comparison::exact_name);
  for (const auto& solver : solvers::registry()) {
    if (!comparison::takes_both_forms(*solver)) continue;
    for (const char* form : {"/sparse", "/reduced"}) names.push_back(solver->name() + form);
  }
  return names;
}

const FileKind& suite_file() {
  static const FileKind file = make_suite_file();
  return file;
}

}  // namespace accdec
