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
std::optional<FigureFault> complete_study_figure(StudyFigure& figure, const Study& study, bool grid);

}  // namespace accdec
