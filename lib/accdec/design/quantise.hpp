#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include <accdec/design.hpp>
#include <accdec/result.hpp>

namespace accdec {

/// Whole numbers c_i >= 0 of sum 2^bits for the taps c_i / 2^bits.
using Coefficients = std::vector<std::int64_t>;

/// The filter of these coefficients; their sum must be a power of two, so that its taps are exact.
Filter filter_of_coefficients(const Coefficients& coefficients);

/// The coefficients of a filter whose taps all are multiples of 2^-bits; none if one is not.
/// @param bits  1 to 52
std::optional<Coefficients> exact_coefficients(const Filter& filter, int bits);

/// Rounds the taps so that all limits hold at the same delays: by the largest remainders, and by rounding the
/// cumulative response. If that breaks a limit, single units are exchanged between taps as long as this lowers the
/// sum of the violations.
/// @param delays  one per corner, samples
/// @param stop    polled between filters; may be empty
/// @return verified by simulation; none if no rounding was found that holds all limits
std::optional<Coefficients> round_under_limits(const Task& task, const Filter& filter, const std::vector<int>& delays,
                                               int bits, const std::function<bool()>& stop = {});

/// A design whose taps are multiples of 2^-bits, bits from `task.design.coefficient_bits`. The optimum of free taps
/// comes first, with half of the time. Then filters with room for the rounding are looked for, with limits tightened by
/// the largest effect of a rounding, or by a part of it. First the order and the delays are the optimum's, then any.
/// Cascades of averages follow whose lengths are powers of two: their coefficients are whole. Then the order is longer.
/// At last neighbours of the best coefficients are tried with shorter delays. Each filter is rounded by
/// `round_under_limits` and gets its smallest delays, or the cheapest ones of the kinds that the task's controller has.
/// The lower bound and its proof are those of free taps. `optimal` means that nothing is lost.
DesignResult design_quantised(const Task& task, const DesignOptions& options);

}  // namespace accdec
