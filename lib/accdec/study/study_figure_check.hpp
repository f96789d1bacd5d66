#pragma once

#include <optional>
#include <string>
#include <vector>

#include <accdec/study/study_file.hpp>

namespace accdec {

/// What is wrong with a figure of a study, and at which of its keys.
struct FigureFault {
  std::string key, message;
};

/// Whether a figure, its columns known to exist, shows what it seems to: every varied quantity is on it or fixed by
/// `where` at a value the quantity takes (in a Latin hypercube only cases can be fixed: curves are drawn as points,
/// heat maps of numbers are refused), axes are numbers, positive where logarithmic, curves are not too many, and
/// `labels` one each. Spells `where` as the table does and fills in `members` and `points_only`.
std::optional<FigureFault> check_study_figure(StudyFigure& figure, const Study& study, bool grid);

/// Columns as the title of an axis: "optimum.cycle_time_ms" becomes "optimum: cycle time / ms"; of several, what they
/// have in common after the dot, else the first. A variation whose name has no unit takes that of its task key.
std::string axis_title(const std::vector<std::string>& columns, const Study& study);
std::string axis_title(const std::string& column, const std::string& unit);
/// Unit by a column's suffix, "" if it has none.
std::string unit_of(const std::string& column);

}  // namespace accdec
