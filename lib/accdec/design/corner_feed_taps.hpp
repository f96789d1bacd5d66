#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <accdec/certificate.hpp>
#include <accdec/design.hpp>

// Internal to the room: free taps for a control that passes corners at parts of their feeds.

namespace accdec {

/// A lower bound on all designs, and its proof. Unlimited if there are none.
struct CornerFeedBound {
  double samples = 0.0;                            ///< of the task's objective
  std::shared_ptr<const Certificate> certificate;  ///< null if the time ended before it
  std::string none{};                              ///< why there are none, where that is known
};

/// For controls that pass corners at parts of the feed, at feed and by exact stops alone. All limits must be in
/// proportion to the feed: accelerations, jerks, forces of masses alone, tolerances, modes without damping. With each
/// corner's part given, the shortest filter is a design task of its own. The least cost of all parts is proved if one
/// of them has a filter of its order. Few corners: their ways are listed.
/// @param best  samples of the best design known  @param offer  takes the filters met; returns the same with them
/// @return none: nothing is proved
std::optional<CornerFeedBound> prove_corner_feeds(const Task& task, const DesignOptions& options, double seconds,
                                                  double best, const std::function<double(const Filter&)>& offer);

}  // namespace accdec
