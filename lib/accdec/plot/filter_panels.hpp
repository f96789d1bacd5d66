#pragma once

#include <string>

#include <accdec/filter.hpp>
#include <accdec/plot/figure.hpp>
#include <accdec/result.hpp>

// Internal to the library.

namespace accdec {

inline constexpr double binding = 0.99;  ///< share of a limit from which a drawing calls it binding

/// How much of a limit a result uses; null if it is not among its limits. @param corner  empty: of the filter
const LimitUse* use_of(const DesignResult& result, LimitKind kind, const std::string& corner);
/// " 99.5 % used, binding".
std::string use_in_title(const LimitUse& use);

/// The filter's taps; those of `before` in grey below them, if not null.
Panel taps_panel(const Filter& filter, const Filter* before);
/// The frequency response with the bounds of the modes; that of `before` in grey below it, if not null.
Panel response_panel(const DesignResult& result, const Filter* before);

}  // namespace accdec
