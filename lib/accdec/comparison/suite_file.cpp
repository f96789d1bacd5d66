#include <algorithm>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/comparison/suite_file.hpp>
#include <accdec/comparison/suite_solvers.hpp>
#include <accdec/formats/task_tree.hpp>
#include <accdec/formats/toml_file.hpp>

namespace accdec {
namespace {

using toml_input::Table;

constexpr int most_samples = 100'000;

class SuiteReader {
 public:
  SuiteReader(const std::string& path, const std::vector<std::string>& solvers)
      : path_(path), tree_(toml_input::parse_file(path)), solvers_(solvers) {}

  Suite read() {
    const Table top(tree_, path_, "the suite (top level)", "",
                    {"title", "notes", "solvers", "starts", "seed", "repeats", "time_limit_s", "kill_after_s",
                     "evaluation_limit", "tolerance", "feasibility", "accuracy", "targets", "reference_time_limit_s",
                     "sizes", "reduced", "variant", "problem"});
    Suite suite;
    suite.path = path_;
    read_settings(top, suite.settings);
    for (const toml::table* raw : top.tables("problem")) read_problem(top, *raw, suite);
    if (suite.cases.empty()) top.fail("the suite needs at least one [[problem]]");
    suite.hash = toml_input::hash_of(text_.str());
    return suite;
  }

