#pragma once

#include <accdec/corner.hpp>
#include <accdec/machine/response.hpp>

namespace accdec {

/// Measures of a blend behind a machine's response. If axes respond differently, every axis has its own filter. The
/// path then is not of the form p and q times the two legs' directions. O(axes (N + d)).
/// @param delay  samples, >= 0
CornerMeasures measure(const FilterBehind& behind, const Corner& corner, int delay, double sample_period);

/// Distance from the line of a leg at constant feed, m: every axis lags by the mean delay of its own motion.
/// @param direction  of length 1  @param step  m, of a sample
double off_line(const FilterBehind& behind, const Eigen::VectorXd& direction, double step);

/// The same k samples after a start from rest. Steps of the feed that follow each other upwards from rest leave the
/// line by no more than the largest of these: they are sums of such starts.
double off_line_after(const FilterBehind& behind, const Eigen::VectorXd& direction, double step, int k);

/// The corner error alone.
double corner_error(const FilterBehind& behind, const Corner& corner, int delay, double sample_period);

}  // namespace accdec
