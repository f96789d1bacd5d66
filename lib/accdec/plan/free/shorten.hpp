#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include <accdec/plan/free/free_path.hpp>

namespace accdec {

/// A part of a motion that is shortened by itself: samples begin .. end - 1 may move. Those around it stay, so parts
/// that are `border` samples apart do not see each other.
struct FreePart {
  std::size_t begin = 0, end = 0;              ///< samples
  std::size_t first_joint = 0, end_joint = 0;  ///< passed between begin - 1 and end
  std::vector<double> passes{};                ///< of its joints, counted from the part's begin on
};

/// A part's new samples, and the passes of its joints counted from the part's begin on.
struct ShortenedPart {
  std::vector<double> position;  ///< rows
  std::vector<double> passes;
  std::size_t saved = 0;  ///< samples; 0: the part stays as it is
  std::size_t moved = 0;  ///< samples that are new; behind them are the old ones, `saved` samples earlier
  int programmes = 0, iterations = 0;
};

/// Shortens a part window by window, by whole samples in the end.
/// @param position  rows of the whole motion
/// @param size      samples of a window
/// @param stop      whether to end as soon as the motion so far can be joined to the rest
ShortenedPart shorten(const FreePath& free, const std::vector<double>& position, const FreePart& part, std::size_t size,
                      const std::function<bool()>& stop);

/// A part as one window, with as few samples as there is a motion for. The part itself may break limits: so two
/// motions are joined that nearly meet in it.
/// @param more  samples that may be added
/// @returns none if there is no motion
std::optional<ShortenedPart> shorten_at_once(const FreePath& free, const std::vector<double>& position,
                                             const FreePart& part, int more);

/// Whether the samples of a part keep to its tube, its feeds, and the tolerances of its joints.
/// @param row  sample of the part, counted from its begin on: -1 .. count
bool keeps_path(const FreePath& free, const FreePart& part, std::size_t count, const std::vector<double>& passes,
                const std::function<const double*(std::ptrdiff_t)>& row);

}  // namespace accdec
