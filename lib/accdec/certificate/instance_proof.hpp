#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <accdec/certificate.hpp>
#include <accdec/task.hpp>

namespace accdec {

/// Proof of a lower bound of a `margin` or `delay` problem, or that no filter holds its limits; `accdec.refutation/1`
/// in JSON. These problems fix the order, where limits of the blends are imposed and, for `margin`, the samples of the
/// corner errors. So their bounds are none of a task, and this is no result.
struct InstanceProof {
  Task task;              ///< the problem's
  bool of_delay = false;  ///< a `delay` problem, else `margin`
  struct Place {
    int order = 0;
    std::vector<int> delays;                         ///< of every corner
    std::vector<int> samples;                        ///< of every corner's error; only of `margin`
    std::vector<std::vector<double>> frequencies{};  ///< Hz, by mode: those at which it is bounded
    bool operator==(const Place&) const = default;
  } at;
  std::optional<double> lower{};  ///< nothing is below; none: no filter holds all limits
  struct Part {
    /// A `delay` problem's bound is the sum of what each corner needs by itself; other proofs have one part without.
    std::optional<int> corner{};
    double delay = 0.0;  ///< samples that the corner needs more than
    Certificate certificate{};
  };
  std::vector<Part> parts;
};

/// Rechecks what a refutation claims, and only that.
/// @param stop  polled; true ends the check, which then has accepted nothing
CheckReport check_instance_proof(const InstanceProof& refutation, const std::function<bool()>& stop = {});

}  // namespace accdec
