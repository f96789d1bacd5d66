#include <algorithm>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/family.hpp>
#include <accdec/formats/toml_file.hpp>
#include <accdec/study/point_columns.hpp>
#include <accdec/study/study_folder.hpp>
#include <accdec/study/study_keys.hpp>
#include <accdec/study/study_parts.hpp>
#include <accdec/study/study_tasks.hpp>

namespace accdec {

using toml_input::Table;

/// Reads one study file; a class for the state its parts share.
class StudyReader {
 public:
  explicit StudyReader(const std::string& path) : tree_(toml_input::parse_file(path, InputKind::study)) {
    places_.path = path;
  }

  Study read() {
    toml_input::check_keys(tree_, places_.path, top_name, "", study_file().keys).raise();
    const Table top(tree_, places_.path, top_name, "", study_file().keys);
    Study study;
    study.path = places_.path;
    study.title = top.text("title").value_or(study.path);
    study.notes = top.text("notes").value_or("");
    read_methods(top, study);
    auto tasks = std::make_shared<Study::Tasks>();
    read_cases(top, *tasks);
    read_variations(top, *tasks);
    check_filters(top, study, *tasks);
    make_plan(top, study);
    study.tasks_ = tasks;
    check_names(top, study);
    read_ratios(top, study);
    study.hash_ = hash(study, *tasks);
    read_figures(top, study, grid_);
    check_points(study, *tasks, places_);
    return study;
  }

 private:
  static constexpr const char* top_name = "the study (top level)";

  static void read_methods(const Table& top, Study& study) {
    for (const std::string& name : top.texts("compute")) {
      std::vector<std::string> wanted{name};
      if (name == "shapes") {
        wanted.clear();
        for (const Family& family : families()) wanted.emplace_back(family.name);
      }
      for (std::string& w : wanted) {
        if (std::find(study.computations.begin(), study.computations.end(), w) == study.computations.end())
          study.computations.push_back(std::move(w));
      }
    }
    study.design.method = top.word("method") == "nlp" ? Method::nlp : Method::exact;
    study.design.nlp.solver = top.word("solver");
    study.design.time_limit = top.required_number("time_limit_s");
    study.design.exact.certificate = false;
    // A design may call Ipopt, whose linear solver keeps static state; everything else here is safe in threads.
    const bool designs =
        std::find(study.computations.begin(), study.computations.end(), "optimum") != study.computations.end();
    const bool processes = top.has("isolation") ? top.word("isolation") == "processes" : designs;
    study.isolation = processes ? batch::Isolation::processes : batch::Isolation::threads;
  }

  /// Computations of a given filter need one in at least one case: in its task, its `set` or a variation.
  static void check_filters(const Table& top, const Study& study, const Study::Tasks& tasks) {
    if (std::any_of(tasks.cases.begin(), tasks.cases.end(),
                    [](const auto& source) { return source.tree.contains("filter"); }))
      return;
    for (const std::string& name : study.computations) {
      if (!study::needs_filter(name)) continue;
      top.fail_at(
          "compute",
          fmt::format("`{}` is of a given filter, and {} has no [filter]; add one there, or by the `set` of a case",
                      name, tasks.cases.size() == 1 ? tasks.cases.front().path : "no case"));
    }
  }

  static Study::Tasks::Source load(const Table& table, const std::string& given) {
    Study::Tasks::Source source;
    source.tree = toml_input::parse_task_beside(table, "task", given, source.path);
    return source;
  }

