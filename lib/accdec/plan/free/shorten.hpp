#pragma once

#include <cstddef>
#include <functional>

#include <accdec/plan/free/free_path.hpp>

namespace accdec {

/// A part of a motion that is shortened by itself: samples begin .. end - 1 may move. Those around it stay, so parts
/// that are `border` samples apart do not see each other.
struct FreePart {
  std::size_t begin = 0, end = 0;              ///< samples
  std::size_t first_joint = 0, end_joint = 0;  ///< passed between begin - 1 and end
};

/// A part's new samples and passes (samples of the whole motion as it was, counted from the part's begin on).
struct ShortenedPart {
  std::vector<double> position;  ///< rows
  std::vector<double> passes;    ///< of its joints
  std::size_t saved = 0;         ///< samples; 0: the part stays as it is
  int programmes = 0, iterations = 0;
};

/// Shortens a part window by window, by whole samples in the end.
/// @param size  samples of a window
/// @param stop  whether to end as soon as the motion so far can be joined to the rest
ShortenedPart shorten(const FreePath& free, const FreeSamples& motion, const FreePart& part, std::size_t size,
                      const std::function<bool()>& stop);

}  // namespace accdec
