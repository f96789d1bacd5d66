#pragma once

#include <atomic>
#include <functional>
#include <optional>

#include <accdec/task/result.hpp>
#include <accdec/task/task.hpp>

namespace accdec {

/// Where the search stands, in s of cycle time.
struct ExactProgress {
  double bound = 0.0;      ///< nothing is shorter
  double incumbent = 0.0;  ///< best verified design; infinite before the first
  double gap = 1.0;        ///< (incumbent - bound)/incumbent
};

struct ExactOptions {
  double time_limit = 600.0;  ///< s
  double gap = 0.0;           ///< ends once (best - bound)/best is at most this
  std::function<void(const ExactProgress&)> progress;
  const std::atomic<bool>* cancel = nullptr;
  bool certificate = true;        ///< keep the proof in the result
  int threads = 1;                ///< for proofs of several corners; design and proof do not depend on it
  std::optional<Filter> start{};  ///< a design known from elsewhere: only what is shorter is looked for
};

/// Shortest weighted cycle time over filter, order and delays by branch and bound on the delays d_j and the samples k_j
/// at which the corner errors are bounded. In a box of delays and samples the leg distances are at least those at the
/// last k for leg 1 and at the first k and last d for leg 2, and the order at most what the target leaves; so one
/// linear program with tangent cuts for the cones refutes a whole box, and its dual multipliers, kept in the
/// certificate, are the proof.
///
/// Power, regeneration and smallest speed are not convex: each is relaxed to its chord over the speeds or directions
/// that the box leaves, and where the linear program's filter breaks the limit itself, the box is split on a
/// cumulative response B_k, which bounds the speed. What the limits on starts and stops can reach from there narrows
/// all other responses. Designs come from the linear programs' filters by a convex-concave procedure.
///
/// Several corners are proved jointly, see joint.hpp; symmetric filters of several corners, and tasks of which no first
/// design is known, by boxes that hold the delays of all corners.
/// @param task  without a filter; delays given or not
DesignResult design_exact(const Task& task, const ExactOptions& options = {});

}  // namespace accdec
