#pragma once

#include <atomic>
#include <functional>
#include <optional>

#include <accdec/result.hpp>
#include <accdec/task.hpp>

namespace accdec {

/// The state of the search, in s of cycle time.
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
  int threads = 1;                ///< used for proofs of several corners; the design and the proof do not depend on it
  std::optional<Filter> start{};  ///< a design known from elsewhere: only shorter ones are looked for
};

/// Finds the shortest weighted cycle time over filter, order and delays. It branches and bounds on the delays d_j and
/// the samples k_j at which the corner errors are bounded. In a box of delays and samples, the distance along leg 1 is
/// smallest at the last k. The distance along leg 2 is smallest at the first k and the last d. The order is at most
/// what the target leaves. So one linear program with tangent cuts for the cones refutes a whole box. Its dual
/// multipliers are kept in the certificate and are the proof.
///
/// Power, regeneration and smallest speed are not convex. Each is relaxed to its chord over the speeds or directions
/// that the box leaves. If the linear program's filter breaks such a limit, the box is split on a cumulative response
/// B_k, which bounds the speed. The limits on starts and stops then narrow all other responses. Designs come from the
/// linear programs' filters by a convex-concave procedure.
///
/// Several corners are proved jointly, see joint.hpp. Symmetric filters of several corners, and tasks without a known
/// first design, are proved by boxes that hold the delays of all corners.
/// @param task  without a filter; delays given or not
DesignResult design_exact(const Task& task, const ExactOptions& options = {});

}  // namespace accdec
