#include <algorithm>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/comparison/external_solver.hpp>
#include <accdec/comparison/suite_keys.hpp>
#include <accdec/comparison/suite_solvers.hpp>
#include <accdec/files/suggestion.hpp>

namespace accdec::toml_input {
namespace {

using comparison::Competitor;
using Names = std::vector<std::string>;

bool among(const Names& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// The error in a list of solvers; empty if all are known and none appears twice.
std::string objection(const Names& wanted, const Names& known) {
  for (auto name = wanted.begin(); name != wanted.end(); ++name) {
    if (!among(known, *name)) return unknown_name("solver", *name, known);
    if (std::find(wanted.begin(), name, *name) != name) return fmt::format("solver \"{}\" stands twice", *name);
  }
  return {};
}

Names known_solvers(const Table& top, std::string_view key, const Names& known) {
  Names wanted = top.texts(key);
  if (const std::string message = objection(wanted, known); !message.empty()) top.fail_at(key, message);
  return wanted;
}

/// The options in the library's own words.
std::map<std::string, std::string> options_of(const Table& table, const toml::table& raw) {
  std::map<std::string, std::string> native;
  for (const auto& [key, value] : raw) {
    if (!value.is_string() && !value.is_number() && !value.is_boolean()) {
      table.fail_at("options", fmt::format("option `{}` must be a number, a string, true or false", key.str()));
    }
    std::ostringstream text;
    if (value.is_string())
      text << value.as_string()->get();
    else
      value.visit([&](const auto& v) {
        if constexpr (toml::is_value<decltype(v)>) text << v;
      });
    native[std::string(key.str())] = text.str();
  }
  return native;
}

/// What "all" means. Mixed-integer rivals are optional parts of the build, so a suite names them.
Names names_of_all() {
  Names names;
  for (const auto& solver : solvers::registry()) {
    if (!solver->capabilities().integers) names.push_back(solver->name());
  }
  return names;
}

Competitor read_variant(const Table& table) {
  Competitor c;
  c.name = *table.text("name");
  c.solver = table.word("solver");
  if (table.has("form")) {
    if (!comparison::takes_both_forms(c.registered()))
      table.fail_at("form", fmt::format("{} takes one form only", c.solver));
    c.form = table.word("form") == "sparse" ? Competitor::Form::sparse : Competitor::Form::reduced;
  }
  if (const toml::table* options = table.raw()["options"].as_table()) {
    c.native = options_of(table, *options);
    try {
      c.warm_up();  // the library itself reports unknown ones
    } catch (const std::invalid_argument& error) {
      table.fail_at("options", error.what());
    }
  }
  return c;
}

Competitor read_external(const Table& table, const std::string& folder, double grace) {
  comparison::External external{*table.text("name"),
                                *table.text("command"),
                                table.word("reads"),
                                table.word("answer"),
                                folder,
                                table.integer("memory_max_MB").value_or(0),
                                grace};
  if (external.command.find("{" + external.reads + "}") == std::string::npos)
    table.fail_at("command", fmt::format("`command` needs {{{}}}, the place of the problem's file", external.reads));
  if (external.answer == "sol" && external.reads != "nl") {
    const std::string reason = fmt::format(
        "`answer` = \"sol\" is AMPL's, of solvers that read \"nl\"; this one reads \"{}\": allowed are \"values\" and "
        "\"names\"",
        external.reads);
    table.has("answer") ? table.fail_at("answer", reason) : table.fail_at("reads", reason);
  }
  try {
    comparison::command_words(external.command, {{external.reads, ""}, {"answer", ""}, {"seconds", ""}, {"suite", ""}});
  } catch (const std::invalid_argument& error) {
    table.fail_at("command", error.what());
  }
  Competitor c;
  c.name = external.name;
  c.solver = "external";
  c.form = Competitor::Form::sparse;
  c.native = {{"command", external.command}, {"reads", external.reads}, {"answer", external.answer}};
  if (external.memory_max > 0) c.native["memory_max_MB"] = std::to_string(external.memory_max);
  c.state = comparison::program_state(external);
  c.external = std::make_shared<comparison::ExternalSolver>(std::move(external));
  return c;
}

}  // namespace

void read_competitors(const Table& top, const std::string& folder, const Names& instead,
                      comparison::ComparisonSettings& settings) {
  const Names names = solver_names(), known = solver_names_with_forms();
  const auto variants = top.tables("variant"), externals = top.tables("external");
  settings.reduced = known_solvers(top, "reduced", names);
  if (!instead.empty()) {
    if (const std::string message = objection(instead, known); !message.empty())
      throw std::invalid_argument("--solvers: " + message);
    for (const std::string& name : instead) settings.solvers.push_back(comparison::competitor_from_entry(name));
    return;
  }
  if (!top.has("solvers") && variants.empty() && externals.empty())
    top.fail(fmt::format("the suite needs `solvers`: \"all\" or a list of {}", fmt::join(names, ", ")));
  for (const std::string& name : top.text("solvers") == "all" ? names_of_all() : known_solvers(top, "solvers", known))
    settings.solvers.push_back(comparison::competitor_from_entry(name));
  const auto add = [&](const Table& table, Competitor entry) {
    const auto same = [&](const Competitor& c) { return c.name == entry.name; };
    if (std::any_of(settings.solvers.begin(), settings.solvers.end(), same))
      table.fail(fmt::format("the name \"{}\" is taken already", entry.name));
    settings.solvers.push_back(std::move(entry));
  };
  for (const Table& table : variants) add(table, read_variant(table));
  for (const Table& table : externals) {
    if (const std::string name = *table.text("name"); among(known, name))
      table.fail_at("name", fmt::format("\"{}\" is a solver of `accdec solvers`; a program needs another name", name));
    add(table, read_external(table, folder, settings.kill_after - settings.time_limit));
  }
}

}  // namespace accdec::toml_input