  void read_cases(const Table& top, Study::Tasks& tasks) {
    const auto base = top.text("task");
    std::vector<std::string>& names = places_.names;
    for (const Table& table : top.tables("case")) {
      const auto name = *table.text("name");
      if (std::find(names.begin(), names.end(), name) != names.end())
        table.fail_at("name", fmt::format("the name \"{}\" is taken already", name));
      const auto own = table.text("task");
      if (!own && !base) table.fail("[[case]] needs a `task`, for the study has none");
      tasks.cases.push_back(own ? load(table, *own) : load(top, *base));
      places_.settings.push_back(table.raw().source().begin);
      if (const toml::table* set = table.raw()["set"].as_table()) {
        toml_input::apply_settings(*set, places_.path, tasks.cases.back().tree);
        places_.settings.back() = set->source().begin;
      }
      places_.bases.push_back(tasks.cases.back().tree);
      names.push_back(name);
    }
    if (!names.empty()) return;
    if (!base) top.fail("the study needs a base `task`, or [[case]] tables with one each");
    tasks.cases.push_back(load(top, *base));
    places_.bases.push_back(tasks.cases.back().tree);
    places_.settings.emplace_back();
    names.emplace_back("");
  }

  static void read_values(const Table& table, study::Variation& v) {
    if (table.has("values") == table.has("range")) table.fail("[[vary]] needs either `values` or `range`");
    if (table.has("values")) {
      v.values = table.numbers("values");
      if (v.values.empty())
        table.fail_at("values", fmt::format("`values` of {} is empty; a study needs at least one value", v.name));
      return;
    }
    const Table range = *table.table("range");
    v.range = true;
    v.logarithmic = range.boolean("log");
    try {
      v.values = study::spread(range.required_number("from"), range.required_number("to"),
                               static_cast<std::size_t>(range.required_integer("count")), v.logarithmic);
    } catch (const std::invalid_argument& error) {
      table.fail_at("range", error.what());
    }
  }

  void read_variations(const Table& top, Study::Tasks& tasks) {
    for (const Table& table : top.tables("vary")) {
      study::Variation v;
      v.keys = table.texts("key");
      v.name = table.text("name").value_or(v.keys.front());
      read_values(table, v);
      set_first(table, v, tasks);
      for (std::size_t before = 0; before < places_.variations.size(); ++before) {
        const study::Variation& other = places_.variations[before];
        if (other.name == v.name)
          table.fail(fmt::format("two variations are named `{}`; give one of them another `name`", v.name));
        if (collide(tasks, before))
          table.fail_at(
              "key", fmt::format("`{}` is set by the variation `{}` already", fmt::join(v.keys, "`, `"), other.name));
      }
      places_.keys.push_back(table.raw().get("key")->source().begin);
      places_.variations.push_back(std::move(v));
    }
  }

  /// Finds the keys of a variation and sets its first value in every case, so that later ones find what it makes.
  static void set_first(const Table& table, const study::Variation& v, Study::Tasks& tasks) {
    tasks.keys.emplace_back();
    for (const std::string& key : v.keys) {
      try {
        tasks.keys.back().emplace_back(key);
        for (Study::Tasks::Source& source : tasks.cases) tasks.keys.back().back().set(source.tree, v.values.front());
      } catch (const std::invalid_argument& error) {
        table.fail_at("key", error.what());
      }
    }
  }

  /// Whether an earlier variation and the last one set the same key in any case: then their order matters.
  static bool collide(const Study::Tasks& tasks, std::size_t before) {
    const auto set = [](toml::table& tree, const std::vector<TaskKey>& keys, double value) {
      for (const TaskKey& key : keys) key.set(tree, value);
    };
    return std::any_of(tasks.cases.begin(), tasks.cases.end(), [&](const Study::Tasks::Source& source) {
      toml::table one = source.tree, other = source.tree;
      set(one, tasks.keys[before], 1.0), set(one, tasks.keys.back(), 2.0);
      set(other, tasks.keys.back(), 2.0), set(other, tasks.keys[before], 1.0);
      return one != other;
    });
  }

  /// A name that a column has already would hide its values.
  void check_names(const Table& top, const Study& study) const {
    std::vector<std::string> columns = study.columns();
    std::sort(columns.begin(), columns.end());
    const auto twice = std::adjacent_find(columns.begin(), columns.end());
    if (twice != columns.end())
      top.fail(fmt::format("no variation can be named `{}`: the table has a column of that name", *twice));
  }

