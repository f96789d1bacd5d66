#pragma once

#include <string>

#include <accdec/filter.hpp>

namespace accdec {

/// A filter as a task gives it, in milliseconds: "averages of 18 ms and 12 ms", "a Gaussian of 30 ms, alpha 2.4". Empty
/// for free taps, and for exponentials that rise.
std::string filter_in_words(const FilterSpec& filter, double period);

}  // namespace accdec
