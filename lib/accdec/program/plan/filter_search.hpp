#pragma once

#include <functional>
#include <optional>
#include <string>

#include <accdec/program/plan/choose_feeds.hpp>

namespace accdec {

/// Which filters are looked at, and for how long.
struct FilterSearchOptions {
  int order_min = 1, order_max = 400;
  double time_limit = 60.0;                          ///< s
  std::function<void(const std::string&)> progress;  ///< one line a step, may be empty
};

/// A filter that was found, and how many were scheduled to find it.
struct FilterSearch {
  std::optional<Filter> filter;  ///< none if none holds
  long evaluations = 0;
};

/// The trapezoid (boxcar where no axis limits jerk) with which a program whose feeds are chosen takes least time: a
/// coarse grid of both lengths, then steps around the best that halve. Each is judged by a schedule that was simulated;
/// long programs by four stretches of them. Vibration bounds are asked of every filter.
FilterSearch search_filter(const Toolpath& path, double sample_period, const Machine& machine,
                           const FilterSearchOptions& options);

}  // namespace accdec
