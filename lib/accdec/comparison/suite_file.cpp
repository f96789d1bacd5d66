#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/comparison/suite_file.hpp>
#include <accdec/comparison/suite_hypercube.hpp>
#include <accdec/comparison/suite_keys.hpp>
#include <accdec/comparison/suite_solvers.hpp>
#include <accdec/formats/task_tree.hpp>
#include <accdec/formats/toml_file.hpp>

namespace accdec {
namespace {

using toml_input::Table;

class SuiteReader {
 public:
  SuiteReader(const std::string& path, const std::vector<std::string>& solvers)
      : path_(path), tree_(toml_input::parse_file(path, InputKind::suite)), solvers_(solvers) {}

  Suite read() {
    toml_input::check_keys(tree_, path_, top_name, "", suite_file().keys).raise();
    const Table top(tree_, path_, top_name, "", suite_file().keys);
    Suite suite;
    suite.path = path_;
    read_settings(top, suite.settings);
    for (const Table& table : top.tables("problem")) read_problem(top, table, suite);
    for (const Table& table : top.tables("hypercube")) read_hypercube(table, suite);
    if (suite.cases.empty()) top.fail("the suite needs at least one [[problem]] or [[hypercube]]");
    suite.hash = toml_input::hash_of(text_.str());
    return suite;
  }

 private:
  static constexpr const char* top_name = "the suite (top level)";

  void read_settings(const Table& top, comparison::ComparisonSettings& s) {
    s.title = top.text("title").value_or(path_);
    s.notes = top.text("notes").value_or("");
    s.starts = top.required_integer("starts");
    s.repeats = top.required_integer("repeats");
    s.seed = static_cast<std::uint64_t>(top.required_integer("seed"));
    s.time_limit = top.required_number("time_limit_s");
    s.kill_after = top.number("kill_after_s").value_or(2.0 * s.time_limit + 1.0);
    if (s.kill_after < s.time_limit)
      top.fail_at("kill_after_s", fmt::format("`kill_after_s` must be at least time_limit_s = {:g}", s.time_limit));
    s.evaluation_limit = top.required_integer("evaluation_limit");
    s.tolerance = top.required_number("tolerance");
    s.feasibility = top.required_number("feasibility");
    s.accuracy = top.required_number("accuracy");
    if (top.has("targets")) s.targets = top.numbers("targets");
    s.reference_time_limit = top.required_number("reference_time_limit_s");
    read_competitors(top, std::filesystem::absolute(path_).parent_path().string(), solvers_, s);
    for (const comparison::Competitor& c : s.solvers) {
      text_ << fmt::format("{} {} {}", c.name, c.solver, static_cast<int>(c.form));
      for (const auto& [key, value] : c.native) text_ << fmt::format(" {}={}", key, value);
      text_ << '\n';
    }
    // The first word stands for the meaning of an index of the raw data.
    text_ << fmt::format("shuffled {} {} {} {} {} {} {} {} {} {} {} {}\n", fmt::join(s.reduced, " "), s.starts,
                         s.repeats, s.seed, s.time_limit, s.kill_after, s.evaluation_limit, s.tolerance, s.feasibility,
                         s.accuracy, fmt::join(s.targets, " "), s.reference_time_limit);
  }

  static std::vector<int> sizes(const Table& table) {
    std::vector<int> factors;
    for (const double x : table.has("sizes") ? table.numbers("sizes") : std::vector<double>{1.0}) {
      const int factor = static_cast<int>(x);
      if (std::find(factors.begin(), factors.end(), factor) != factors.end())
        table.fail_at("sizes", fmt::format("size {} stands twice", factor));
      factors.push_back(factor);
    }
    return factors;
  }

  void read_problem(const Table& top, const Table& table, Suite& suite) {
    comparison::CaseSpec spec;
    spec.name = *table.text("name");
    spec.family = table.text("family").value_or("other");
    std::string path;
    toml::table tree = toml_input::parse_task_beside(table, "task", *table.text("task"), path);
    if (const toml::table* set = table.raw()["set"].as_table()) toml_input::apply_settings(*set, path_, tree);
    try {
      spec.task = task_from_tree(tree, path, "", {.response = Considered::loads});
    } catch (const InputError& error) {
      // The file alone may be valid: it must be valid together with the keys that the suite sets.
      if (table.has("set")) table.fail_at("set", fmt::format("the task with these keys set: {}", error.what()));
      throw;
    }
    spec.order = table.required_integer("order");
    spec.expected = *comparison::expected_from_string(table.word("expected"));
    spec.time_limit = table.number("time_limit_s").value_or(0.0);
    read_delays(table, spec);
    add_cases(table, spec, tree, table.has("sizes") ? sizes(table) : sizes(top), suite);
  }

