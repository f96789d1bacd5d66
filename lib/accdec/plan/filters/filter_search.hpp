#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <accdec/plan/command/choose_feeds.hpp>

namespace accdec {

/// The filters to search, and the time for it.
struct FilterSearchOptions {
  int order_min = 1, order_max = 400;
  double time_limit = 60.0;                          ///< s
  std::function<void(const std::string&)> progress;  ///< one line per step, may be empty
  std::vector<double> smoothing{};                   ///< taps of the control's own behind every filter; empty: none
};

/// The filter found, and the number of filters scheduled for it.
struct FilterSearch {
  std::optional<Filter> filter;  ///< none if none holds
  long evaluations = 0;
};

/// The trapezoid (boxcar if no axis limits jerk) with which a program with chosen feeds takes the least time. It is
/// found by a coarse grid of both lengths, then by steps around the best that are halved. Each is judged by a simulated
/// schedule; long programs by four of their stretches. Every filter must hold the vibration bounds. If no plan holds
/// within the time, the filter is the one with which a plan that stops at every joint takes the least.
FilterSearch search_filter(const Toolpath& path, double sample_period, const Machine& machine,
                           const FilterSearchOptions& options);

}  // namespace accdec
