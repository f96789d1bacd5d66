#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <variant>

#include <gtest/gtest.h>

#include <accdec/exact/exact.hpp>
#include <accdec/exact/parts.hpp>
#include <accdec/exact/relaxation.hpp>

#include "expect_proved.hpp"
#include "support/tasks.hpp"

// Dry friction of axes that reverse at a corner. By linear programs that share no code: tests/axes/reversals.py.

namespace accdec {
namespace {

using testing::expect_proved;
using testing::plane_corner;
using testing::plane_task;

Task random_reversal(std::mt19937& rng) {
  std::uniform_real_distribution<double> u(0.0, 1.0);
  Axis axis;
  axis.mass = 20.0 + 20.0 * u(rng), axis.damping = 200.0 * u(rng);
  axis.coulomb = 30.0 + 90.0 * u(rng), axis.force_max = 220.0 + 280.0 * u(rng);
  Task task = plane_task(
      axis, plane_corner("A", 15.0 + 70.0 * u(rng), 360.0 * u(rng), 0.07 + 0.15 * u(rng), 0.07 + 0.15 * u(rng)),
      20e-6 + 700e-6 * u(rng));
  task.sample_period = 4e-3;
  task.design.order_max = 12;
  return task;
}

/// Axes of the first corner that reverse.
std::vector<int> reversing(const Task& task) {
  std::vector<int> axes;
  const Corner& corner = task.corners.front().geometry();
  for (Eigen::Index a = 0; a < corner.axes(); ++a)
    if (corner.direction_in[a] * corner.direction_out[a] < 0.0) axes.push_back(static_cast<int>(a));
  return axes;
}

/// Whether a filter holds all limits with one delay and sample, and with every axis' reversal at one sample.
bool holds_at_any_reversal(exact::Relaxation& relaxation, const Task& task, exact::Box box) {
  const std::vector<int> axes = reversing(task);
  const int last = box.order + box.corners.front().d1 + 1;
  const auto any = [&](const auto& self, std::size_t next) -> bool {
    if (next == axes.size()) return relaxation.solve(box, task.design.symmetric).kind == exact::Outcome::feasible;
    for (int r = 1; r <= last; ++r) {
      box.reversals.push_back({0, axes[next], r, r});
      const bool holds = self(self, next + 1);
      box.reversals.pop_back();
      if (holds) return true;
    }
    return false;
  };
  return relaxation.solve(box, task.design.symmetric).kind != exact::Outcome::refuted && any(any, 0);
}

/// The least objective, samples, over all orders, delays, samples and reversals.
double least_of_all(const Task& task) {
  const exact::LimitModel model(task);
  double best = std::numeric_limits<double>::infinity();
  for (int n = task.design.order_min; n <= task.design.order_max; ++n) {
    exact::Relaxation relaxation(model, n);
    for (int d = 0; d <= n + 2 && n + 1 + d < best; ++d) {
      for (int k = 0; k <= n + d + 1 && n + 1 + d < best; ++k)
        if (holds_at_any_reversal(relaxation, task, {n, {{d, d, k, k}}})) best = n + 1 + d;
    }
  }
  return best;
}

bool splits_reversals(const std::vector<proof::Node>& tree) {
  return std::ranges::any_of(
      tree, [](const proof::Node& node) { return std::holds_alternative<proof::ReversalSplit>(node); });
}

/// In the tree of a proof, or of one of its lemmas.
bool splits_reversals(const DesignResult& result) {
  if (!result.certificate) return false;
  const auto* proof = std::get_if<proof::BranchAndBound>(&result.certificate->proof);
  return proof != nullptr &&
         (splits_reversals(proof->tree) ||
          std::ranges::any_of(proof->lemmas, [](const proof::Lemma& lemma) { return splits_reversals(lemma.tree); }));
}

TEST(ExactReversal, NothingIsShorterAtAnyReversal) {
  std::mt19937 rng(3);
  int split = 0;
  for (int i = 0; i < 40; ++i) {
    SCOPED_TRACE(i);
    Task task = random_reversal(rng);
    task.design.symmetric = i % 4 == 3;
    const DesignResult result = design_exact(task);
    expect_proved(task, result);
    const double expected = least_of_all(task);
    if (std::isinf(expected)) {
      EXPECT_EQ(result.status, Status::infeasible);
    } else {
      EXPECT_NEAR(result.objective() / task.sample_period, expected, 1e-9) << result.message;
    }
    if (splits_reversals(result)) ++split;
    if (HasFailure()) break;
  }
  EXPECT_GT(split, 5);
}

// With a force-speed curve, with a smallest speed, and of two corners.
TEST(ExactReversal, OtherLimitsAreProvedWithIt) {
  std::mt19937 rng(5);
  int split[3] = {0, 0, 0};
  for (int i = 0; i < 45; ++i) {
    SCOPED_TRACE(i);
    Task task = random_reversal(rng);
    for (Axis& axis : task.machine.axes) {
      if (i % 3 != 0) continue;
      axis.force_speed = {{0.0, axis.force_max}, {0.3, 0.7 * axis.force_max}}, axis.force_speed_max = axis.force_max;
      axis.force_max = unlimited;
    }
    if (i % 3 == 1) task.corners[0].speed_min = 0.1 * task.corners[0].geometry().feed_in;
    if (i % 3 == 2) {
      task.corners.push_back(plane_corner("B", 60.0, 20.0, 0.1, 0.1));
      task.corners.back().error_max = 300e-6, task.corners.back().weight = 2.0;
    }
    const DesignResult result = design_exact(task);
    expect_proved(task, result);
    if (splits_reversals(result)) ++split[i % 3];
    if (HasFailure()) break;
  }
  for (const int some : split) EXPECT_GT(some, 0);
}

/// Proofs with a split of a reversal moved, left out with one of its parts, or with its parts exchanged.
std::vector<proof::BranchAndBound> other_splits(const proof::BranchAndBound& proof) {
  std::vector<proof::BranchAndBound> others;
  for (std::size_t n = 0; n < proof.tree.size(); ++n) {
    if (!std::holds_alternative<proof::ReversalSplit>(proof.tree[n])) continue;
    const std::size_t second = exact::after(proof.tree, n + 1), end = exact::after(proof.tree, second);
    const auto at = [](std::vector<proof::Node>& tree, std::size_t i) {
      return tree.begin() + static_cast<std::ptrdiff_t>(i);
    };
    for (const int by : {-3, -1, 1, 3}) {
      others.push_back(proof);
      std::get<proof::ReversalSplit>(others.back().tree[n]).at += by;
    }
    others.push_back(proof);
    std::rotate(at(others.back().tree, n + 1), at(others.back().tree, second), at(others.back().tree, end));
    others.push_back(proof);
    others.back().tree.erase(at(others.back().tree, second), at(others.back().tree, end));
    others.back().tree.erase(at(others.back().tree, n));
    others.push_back(proof);
    others.back().tree.erase(at(others.back().tree, n), at(others.back().tree, second));
  }
  return others;
}

// With less friction a shorter design holds, and no proof that there is none may be accepted.
TEST(ExactReversal, OfLessFrictionNoProofIsAccepted) {
  std::mt19937 rng(7);
  int forged = 0;
  for (int i = 0; i < 60 && forged < 500; ++i) {
    const Task task = random_reversal(rng);
    DesignResult result = design_exact(task);
    if (!splits_reversals(result)) continue;
    Task lighter = task;
    for (Axis& axis : lighter.machine.axes) axis.coulomb *= 0.5;
    const DesignResult shorter = design_exact(lighter);
    if (!shorter.has_design() || (result.has_design() && shorter.objective() >= result.objective() * (1.0 - 1e-9)))
      continue;
    const auto proof = std::get<proof::BranchAndBound>(result.certificate->proof);
    EXPECT_FALSE(check_certificate(lighter, result).accepted);
    for (const proof::BranchAndBound& other : other_splits(proof)) {
      result.certificate = std::make_shared<Certificate>(Certificate{other});
      EXPECT_FALSE(check_certificate(lighter, result).accepted);
      ++forged;
    }
  }
  EXPECT_GT(forged, 50);
}

}  // namespace
}  // namespace accdec
