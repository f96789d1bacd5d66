#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/design/baselines.hpp>
#include <accdec/files/suggestion.hpp>
#include <accdec/formats/task_tree.hpp>
#include <accdec/formats/toml_file.hpp>
#include <accdec/solvers/solver.hpp>
#include <accdec/study/compute.hpp>
#include <accdec/study/study_figure_check.hpp>
#include <accdec/study/study_file.hpp>
#include <accdec/study/study_tasks.hpp>

namespace accdec {

using toml_input::Table;

/// Reads one study file; a class for the state its parts share.
class StudyReader {
 public:
  explicit StudyReader(const std::string& path) : path_(path), tree_(toml_input::parse_file(path)) {}

  Study read() {
    const Table top(tree_, path_, "the study (top level)", "",
                    {"title", "notes", "task", "compute", "method", "solver", "time_limit_s", "isolation", "sampling",
                     "samples", "seed", "case", "vary", "ratio", "figure"});
    Study study;
    study.path = path_;
    study.title = top.text("title").value_or(path_);
    study.notes = top.text("notes", true, true).value_or("");
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
    read_figures(top, study);
    check_points(study);
    return study;
  }

 private:
  void read_methods(const Table& top, Study& study) {
    std::vector<std::string_view> known = study::computations();
    known.insert(known.begin() + 1, "shapes");
    if (!top.has("compute"))
      top.fail("the study needs `compute`: a list of what to compute for each point, of " +
               fmt::format("{}", fmt::join(known, ", ")));
    for (const std::string& name : toml_input::strings(top, tree_, "compute")) {
      if (std::find(known.begin(), known.end(), name) == known.end())
        top.fail_at("compute", fmt::format("unknown computation `{}`; {}", name, suggest(name, known)));
      std::vector<std::string> wanted{name};
      if (name == "shapes") {
        wanted.clear();
        for (const Baseline& family : baselines()) wanted.emplace_back(family.name);
      }
      for (std::string& w : wanted) {
        if (std::find(study.computations.begin(), study.computations.end(), w) == study.computations.end())
          study.computations.push_back(std::move(w));
      }
    }
    constexpr std::string_view methods[] = {"exact", "nlp"}, isolations[] = {"threads", "processes"};
    const bool nlp = top.word("method", methods).value_or("exact") == "nlp";
    study.design.method = nlp ? Method::nlp : Method::exact;
    study.design.solver = read_solver(top).value_or(study.design.solver);
    study.design.time_limit = top.number("time_limit_s", {0.0, 1e6, true}).value_or(60.0);
    study.design.certificate = false;
    // A design may call Ipopt, whose linear solver keeps static state; everything else here is safe in threads.
    const bool designs =
        std::find(study.computations.begin(), study.computations.end(), "optimum") != study.computations.end();
    const std::string isolation = top.word("isolation", isolations).value_or(designs ? "processes" : "threads");
    study.isolation = isolation == "threads" ? study::Isolation::threads : study::Isolation::processes;
  }

  static std::optional<std::string> read_solver(const Table& top) {
    auto given = top.text("solver");
    if (!given) return given;
    std::vector<std::string> names;
    for (const auto& solver : solvers::registry()) names.push_back(solver->name());
    if (std::find(names.begin(), names.end(), *given) != names.end()) return given;
    const std::string near = nearest(*given, std::vector<std::string_view>(names.begin(), names.end()));
    top.fail_at("solver",
                fmt::format("unknown solver `{}`; {}known are {}", *given,
                            near.empty() ? "" : fmt::format("did you mean `{}`? ", near), fmt::join(names, ", ")));
  }

  /// Computations of a given filter need one in at least one case, by its task, its `set` or a variation.
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
    for (const toml::table* raw : top.tables("case")) {
      const Table table(*raw, path_, fmt::format("[[case]] {}", names_.size() + 1),
                        fmt::format("/case/{}", names_.size()), {"name", "task", "set"});
      const auto name = table.text("name");
      if (!name) table.fail("[[case]] needs a `name`");
      if (std::find(names_.begin(), names_.end(), *name) != names_.end())
        table.fail_at("name", fmt::format("the name \"{}\" is taken already", *name));
      const auto own = table.text("task");
      if (!own && !base) table.fail("[[case]] needs a `task`, for the study has none");
      tasks.cases.push_back(own ? load(table, *own) : load(top, *base));
      settings_.push_back(raw->source().begin);
      if (const toml::table* set = table.table("set")) {
        toml_input::apply_settings(*set, path_, tasks.cases.back().tree);
        settings_.back() = set->source().begin;
      }
      bases_.push_back(tasks.cases.back().tree);
      names_.push_back(*name);
    }
    if (!names_.empty()) return;
    if (!base) top.fail("the study needs a base `task`, or [[case]] tables with one each");
    tasks.cases.push_back(load(top, *base));
    bases_.push_back(tasks.cases.back().tree);
    settings_.emplace_back();
    names_.emplace_back("");
  }

