#pragma once

#include <optional>
#include <string>
#include <vector>

#include <accdec/study/study_file.hpp>

namespace accdec {

/// An error in a figure of a study, and its key.
struct FigureFault {
  std::string key, message;
};

/// Checks that a figure shows what it seems to; its columns are known to exist. Every varied quantity must be on it or
/// be fixed by `where` at one of its values. In a Latin hypercube only cases can be fixed: curves are drawn as points,
/// and heat maps of numbers are refused. Axes must be numbers, positive where logarithmic. There must not be too many
/// curves, and each needs one of the `labels`. Writes `where` as the table does and fills in `members` and
/// `points_only`.
std::optional<FigureFault> complete_study_figure(StudyFigure& figure, const Study& study, bool grid);

}  // namespace accdec
