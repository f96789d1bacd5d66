#include <fmt/format.h>

#include <accdec/design.hpp>
#include <accdec/formats/task_edit.hpp>
#include <accdec/solver.hpp>
#include <accdec/study/point_columns.hpp>
#include <accdec/study/study_keys.hpp>

namespace accdec {
namespace {

constexpr double most_points = 1e7, most = 1e300;

Key number(std::string name, std::string meaning) {
  return {.name = std::move(name),
          .meaning = std::move(meaning),
          .range = {-most, most},
          .example = "10",
          .required = true};
}
Key boolean(std::string name, std::string meaning) {
  return {.name = std::move(name),
          .type = KeyType::boolean,
          .meaning = std::move(meaning),
          .fallback = "false",
          .example = "true"};
}
Key word(std::string name, std::string meaning, std::vector<std::string> words, std::string fallback) {
  Key key{.name = std::move(name), .type = KeyType::word, .meaning = std::move(meaning)};
  key.example = fmt::format("\"{}\"", words.back());
  key.words = std::move(words);
  key.fallback = std::move(fallback);
  return key;
}
Key texts(std::string name, std::string meaning, std::string fallback, std::string example) {
  Key key = text_key(std::move(name), std::move(meaning), std::move(fallback), std::move(example));
  key.type = KeyType::texts;
  return key;
}
Key free_table(std::string name, std::string meaning, std::string example) {
  return {.name = std::move(name),
          .type = KeyType::table,
          .meaning = std::move(meaning),
          .example = std::move(example),
          .free = true};
}

std::vector<Key> method_keys() {
  std::vector<std::string> computations, solver_names;
  for (const std::string_view name : study::computations()) computations.emplace_back(name);
  computations.insert(computations.begin() + 1, "shapes");
  for (const auto& solver : solvers::registry()) solver_names.push_back(solver->name());
  Key compute{.name = "compute",
              .type = KeyType::words,
              .meaning = "what to compute for each point; `shapes` stands for every family of filters",
              .words = computations,
              .noun = "computation",
              .example = "[\"optimum\", \"shapes\"]",
              .required = true};
  Key solver = word("solver", "solver of method nlp", solver_names, DesignOptions().nlp.solver);
  solver.noun = "solver";
  solver.allowed = "allowed is a name of `accdec solvers`";
  return {compute,
          word("method", "how optima are found", {"exact", "nlp"}, "exact"),
          solver,
          {.name = "time_limit_s",
           .meaning = "time limit of every optimum",
           .unit = "s",
           .range = {0.0, 1e6, true},
           .fallback = "60",
           .example = "10"},
          word("isolation", "whether points run in threads or in processes of their own", {"threads", "processes"},
               "processes if optima are computed"),
          word("sampling", "how points are chosen", {"grid", "latin-hypercube"}, "grid"),
          {.name = "samples",
           .type = KeyType::integer,
           .meaning = "number of points of a Latin hypercube; needed there",
           .range = {1, most_points},
           .example = "1000"},
          {.name = "seed",
           .type = KeyType::integer,
           .meaning = "seed of a Latin hypercube",
           .range = {0, 2e9},
           .fallback = "1",
           .example = "7"}};
}

Key case_key() {
  Key set = free_table("set", "keys of the task that the case changes", "{ \"filter.order\" = 20 }");
  set.conditions = fmt::format(R"({{"propertyNames": {{"pattern": {}}}}})", task_key_pattern());
  return tables_key(
      "case", "a task of its own, or the study's with some keys changed",
      {required(text_key("name", "name of the case in the column `case`", "", "\"heavy\"")),
       text_key("task", "task file, relative to the study", "that of the study", "\"../corner/power.toml\""), set});
}

Key vary_key() {
  Key key =
      required(texts("key", "key of the task, or several that vary together; * stands for all corners, axes or modes",
                     "", "\"corner.*.error_max_um\""));
  key.conditions = fmt::format(R"({{"pattern": {0}, "items": {{"pattern": {0}}}}})", task_key_pattern());
  Key values{.name = "values",
             .type = KeyType::numbers,
             .meaning = "the values in the unit of the key; or `range`",
             .range = {-most, most},
             .least = 0,
             .most = static_cast<std::size_t>(most_points),
             .example = "[10, 20, 50]"};
  Key range{.name = "range",
            .type = KeyType::table,
            .meaning = "values from .. to; or `values`",
            .keys = {number("from", "first value"),
                     number("to", "last value"),
                     {.name = "count",
                      .type = KeyType::integer,
                      .meaning = "how many values",
                      .range = {1, most_points},
                      .fallback = "2",
                      .example = "20"},
                     boolean("log", "equal ratios instead of equal steps")}};
  Key vary = tables_key("vary", "a quantity that varies",
                        {text_key("name", "name of its column", "the first key", "\"tolerance\""), key, values, range});
  vary.conditions = R"({"oneOf": [{"required": ["values"]}, {"required": ["range"]}]})";
  return vary;
}

Key ratio_key() {
  return tables_key("ratio", "a column that divides one column by another",
                    {required(text_key("name", "name of the column", "", "\"gain\"")),
                     required(text_key("of", "column of the numerator", "", "\"boxcar.cycle_time_ms\"")),
                     required(text_key("to", "column of the denominator", "", "\"optimum.cycle_time_ms\"")),
                     boolean("excess", "ratio minus 1")});
}

Key figure_key() {
  Key title = text_key("title", "title above the figure", "", "\"What a tolerance costs\"");
  title.empty_text = true;
  Key name = text_key("name", "name of its file: small letters, digits, - and _", "figure-1, ..", "\"pareto\"");
  name.conditions = R"({"pattern": "^[a-z0-9_-]+$"})";
  return tables_key(
      "figure", "a figure of the report",
      {name, title,
       word("kind", "`pareto`: cycle time against corner error", {"curve", "family", "heat", "pareto"}, "curve"),
       text_key("x", "column of the x axis; not for `pareto`", "", "\"corner.*.error_max_um\""),
       required(
           texts("y", "columns, one for each curve; for `pareto`, computations", "", "[\"optimum.cycle_time_ms\"]")),
       text_key("z", "heat: column of the colour", "", "\"best_shape\""),
       text_key("family", "family: column that has one curve for each value", "", "\"corner.A.angle_deg\""),
       texts("labels", "labels of the curves", "titles of the computations", "[\"optimum\", \"boxcar\"]"),
       text_key("x_label", "label of the axis", "from the column", "\"Tolerance / um\""),
       text_key("y_label", "label of the axis", "from the column", "\"Cycle time / ms\""),
       text_key("z_label", "label of the colours", "from the column", "\"Gain\""),
       boolean("log_x", "logarithmic x axis"), boolean("log_y", "logarithmic y axis"),
       free_table("where", "column = value: only these rows are drawn", "{ case = \"heavy\" }")});
}

FileKind make_study_file() {
  FileKind file{.name = "study", .title = "accdec study"};
  Key notes = text_key("notes", "text below the title of the report", "", "\"All at 6 m/min.\"");
  notes.empty_text = notes.long_text = true;
  file.keys = {text_key("title", "title of the report", "the file's name", "\"Price of smoothness\""), notes,
               text_key("task", "task file, relative to the study; or [[case]]", "", "\"../corner/power.toml\"")};
  for (Key& key : method_keys()) file.keys.push_back(std::move(key));
  for (Key key : {case_key(), vary_key(), ratio_key(), figure_key()}) file.keys.push_back(std::move(key));
  file.conditions = R"({"anyOf": [{"required": ["task"]}, {"required": ["case"]}]})";
  return file;
}

}  // namespace

const FileKind& study_file() {
  static const FileKind file = make_study_file();
  return file;
}

}  // namespace accdec