  void read_variations(const Table& top, Study::Tasks& tasks) {
    for (const toml::table* raw : top.tables("vary")) {
      const std::size_t i = variations_.size();
      const Table table(*raw, path_, fmt::format("[[vary]] {}", i + 1), fmt::format("/vary/{}", i),
                        {"name", "key", "values", "range"});
      study::Variation v;
      v.keys = toml_input::strings(table, *raw, "key");
      if (v.keys.empty()) table.fail("[[vary]] needs a `key`, or a list of keys that vary together");
      places_.push_back(raw->get("key")->source().begin);
      v.name = table.text("name").value_or(v.keys.front());
      if (table.has("values") == table.has("range")) table.fail("[[vary]] needs either `values` or `range`");
      constexpr double most = 1e300;
      if (table.has("values")) {
        v.values = *table.numbers("values", {-most, most}, 0, 10'000'000);
        if (v.values.empty())
          table.fail_at("values", fmt::format("`values` of {} is empty; a study needs at least one value", v.name));
      } else {
        const toml::table* inner = table.table("range");
        const Table range(*inner, path_, "range", fmt::format("/vary/{}/range", i), {"from", "to", "count", "log"});
        v.range = true;
        v.logarithmic = range.boolean("log").value_or(false);
        try {
          v.values =
              study::spread(range.required_number("from", {-most, most}), range.required_number("to", {-most, most}),
                            static_cast<std::size_t>(range.integer("count", 1, 10'000'000).value_or(2)), v.logarithmic);
        } catch (const std::invalid_argument& error) {
          table.fail_at("range", error.what());
        }
      }
      tasks.keys.emplace_back();
      for (const std::string& key : v.keys) {
        try {
          tasks.keys.back().emplace_back(key);
          for (Study::Tasks::Source& source : tasks.cases) tasks.keys.back().back().set(source.tree, v.values.front());
        } catch (const std::invalid_argument& error) {
          table.fail_at("key", error.what());
        }
      }
      for (const study::Variation& other : variations_) {
        if (other.name == v.name)
          table.fail(fmt::format("two variations are named `{}`; give one of them another `name`", v.name));
      }
      for (std::size_t before = 0; before < i; ++before) {
        if (collide(tasks, before))
          table.fail_at("key", fmt::format("`{}` is set by the variation `{}` already", fmt::join(v.keys, "`, `"),
                                           variations_[before].name));
      }
      variations_.push_back(std::move(v));
    }
  }

  /// Whether an earlier variation and the last one set the same place of any case: then their order matters.
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
    constexpr std::string_view samplings[] = {"grid", "latin-hypercube"};
    const bool grid = top.word("sampling", samplings).value_or("grid") == "grid";
    for (const std::string_view key : {"samples", "seed"}) {
      if (grid && top.has(key)) top.fail_at(key, fmt::format("`{}` goes with sampling = \"latin-hypercube\"", key));
    }
    const int samples = grid ? 0 : top.required_integer("samples", 1, 10'000'000);
    const int seed = top.integer("seed", 0, 2'000'000'000).value_or(1);
    if (!grid && variations_.empty()) top.fail("a Latin hypercube needs at least one [[vary]]");
    try {
      study.plan_ = std::make_shared<study::Plan>(names_, variations_,
                                                  grid ? study::Sampling::grid : study::Sampling::latin_hypercube,
                                                  static_cast<std::size_t>(samples), static_cast<std::uint64_t>(seed));
    } catch (const std::invalid_argument& error) {
      top.fail(error.what());
    }
    grid_ = grid;
    sampling_ = fmt::format("{} {} {}", grid, samples, seed);
    study.origin = origin_of_size(grid);
  }

  Study::Origin origin_of_size(bool grid) const {
    const auto at = [](std::string what, const toml::node& node) {
      const auto begin = node.source().begin;
      return Study::Origin{std::move(what), static_cast<long>(begin.line), static_cast<long>(begin.column)};
    };
    if (!grid) return at("`samples`", *tree_.get("samples"));
    const auto most = std::max_element(variations_.begin(), variations_.end(),
                                       [](const auto& a, const auto& b) { return a.values.size() < b.values.size(); });
    if (most == variations_.end() || most->values.size() < names_.size()) {
      const toml::node* cases = tree_.get("case");
      return cases ? at("the cases", *cases) : Study::Origin{};
    }
    const toml::table& vary =
        *tree_["vary"].as_array()->get(static_cast<std::size_t>(most - variations_.begin()))->as_table();
    return at(fmt::format("the {} values of `{}`", most->values.size(), most->name),
              *vary.get(vary.contains("values") ? "values" : "range"));
  }

