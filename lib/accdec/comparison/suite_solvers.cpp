#include <algorithm>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/comparison/suite_solvers.hpp>
#include <accdec/files/suggestion.hpp>
#include <accdec/formats/toml_file.hpp>

namespace accdec::toml_input {
namespace {

using study::Competitor;
using Names = std::vector<std::string>;

bool among(const Names& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string unknown(const std::string& name, const Names& known) {
  const std::string near = nearest(name, std::vector<std::string_view>(known.begin(), known.end()));
  return fmt::format("unknown solver \"{}\"; {}known are {}", name,
                     near.empty() ? "" : fmt::format("did you mean \"{}\"? ", near), fmt::join(known, ", "));
}

Names registered_names() {
  Names names;
  for (const auto& solver : solvers::registry()) names.push_back(solver->name());
  return names;
}

Names with_forms(Names names) {
  for (const auto& solver : solvers::registry()) {
    if (!study::takes_both_forms(*solver)) continue;
    for (const char* form : {"/sparse", "/reduced"}) names.push_back(solver->name() + form);
  }
  return names;
}

/// What is wrong with a list of solvers; nothing if all are known and each stands once.
std::string objection(const Names& wanted, const Names& known) {
  for (auto name = wanted.begin(); name != wanted.end(); ++name) {
    if (!among(known, *name)) return unknown(*name, known);
    if (std::find(wanted.begin(), name, *name) != name) return fmt::format("solver \"{}\" stands twice", *name);
  }
  return {};
}

Names known_solvers(const Table& top, std::string_view key, const Names& wanted, const Names& known) {
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

Competitor read_variant(const Table& top, const toml::table& raw, std::size_t i, const Names& names) {
  const Table table(raw, top.file(), fmt::format("[[variant]] {}", i + 1), fmt::format("/variant/{}", i),
                    {"name", "solver", "form", "options"});
  Competitor c;
  c.name = table.text("name").value_or("");
  if (c.name.empty()) table.fail("[[variant]] needs a `name` for tables and figures");
  c.solver = table.text("solver").value_or("");
  if (!among(names, c.solver)) table.fail_at(table.has("solver") ? "solver" : "name", unknown(c.solver, names));
  constexpr std::string_view forms[] = {"sparse", "reduced"};
  if (const auto form = table.word("form", forms)) {
    if (!study::takes_both_forms(c.registered()))
      table.fail_at("form", fmt::format("{} takes one form only", c.solver));
    c.form = *form == "sparse" ? Competitor::Form::sparse : Competitor::Form::reduced;
  }
  if (const toml::table* options = table.table("options")) {
    c.native = options_of(table, *options);
    try {
      c.warm_up();  // whether it knows them, the library says itself
    } catch (const std::invalid_argument& error) {
      table.fail_at("options", error.what());
    }
  }
  return c;
}

}  // namespace

void read_competitors(const Table& top, const toml::table& raw, const Names& instead,
                      study::ComparisonSettings& settings) {
  const Names names = registered_names(), known = with_forms(names);
  const auto variants = top.tables("variant");
  settings.reduced = known_solvers(top, "reduced", strings(top, raw, "reduced"), names);
  if (!instead.empty()) {
    if (const std::string message = objection(instead, known); !message.empty())
      throw std::invalid_argument("--solvers: " + message);
    for (const std::string& name : instead) settings.solvers.push_back(study::competitor_from_entry(name));
    return;
  }
  const Names wanted = strings(top, raw, "solvers");
  if (wanted.empty() && variants.empty())
    top.fail(fmt::format("the suite needs `solvers`: \"all\" or a list of {}", fmt::join(names, ", ")));
  for (const std::string& name : wanted == Names{"all"} ? names : known_solvers(top, "solvers", wanted, known)) {
    settings.solvers.push_back(study::competitor_from_entry(name));
  }
  for (std::size_t i = 0; i < variants.size(); ++i) {
    Competitor variant = read_variant(top, *variants[i], i, names);
    const auto same = [&](const Competitor& c) { return c.name == variant.name; };
    if (std::any_of(settings.solvers.begin(), settings.solvers.end(), same))
      top.fail_at("variant", i, fmt::format("the name \"{}\" is taken already", variant.name));
    settings.solvers.push_back(std::move(variant));
  }
}

}  // namespace accdec::toml_input