 private:
  void read_settings(const Table& top, study::ComparisonSettings& s) {
    s.title = top.text("title").value_or(path_);
    s.notes = top.text("notes", true, true).value_or("");
    s.starts = top.integer("starts", 1, 1000).value_or(1);
    s.repeats = top.integer("repeats", 1, 1000).value_or(5);
    s.seed = static_cast<std::uint64_t>(top.integer("seed", 0, 2'000'000'000).value_or(1));
    s.time_limit = top.number("time_limit_s", {0.0, 1e6, true}).value_or(s.time_limit);
    s.kill_after = top.number("kill_after_s", {0.0, 1e7, true}).value_or(2.0 * s.time_limit + 1.0);
    if (s.kill_after < s.time_limit)
      top.fail_at("kill_after_s", fmt::format("`kill_after_s` must be at least time_limit_s = {:g}", s.time_limit));
    s.evaluation_limit =
        top.integer("evaluation_limit", 1, 2'000'000'000).value_or(static_cast<int>(s.evaluation_limit));
    s.tolerance = top.number("tolerance", {0.0, 1.0, true}).value_or(s.tolerance);
    s.feasibility = top.number("feasibility", {0.0, 1.0, true}).value_or(s.feasibility);
    s.accuracy = top.number("accuracy", {0.0, 1.0, true}).value_or(s.accuracy);
    s.targets = top.numbers("targets", {0.0, 1e6, true}, 1, 8).value_or(s.targets);
    s.reference_time_limit = top.number("reference_time_limit_s", {0.0, 1e6, true}).value_or(s.reference_time_limit);
    read_competitors(top, tree_, solvers_, s);
    for (const study::Competitor& c : s.solvers) {
      text_ << fmt::format("{} {} {}", c.name, c.solver, static_cast<int>(c.form));
      for (const auto& [key, value] : c.native) text_ << fmt::format(" {}={}", key, value);
      text_ << '\n';
    }
    // The first word stands for what an index of the raw data means.
    text_ << fmt::format("shuffled {} {} {} {} {} {} {} {} {} {} {} {}\n", fmt::join(s.reduced, " "), s.starts,
                         s.repeats, s.seed, s.time_limit, s.kill_after, s.evaluation_limit, s.tolerance, s.feasibility,
                         s.accuracy, fmt::join(s.targets, " "), s.reference_time_limit);
  }

  std::vector<int> sizes(const Table& table) const {
    std::vector<int> factors;
    for (const double x : table.numbers("sizes", {1.0, 1000.0}, 1, 20).value_or(std::vector<double>{1.0})) {
      if (x != static_cast<int>(x))
        table.fail_at("sizes",
                      "`sizes` must be whole numbers: how many times finer than written each problem is sampled");
      const int factor = static_cast<int>(x);
      if (std::find(factors.begin(), factors.end(), factor) != factors.end())
        table.fail_at("sizes", fmt::format("size {} stands twice", factor));
      factors.push_back(factor);
    }
    return factors;
  }

  void read_problem(const Table& top, const toml::table& raw, Suite& suite) {
    const std::size_t i = count_++;
    const Table table(raw, path_, fmt::format("[[problem]] {}", i + 1), fmt::format("/problem/{}", i),
                      {"name", "family", "task", "set", "formulation", "order", "sizes", "delay_samples",
                       "time_limit_s", "expected"});
    study::CaseSpec spec;
    spec.name = table.text("name").value_or("");
    if (spec.name.empty()) table.fail("[[problem]] needs a `name`");
    spec.family = table.text("family").value_or("other");
    const auto file = table.text("task");
    if (!file) table.fail("[[problem]] needs a `task`: a task file, relative to the suite");
    std::string path;
    toml::table tree = toml_input::parse_task_beside(table, "task", *file, path);
    if (const toml::table* set = table.table("set")) toml_input::apply_settings(*set, path_, tree);
    try {
      spec.task = task_from_tree(tree, path, "", {});
    } catch (const InputError& error) {
      // The file alone may be right: it is to be read whole, with what the suite sets anew.
      if (table.has("set")) table.fail_at("set", fmt::format("the task with these keys set: {}", error.what()));
      throw;
    }
    spec.order = table.required_integer("order", 1, most_samples);
    constexpr std::string_view outcomes[] = {"feasible", "infeasible"};
    spec.infeasible = table.word("expected", outcomes).value_or("feasible") == "infeasible";
    spec.time_limit = table.number("time_limit_s", {0.0, 1e6, true}).value_or(0.0);
    read_delays(table, spec);
    text_ << spec.name << '\n'
          << tree << '\n'
          << fmt::format("{} {} {} {}\n", spec.order, spec.infeasible, spec.time_limit, fmt::join(spec.delays, " "));
    std::vector<std::string> questions = toml_input::strings(table, raw, "formulation");
    if (questions.empty())
      table.fail("[[problem]] needs a `formulation`: \"margin\", \"delay\", \"design\" or a list of these");
    for (const std::string& name : questions) {
      const auto question = study::question_from_string(name);
      if (!question)
        table.fail_at("formulation",
                      fmt::format("unknown formulation \"{}\"; allowed are margin, delay, design", name));
      spec.question = *question;
      check(table, spec, suite);
      for (const int factor : table.has("sizes") ? sizes(table) : sizes(top)) {
        if (static_cast<long>(spec.order + 1) * factor > most_samples)
          table.fail(
              fmt::format("order {} at size {} is too large; {} taps are allowed", spec.order, factor, most_samples));
        suite.cases.push_back(study::refined(spec, factor));
        text_ << name << ' ' << factor << '\n';
      }
    }
  }

  void read_delays(const Table& table, study::CaseSpec& spec) const {
    const std::size_t corners = spec.task.corners.size();
    const auto given = table.numbers("delay_samples", {0.0, most_samples}, 1, 10'000, true);
    if (!given) return;
    spec.delays.resize(corners);
    if (given->size() != 1 && given->size() != corners)
      table.fail_at("delay_samples",
                    fmt::format("`delay_samples` needs one number, or one for each of the {} corners", corners));
    for (std::size_t j = 0; j < corners; ++j)
      spec.delays[j] = static_cast<int>(given->size() == 1 ? given->front() : (*given)[j]);
  }

  void check(const Table& table, const study::CaseSpec& spec, const Suite& suite) const {
    for (const study::CaseSpec& other : suite.cases) {
      if (other.name == spec.name && other.question == spec.question)
        table.fail_at("name", fmt::format("the name \"{}\" is taken already", spec.name));
    }
    const bool bounded = std::any_of(spec.task.corners.begin(), spec.task.corners.end(),
                                     [](const TaskCorner& c) { return c.error_max && *c.error_max > 0.0; });
    if (!bounded) table.fail_at("task", "a comparison problem needs a corner with error_max_um > 0");
  }

  std::string path_;
  toml::table tree_;
  std::vector<std::string> solvers_;  // instead of the file's
  std::ostringstream text_;
  std::size_t count_ = 0;
};

}  // namespace

Suite read_suite(const std::string& path, const std::vector<std::string>& solvers) {
  return SuiteReader(path, solvers).read();
}

}  // namespace accdec
