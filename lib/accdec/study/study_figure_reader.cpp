#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include <accdec/files/suggestion.hpp>
#include <accdec/study/column_titles.hpp>
#include <accdec/study/point_columns.hpp>
#include <accdec/study/study_figure_completion.hpp>
#include <accdec/study/study_parts.hpp>

namespace accdec {
namespace {

using toml_input::Table;
using Kind = StudyFigure::Kind;

Kind kind_of(const std::string& name) {
  if (name == "family") return Kind::family;
  if (name == "heat") return Kind::heat;
  return name == "pareto" ? Kind::pareto : Kind::curve;
}

void check_name(const Table& table, const StudyFigure& figure, const std::vector<StudyFigure>& others) {
  if (figure.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-_") != std::string::npos)
    table.fail_at("name", "a figure's `name` becomes a file's: small letters, digits, - and _ are allowed");
  for (const StudyFigure& other : others) {
    if (other.name == figure.name) table.fail_at("name", fmt::format("two figures are named `{}`", figure.name));
  }
}

void check_columns(const Table& table, const StudyFigure& figure, const Study& study) {
  if (figure.kind != Kind::pareto) check_column(table, "x", figure.x, study);
  // A pareto figure's y names computations: time against error of each.
  for (const std::string& name : figure.y)
    check_column(table, "y", figure.kind == Kind::pareto ? name + ".cycle_time_ms" : name, study);
  if (figure.kind == Kind::heat) check_column(table, "z", figure.z, study);
  if (figure.kind != Kind::family) return;
  check_column(table, "family", figure.family, study);
  if (figure.y.size() > 1) table.fail_at("y", "a family has one `y`");
}

std::vector<std::pair<std::string, std::string>> read_where(const Table& table, const Study& study) {
  std::vector<std::pair<std::string, std::string>> conditions;
  const toml::table* where = table.raw()["where"].as_table();
  if (!where) return conditions;
  for (const auto& [column, value] : *where) {
    check_column(table, "where", std::string(column.str()), study);
    std::string text;
    if (const auto word = value.value_exact<std::string>())
      text = *word;
    else if (const auto number = value.value<double>())
      text = batch::Row(*number).dump();
    else
      throw InputError(table.file(), value.source().begin.line, value.source().begin.column,
                       "a condition is a number or a string");
    conditions.emplace_back(column.str(), text);
  }
  return conditions;
}

StudyFigure read_figure(const Table& table, const Study& study, bool grid) {
  StudyFigure f;
  f.name = table.text("name").value_or(fmt::format("figure-{}", study.figures.size() + 1));
  check_name(table, f, study.figures);
  f.title = table.text("title").value_or("");
  f.kind = kind_of(table.word("kind"));
  f.x = table.text("x").value_or("");
  f.y = table.texts("y");
  f.z = table.text("z").value_or("");
  f.family = table.text("family").value_or("");
  f.labels = table.texts("labels");
  const bool pareto = f.kind == Kind::pareto;
  f.x_label = table.text("x_label").value_or(pareto ? "Corner error / µm" : axis_title(std::vector{f.x}, study));
  f.y_label = table.text("y_label").value_or(pareto ? "Cycle time / ms" : axis_title(f.y, study));
  f.z_label = table.text("z_label").value_or(axis_title(std::vector{f.z}, study));
  f.log_x = table.boolean("log_x");
  f.log_y = table.boolean("log_y");
  check_columns(table, f, study);
  f.where = read_where(table, study);
  if (const auto fault = complete_study_figure(f, study, grid)) table.fail_at(fault->key, fault->message);
  return f;
}

}  // namespace

void check_column(const Table& table, std::string_view key, const std::string& name, const Study& study) {
  const auto columns = study.columns();
  if (std::find(columns.begin(), columns.end(), name) != columns.end()) return;
  const std::vector<std::string_view> known(columns.begin(), columns.end());
  table.fail_at(key, name.empty() ? fmt::format("`{}` is missing: a column's name", key)
                                  : fmt::format("there is no column `{}`; {}", name, suggest(name, known)));
}

void read_figures(const Table& top, Study& study, bool grid) {
  for (const Table& table : top.tables("figure")) study.figures.push_back(read_figure(table, study, grid));
}

}  // namespace accdec
