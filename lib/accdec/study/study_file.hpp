#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <accdec/batch/runner.hpp>
#include <accdec/design.hpp>
#include <accdec/files.hpp>
#include <accdec/study/point_set.hpp>

namespace accdec {

/// A column made of two others: of/to, or of/to - 1.
struct StudyRatio {
  std::string name, of, to;
  bool excess = false;
};

/// A figure of a study's report, drawn from its table.
struct StudyFigure {
  enum class Kind {
    curve,   ///< y columns over x
    family,  ///< one y column over x, a curve for every value of another column
    heat,    ///< z over a grid of x and y; words in z become classes
    pareto   ///< cycle time (y) against corner error (x): only rows that no other row of the same curve beats in both
  };
  std::string name, title;
  Kind kind = Kind::curve;
  std::string x, x_label, y_label, z_label, family, z;
  std::vector<std::string> y, labels;                      ///< labels: one per curve; else the columns' names
  std::vector<std::pair<std::string, std::string>> where;  ///< column = value (as in the CSV): selects rows
  bool log_x = false, log_y = false;
  std::vector<std::string> members;  ///< for a family over a varied quantity: its values in order, as in the CSV
  std::string family_unit;           ///< of these values, for the legend
  bool excess = false;               ///< z is a difference with its sign: see HeatMap::with_sign
  bool points_only = false;          ///< no lines between points, as those of a Latin hypercube are scattered
};

/// A study file, read. It fixes everything that a point's row depends on.
class Study {
 public:
  std::string title, notes, path;
  std::vector<std::string> computations;  ///< "shapes" already replaced by all names
  std::vector<StudyRatio> ratios;
  std::vector<StudyFigure> figures;
  /// Method and time limit of every optimum. Rows are the same on every machine and with any number of workers, except
  /// optima that the time limit ends early. These are the best design verified by then (status "feasible", stop "time
  /// limit").
  DesignOptions design;
  batch::Isolation isolation = batch::Isolation::threads;
  /// The source of most of the points and its place in the file: `samples`, a variation's values, or the cases.
  struct Origin {
    std::string what;
    long line = 0, column = 0;
  } origin;

  struct Tasks;  ///< the cases' trees and the keys; internal to this folder
  const study::PointSet& points() const { return *points_; }
  /// Names of all columns of a row, in order.
  std::vector<std::string> columns() const;
  /// The task of a point. @throws InputError if its values make no valid task
  Task task(std::size_t index) const;
  /// Paths of the cases' task files.
  std::vector<std::string> task_paths() const;
  /// A point's line of rows.jsonl. Never throws for a bad point. The column `point` is "bad" if the values make no
  /// valid task, "error" if every computation ended with an error, else "ok". `reason` gives the error.
  /// @param method_seconds  if not null, receives the time spent inside the computations
  std::string row(std::size_t index, double* method_seconds = nullptr) const;
  /// The row of a point whose process died or was killed: `point` is "lost".
  std::string lost_row(std::size_t index, const std::string& reason) const;
  /// Hash over everything that rows depend on, 16 hexadecimal digits; figures, labels and notes do not count.
  const std::string& hash() const { return hash_; }

 private:
  friend class StudyReader;
  std::shared_ptr<const study::PointSet> points_;
  std::shared_ptr<const Tasks> tasks_;
  std::string hash_;
};

inline constexpr std::size_t most_probed = 1000;

/// Reads STUDY.toml (see README). Paths of tasks in it are relative to it. A point whose values make no task gets a
/// row, and the study is still valid. A study is refused only if none of the probed points of a case makes a task, all
/// for a reason at the same place. Up to `most_probed` points are probed: all points, or as many spread over them. The
/// place is the task file, the case's `set`, or one variation; the error then stands at its `key`.
/// @throws InputError with position: this error, unknown keys and solvers with a suggestion, empty axes, columns and
/// computations that do not exist, computations of a given filter if no case has one
Study read_study(const std::string& path);

}  // namespace accdec