  void read_ratios(const Table& top, Study& study) {
    for (const toml::table* raw : top.tables("ratio")) {
      const std::size_t i = study.ratios.size();
      const Table table(*raw, path_, fmt::format("[[ratio]] {}", i + 1), fmt::format("/ratio/{}", i),
                        {"name", "of", "to", "excess"});
      StudyRatio r{table.text("name").value_or(""), table.text("of").value_or(""), table.text("to").value_or(""),
                   table.boolean("excess").value_or(false)};
      if (r.name.empty()) table.fail("[[ratio]] needs a `name`");
      const auto columns = study.columns();
      if (std::find(columns.begin(), columns.end(), r.name) != columns.end())
        table.fail_at("name", fmt::format("there is a column `{}` already", r.name));
      check_column(table, "of", r.of, study);
      check_column(table, "to", r.to, study);
      study.ratios.push_back(std::move(r));
    }
  }

  void check_column(const Table& table, std::string_view key, const std::string& name, const Study& study) const {
    const auto columns = study.columns();
    if (std::find(columns.begin(), columns.end(), name) != columns.end()) return;
    const std::vector<std::string_view> known(columns.begin(), columns.end());
    const std::string message = name.empty() ? fmt::format("`{}` is missing: a column's name", key)
                                             : fmt::format("there is no column `{}`; {}", name, suggest(name, known));
    table.has(key) ? table.fail_at(key, message) : table.fail(message);
  }

