#pragma once

#include <accdec/plan/command/program_plan.hpp>

namespace accdec {

/// A plan whose repair may end before it holds.
struct LimitedPlan {
  ProgramPlan plan;
  double repairs = 0.0;  ///< joints and blocks that were changed and simulated again, each as often as that was done
};

/// plan_program without tuned curves, for a search of many plans. Hopeless ones end after the same work on every
/// machine.
/// @param repairs_max  of LimitedPlan::repairs, for one start of its feeds
LimitedPlan plan_with_limited_repair(Toolpath& path, const Filter& filter, double sample_period, const Machine& machine,
                                     const Deadline& deadline, double repairs_max);

}  // namespace accdec
