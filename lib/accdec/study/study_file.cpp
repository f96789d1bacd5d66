#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include <accdec/family.hpp>
#include <accdec/files.hpp>
#include <accdec/formats/task_tree.hpp>
#include <accdec/study/point_columns.hpp>
#include <accdec/study/study_file.hpp>
#include <accdec/study/study_tasks.hpp>

namespace accdec {
namespace {

batch::Row ratio(const batch::Row& row, const StudyRatio& r) {
  const auto of = row.find(r.of), to = row.find(r.to);
  if (of == row.end() || to == row.end() || !of->is_number() || !to->is_number() || to->get<double>() == 0.0)
    return nullptr;
  const double value = of->get<double>() / to->get<double>();
  return r.excess ? value - 1.0 : value;
}

bool has_shapes(const Study& study) {
  return std::count_if(study.computations.begin(), study.computations.end(),
                       [](const std::string& name) { return find_family(name) != nullptr; }) > 1;
}

/// The beginning of every row: index, case, values.
batch::Row beginning(const Study& study, const study::Point& point) {
  batch::Row row;
  row["index"] = point.index;
  if (study.points().cases().size() > 1) row["case"] = study.points().cases()[point.case_index];
  for (std::size_t v = 0; v < point.values.size(); ++v) row[study.points().variations()[v].name] = point.values[v];
  return row;
}

std::string finished(const Study& study, batch::Row row) {
  for (const std::string& column : study.columns()) {
    if (!row.contains(column)) row[column] = nullptr;
  }
  return row.dump(-1, ' ', false, batch::Row::error_handler_t::replace);
}

}  // namespace

std::vector<std::string> Study::columns() const {
  std::vector<std::string> names{"index"};
  if (points_->cases().size() > 1) names.push_back("case");
  for (const auto& v : points_->variations()) names.push_back(v.name);
  names.insert(names.end(), {"point", "reason"});
  for (const std::string& computation : computations) {
    const auto more = study::columns_of(computation);
    names.insert(names.end(), more.begin(), more.end());
  }
  if (has_shapes(*this)) names.push_back("best_shape");
  for (const StudyRatio& r : ratios) names.push_back(r.name);
  return names;
}

Task Study::task(std::size_t index) const {
  const study::Point point = points_->point(index);
  const auto& source = tasks_->cases[point.case_index];
  toml::table tree = source.tree;
  for (std::size_t v = 0; v < point.values.size(); ++v) {
    for (const TaskKey& key : tasks_->keys[v]) key.set(tree, point.values[v]);
  }
  return task_from_tree(tree, source.path, "", {.response = Considered::all});
}

std::vector<std::string> Study::task_paths() const {
  std::vector<std::string> paths;
  for (const Tasks::Source& source : tasks_->cases) paths.push_back(source.path);
  return paths;
}

std::string Study::row(std::size_t index, double* method_seconds) const {
  if (method_seconds) *method_seconds = 0.0;
  batch::Row row = beginning(*this, points_->point(index));
  try {
    const Task point_task = task(index);
    row["point"] = "ok";
    row["reason"] = nullptr;
    const auto began = std::chrono::steady_clock::now();
    for (const std::string& computation : computations) study::compute_into(row, point_task, computation, design);
    if (method_seconds) *method_seconds = seconds_since(began);
    if (has_shapes(*this)) row["best_shape"] = study::best_shape_of(row);
    for (const StudyRatio& r : ratios) row[r.name] = ratio(row, r);
    if (const batch::Row error = study::error_of(row, computations); !error.is_null()) {
      row["point"] = "error";
      row["reason"] = error;
    }
  } catch (const InputError& error) {
    // Line numbers would point into the base task, which is correct.
    row["point"] = "bad";
    row["reason"] = error.message();
  } catch (const std::exception& error) {
    row["point"] = "bad";
    row["reason"] = error.what();
  }
  return finished(*this, std::move(row));
}

std::string Study::lost_row(std::size_t index, const std::string& reason) const {
  batch::Row row = beginning(*this, points_->point(index));
  row["point"] = "lost";
  row["reason"] = reason;
  return finished(*this, std::move(row));
}

}  // namespace accdec
