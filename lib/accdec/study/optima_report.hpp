#pragma once

#include <string>
#include <utility>
#include <vector>

#include <accdec/study/optima.hpp>

namespace accdec {

/// The files of `accdec optima` except its manifest. optima.csv and optima.md have a row per task. optima.svg and .png
/// show every standard shape's cycle time over the optimum's. TASK-filters.svg and .png show every design (see
/// filters_figure.hpp). Unless `growth` is empty, growth.csv, growth.svg and .png show time, linear programs and proof
/// size against N + d.
/// @param growth  one task at ever shorter sample periods
/// @return file name and content
std::vector<std::pair<std::string, std::string>> optima_documents(const std::vector<study::Optimum>& optima,
                                                                  const std::vector<study::Optimum>& growth);

/// The table of optima.md in plain text.
std::string optima_text(const std::vector<study::Optimum>& optima);

}  // namespace accdec
