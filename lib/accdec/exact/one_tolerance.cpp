#include <algorithm>

#include <accdec/exact/minimal_conflict.hpp>
#include <accdec/exact/one_tolerance.hpp>
#include <accdec/exact/search.hpp>
#include <accdec/exact/size.hpp>

namespace accdec::exact {
namespace {

/// Linear programs for each corner. Such proofs take a few tens.
constexpr long most_programs = 300;

}  // namespace

std::optional<Proof> refute_one_tolerance(const Task& task, const std::function<bool()>& late,
                                          const std::function<bool()>& stop) try {
  const auto given = [](const TaskCorner& corner) { return corner.delay.has_value(); };
  const auto bounded = [](const TaskCorner& corner) {
    return corner.error_max || corner.contour_max || corner.speed_min > 0.0;
  };
  if (task.corners.size() < 2) return std::nullopt;
  for (std::size_t j = 0; j < task.corners.size() && !late(); ++j) {
    if (!bounded(task.corners[j]) || !given(task.corners[j])) continue;
    Task part = task;
    for (std::size_t i = 0; i < part.corners.size(); ++i) {
      if (i != j) part.corners[i].error_max.reset(), part.corners[i].contour_max.reset(), part.corners[i].speed_min = 0;
    }
    Workbench bench(part, late);
    Search search(bench);
    bench.allow(most_programs);
    if (search.below(unlimited) != Search::Answer::proved) continue;
    search.proof.conflict = find_conflict(part, stop).limits;
    return std::move(search.proof);
  }
  return std::nullopt;
} catch (const TooLarge&) {
  return std::nullopt;
}

}  // namespace accdec::exact