  void make_plan(const Table& top, Study& study) {
    const bool grid = top.word("sampling") == "grid";
    for (const std::string_view key : {"samples", "seed"}) {
      if (grid && top.has(key)) top.fail_at(key, fmt::format("`{}` goes with sampling = \"latin-hypercube\"", key));
    }
    const int samples = grid ? 0 : top.required_integer("samples");
    const int seed = top.required_integer("seed");
    if (!grid && places_.variations.empty()) top.fail("a Latin hypercube needs at least one [[vary]]");
    try {
      study.points_ = std::make_shared<study::PointSet>(
          places_.names, places_.variations, grid ? study::Sampling::grid : study::Sampling::latin_hypercube,
          static_cast<std::size_t>(samples), static_cast<std::uint64_t>(seed));
    } catch (const std::invalid_argument& error) {
      top.fail(error.what());
    }
    grid_ = grid;
    sampling_ = fmt::format("{} {} {}", grid, samples, seed);
    study.origin = origin_of_size(grid);
    // Before anything looks at every value.
    check_study_size(study, true);
  }

  Study::Origin origin_of_size(bool grid) const {
    const auto at = [](std::string what, const toml::node& node) {
      const auto begin = node.source().begin;
      return Study::Origin{std::move(what), static_cast<long>(begin.line), static_cast<long>(begin.column)};
    };
    if (!grid) return at("`samples`", *tree_.get("samples"));
    const auto most = std::max_element(places_.variations.begin(), places_.variations.end(),
                                       [](const auto& a, const auto& b) { return a.values.size() < b.values.size(); });
    if (most == places_.variations.end() || most->values.size() < places_.names.size()) {
      const toml::node* cases = tree_.get("case");
      return cases ? at("the cases", *cases) : Study::Origin{};
    }
    const toml::table& vary =
        *tree_["vary"].as_array()->get(static_cast<std::size_t>(most - places_.variations.begin()))->as_table();
    return at(fmt::format("the {} values of `{}`", most->values.size(), most->name),
              *vary.get(vary.contains("values") ? "values" : "range"));
  }

  static void read_ratios(const Table& top, Study& study) {
    for (const Table& table : top.tables("ratio")) {
      StudyRatio r{*table.text("name"), *table.text("of"), *table.text("to"), table.boolean("excess")};
      const auto columns = study.columns();
      if (std::find(columns.begin(), columns.end(), r.name) != columns.end())
        table.fail_at("name", fmt::format("there is a column `{}` already", r.name));
      check_column(table, "of", r.of, study);
      check_column(table, "to", r.to, study);
      study.ratios.push_back(std::move(r));
    }
  }

  /// Long lists of values are written as the range that makes them.
  static std::string values_text(const study::Variation& v) {
    constexpr std::size_t written = 100'000;
    if (!v.range || v.values.size() <= written) return fmt::format("{}", fmt::join(v.values, " "));
    return fmt::format("{} .. {}, {}", v.values.front(), v.values.back(), v.values.size());
  }

  std::string hash(const Study& study, const Study::Tasks& tasks) const {
    std::ostringstream text;
    text << sampling_ << '\n'
         << fmt::format("{}\n{} {} {}\n", fmt::join(study.computations, " "), static_cast<int>(study.design.method),
                        study.design.nlp.solver, study.design.time_limit);
    for (std::size_t c = 0; c < places_.names.size(); ++c)
      text << places_.names[c] << '\n' << tasks.cases[c].tree << '\n';
    for (const auto& v : places_.variations)
      text << fmt::format("{} {} {} {} {}\n", v.name, fmt::join(v.keys, " "), values_text(v), v.range, v.logarithmic);
    for (const auto& r : study.ratios) text << fmt::format("{} {} {} {}\n", r.name, r.of, r.to, r.excess);
    return toml_input::hash_of(text.str());
  }

  toml::table tree_;
  StudyPlaces places_;
  std::string sampling_;
  bool grid_ = true;
};

Study read_study(const std::string& path) {
  return StudyReader(path).read();
}

}  // namespace accdec