  void read_figures(const Table& top, Study& study) {
    for (const toml::table* raw : top.tables("figure")) {
      const std::size_t i = study.figures.size();
      const Table table(*raw, path_, fmt::format("[[figure]] {}", i + 1), fmt::format("/figure/{}", i),
                        {"name", "title", "kind", "x", "y", "z", "family", "labels", "x_label", "y_label", "z_label",
                         "log_x", "log_y", "where"});
      using Kind = StudyFigure::Kind;
      StudyFigure f;
      f.name = table.text("name").value_or(fmt::format("figure-{}", i + 1));
      if (f.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-_") != std::string::npos)
        table.fail_at("name", "a figure's `name` becomes a file's: small letters, digits, - and _ are allowed");
      for (const StudyFigure& other : study.figures) {
        if (other.name == f.name) table.fail_at("name", fmt::format("two figures are named `{}`", f.name));
      }
      f.title = table.text("title", true).value_or("");
      constexpr std::string_view kinds[] = {"curve", "family", "heat", "pareto"};
      const std::string kind = table.word("kind", kinds).value_or("curve");
      f.kind = kind == "family"   ? Kind::family
               : kind == "heat"   ? Kind::heat
               : kind == "pareto" ? Kind::pareto
                                  : Kind::curve;
      f.x = table.text("x").value_or("");
      f.y = toml_input::strings(table, *raw, "y");
      f.z = table.text("z").value_or("");
      f.family = table.text("family").value_or("");
      f.labels = toml_input::strings(table, *raw, "labels");
      f.x_label = table.text("x_label").value_or(axis_title(std::vector{f.x}, study));
      f.y_label = table.text("y_label").value_or(axis_title(f.y, study));
      f.z_label = table.text("z_label").value_or(axis_title(std::vector{f.z}, study));
      f.log_x = table.boolean("log_x").value_or(false);
      f.log_y = table.boolean("log_y").value_or(false);
      if (f.kind == Kind::pareto) {
        // y names computations: time against error of each.
        for (const std::string& name : f.y) check_column(table, "y", name + ".cycle_time_ms", study);
        f.x_label = table.text("x_label").value_or("Corner error / um");
        f.y_label = table.text("y_label").value_or("Cycle time / ms");
      } else {
        check_column(table, "x", f.x, study);
        for (const std::string& name : f.y) check_column(table, "y", name, study);
      }
      if (f.y.empty()) table.fail("[[figure]] needs `y`");
      if (f.kind == Kind::heat) check_column(table, "z", f.z, study);
      if (f.kind == Kind::family) check_column(table, "family", f.family, study);
      if (f.kind == Kind::family && f.y.size() > 1) table.fail_at("y", "a family has one `y`");
      if (const toml::table* where = table.table("where")) {
        for (const auto& [column, value] : *where) {
          check_column(table, "where", std::string(column.str()), study);
          std::string text;
          if (const auto word = value.value_exact<std::string>())
            text = *word;
          else if (const auto number = value.value<double>())
            text = study::Row(*number).dump();
          else
            fail_node(value, "a condition is a number or a string");
          f.where.emplace_back(column.str(), text);
        }
      }
      if (const auto fault = check_study_figure(f, study, grid_))
        table.has(fault->key) ? table.fail_at(fault->key, fault->message) : table.fail(fault->message);
      study.figures.push_back(std::move(f));
    }
  }

  /// A mistake that makes every point bad is better said now, at its place; see read_study for the rule.
  void check_points(const Study& study) const {
    const std::size_t per_case = study.plan().size() / study.plan().cases().size();
    for (std::size_t c = 0; c < study.plan().cases().size(); ++c) {
      const auto fault = [&](std::size_t i) { return fault_of([&] { study.task(c * per_case + i); }); };
      // Nearly always the first will do, and the others need not even be listed.
      if (!fault(0) || !fault(per_case / 2) || !fault(per_case - 1)) continue;
      std::vector<InputError> faults;
      for (const std::size_t i : study::shard(per_case, 1, (per_case + most_probed - 1) / most_probed)) {
        auto found = fault(i);
        if (!found) break;
        faults.push_back(std::move(*found));
      }
      if (faults.size() >= std::min(per_case, most_probed)) refuse_case(study, c, faults);
    }
  }

  static std::optional<InputError> fault_of(const std::function<void()>& make) {
    try {
      make();
      return std::nullopt;
    } catch (const InputError& error) {
      return error;
    }
  }

  /// @throws InputError if one place is at fault in all points
  void refuse_case(const Study& study, std::size_t c, const std::vector<InputError>& faults) const {
    const InputError& first = faults.front();
    const Study::Tasks::Source& source = study.tasks_->cases[c];
    const auto same = [&](const std::optional<InputError>& other) {
      return other && other->message() == first.message();
    };
    // Read once more, for copies of a tree know no line numbers.
    const auto own = fault_of([&] { task_from_tree(toml_input::parse_file(source.path), source.path, "", {}); });
    if (same(own)) throw *own;
    const auto with_settings = fault_of([&] { task_from_tree(bases_[c], source.path, "", {}); });
    if (same(with_settings))
      throw InputError(path_, settings_[c].line, settings_[c].column,
                       fmt::format("`set` of case \"{}\" makes no task: {}", names_[c], first.message()));
    std::map<std::string, std::optional<std::size_t>> known;
    std::optional<std::size_t> axis;
    for (const InputError& fault : faults) {
      const auto [found, added] = known.try_emplace(fault.pointer());
      if (added) found->second = setter_of(source.tree, study.tasks_->keys, fault.pointer());
      if (!found->second || (axis && axis != found->second)) return;
      axis = found->second;
    }
    const study::Variation& v = variations_[*axis];
    throw InputError(path_, places_[*axis].line, places_[*axis].column,
                     fmt::format("no value of `{}` makes a task{}: {}", fmt::join(v.keys, "`, `"),
                                 names_[c].empty() ? "" : fmt::format(" of case \"{}\"", names_[c]), first.message()));
  }

  std::string hash(const Study& study, const Study::Tasks& tasks) const {
    std::ostringstream text;
    text << sampling_ << '\n'
         << fmt::format("{}\n{} {} {}\n", fmt::join(study.computations, " "), static_cast<int>(study.design.method),
                        study.design.solver, study.design.time_limit);
    for (std::size_t c = 0; c < names_.size(); ++c) text << names_[c] << '\n' << tasks.cases[c].tree << '\n';
    for (const auto& v : variations_)
      text << fmt::format("{} {} {} {} {}\n", v.name, fmt::join(v.keys, " "), fmt::join(v.values, " "), v.range,
                          v.logarithmic);
    for (const auto& r : study.ratios) text << fmt::format("{} {} {} {}\n", r.name, r.of, r.to, r.excess);
    return toml_input::hash_of(text.str());
  }

  [[noreturn]] void fail_node(const toml::node& node, const std::string& message) const {
    throw InputError(path_, node.source().begin.line, node.source().begin.column, message);
  }

  std::string path_;
  toml::table tree_;
  std::vector<std::string> names_;               ///< of the cases
  std::vector<toml::table> bases_;               ///< their tasks before anything is varied
  std::vector<toml::source_position> settings_;  ///< where their `set` stands
  std::vector<toml::source_position> places_;    ///< where the variations' `key` stands
  std::vector<study::Variation> variations_;
  std::string sampling_;
  bool grid_ = true;
};

Study read_study(const std::string& path) {
  return StudyReader(path).read();
}

}  // namespace accdec
