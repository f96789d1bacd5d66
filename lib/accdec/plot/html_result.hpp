#pragma once

#include <string>

#include <accdec/plot/figure.hpp>
#include <accdec/result.hpp>

namespace accdec {

/// A page of a design: the answer in a sentence, its numbers beside the figure, the taps and the task folded away. It
/// is self-contained, as every page (plot/html.hpp).
/// @param figure  of plot_result, which throws where the result has no filter
/// @param svg     its drawing
std::string html_result_page(const DesignResult& result, const Figure& figure, const std::string& svg);

}  // namespace accdec
