#pragma once

#include <optional>

#include <accdec/plot/figure.hpp>
#include <accdec/study/optima.hpp>

namespace accdec {

/// A task's optimum beside the best two averages and the best exponential. It shows taps, the speed along the first
/// corner's path from rest to rest, and the use of the limit that the optimum uses most, on that axis.
/// Nothing without a design; families that hold no filter are left out.
std::optional<Figure> filters_figure(const study::Optimum& optimum);

}  // namespace accdec