  void read_hypercube(const Table& table, Suite& suite) {
    std::string path;
    const toml::table base = toml_input::parse_task_beside(table, "task", *table.text("task"), path);
    for (const toml_input::DrawnProblem& drawn : toml_input::draw_problems(table, base)) {
      comparison::CaseSpec spec;
      spec.name = drawn.name;
      spec.family = table.text("family").value_or(*table.text("name"));
      spec.expected = *comparison::expected_from_string(table.word("expected"));
      spec.time_limit = table.number("time_limit_s").value_or(0.0);
      try {
        spec.task = task_from_tree(drawn.task, path, "", {.response = Considered::loads});
      } catch (const InputError& error) {
        table.fail_at("ranges", fmt::format("problem \"{}\": {}", drawn.name, error.what()));
      }
      const int least = toml_input::fastest_order(spec.task, most_taps);
      if (least > most_taps)
        table.fail_at("ranges", fmt::format("problem \"{}\": no filter of {} taps starts", drawn.name, most_taps));
      spec.order = std::max(1, static_cast<int>(std::ceil(drawn.order_factor * least)));
      add_cases(table, spec, drawn.task, {1}, suite);
    }
  }

  /// A case for each formulation and size. @param tree  of the task
  void add_cases(const Table& table, comparison::CaseSpec& spec, const toml::table& tree,
                 const std::vector<int>& factors, Suite& suite) {
    check_order(table, spec, tree);
    std::ostringstream problem;
    problem << tree << '\n'
            << fmt::format("{} {} {} {}\n", spec.order, expected_number(spec), spec.time_limit,
                           fmt::join(spec.delays, " "));
    text_ << spec.name << '\n' << problem.str();
    for (const std::string& name : table.texts("formulation")) {
      spec.question = *comparison::question_from_string(name);
      check(table, spec, suite);
      for (const int factor : factors) {
        if (factor > 1 && has_measured_taps(spec.task.machine))
          table.fail_at("task", "prefilter_taps and response_taps hold for one sample period; allowed is size 1");
        if (static_cast<long>(spec.order + 1) * factor > most_taps)
          table.fail(
              fmt::format("order {} at size {} is too large; {} taps are allowed", spec.order, factor, most_taps));
        suite.cases.push_back(comparison::refined(spec, factor));
        suite.cases.back().identity = toml_input::hash_of(problem.str() + name + fmt::format(" {}", factor));
        text_ << name << ' ' << factor << '\n';
      }
    }
  }

  /// `feasible` and `infeasible` as they stand in the identity of earlier results.
  static std::string expected_number(const comparison::CaseSpec& spec) {
    if (spec.expected == comparison::Expected::unknown) return "unknown";
    return spec.expected == comparison::Expected::infeasible ? "true" : "false";
  }

  static bool has_measured_taps(const Machine& machine) {
    return !machine.prefilter_taps.empty() ||
           std::ranges::any_of(machine.axes, [](const Axis& axis) { return !axis.response_taps.empty(); });
  }

  void read_delays(const Table& table, comparison::CaseSpec& spec) const {
    const std::size_t corners = spec.task.corners.size();
    if (!table.has("delay_samples")) return;
    const std::vector<double> given = table.numbers("delay_samples");
    const std::vector<std::string> formulations = table.texts("formulation");
    if (std::ranges::all_of(formulations, [](const std::string& name) { return name == "design"; }))
      table.fail_at("delay_samples",
                    "a design chooses its delays: `delay_samples` is of `margin` and `delay`; allowed is delay_samples "
                    "of a [[corner]] in the task");
    spec.delays.resize(corners);
    if (given.size() != 1 && given.size() != corners)
      table.fail_at("delay_samples",
                    fmt::format("`delay_samples` needs one number, or one for each of the {} corners", corners));
    for (std::size_t j = 0; j < corners; ++j) {
      spec.delays[j] = static_cast<int>(given.size() == 1 ? given.front() : given[j]);
      const TaskCorner& corner = spec.task.corners[j];
      if (corner.delay && *corner.delay != spec.delays[j])
        table.fail_at(
            "delay_samples", j,
            fmt::format("`delay_samples` = {0} contradicts the task, which gives {1} to corner {2}; allowed is "
                        "{1}, or no `delay_samples`",
                        spec.delays[j], *corner.delay, corner.name));
    }
  }

  /// Refuses an order that the task itself excludes. Its defaults exclude none.
  static void check_order(const Table& table, const comparison::CaseSpec& spec, const toml::table& tree) {
    const auto& design = spec.task.design;
    const auto given = tree["design"];
    const auto refuse = [&](const char* sign, const char* key, int bound) {
      table.fail_at("order",
                    fmt::format("order {} of \"{}\" contradicts the task; allowed is order {} its [design] {} = {}",
                                spec.order, spec.name, sign, key, bound));
    };
    if (given["order_min"] && spec.order < design.order_min) refuse(">=", "order_min", design.order_min);
    if (given["order_max"] && spec.order > design.order_max) refuse("<=", "order_max", design.order_max);
  }

  void check(const Table& table, const comparison::CaseSpec& spec, const Suite& suite) const {
    for (const comparison::CaseSpec& other : suite.cases) {
      if (other.name == spec.name && other.question == spec.question)
        table.fail_at("name", fmt::format("the name \"{}\" is taken already", spec.name));
    }
  }

  std::string path_;
  toml::table tree_;
  std::vector<std::string> solvers_;  // used instead of the file's
  std::ostringstream text_;
};

}  // namespace

Suite read_suite(const std::string& path, const std::vector<std::string>& solvers) {
  return SuiteReader(path, solvers).read();
}

}  // namespace accdec
