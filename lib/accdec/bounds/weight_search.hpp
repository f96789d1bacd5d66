#pragma once

#include <functional>
#include <optional>

#include <accdec/bounds/weighted_motion.hpp>

namespace accdec {

/// The largest weighted_time that is found, s; 0 if none is.
///
/// For given times the sum in weighted_time is concave in the weights: linear functions less norms of linear ones. Its
/// least over the times is sought as a saddle point by Newton steps for weights and times at once. Every norm |v| is
/// smoothed, sqrt(v^2 + r^2), less from step to step. Its second derivatives are overestimated, as if its slope stayed
/// (E. Weiszfeld's method), but along v only half as much. Each step's weights give a bound by themselves.
/// @param work_left  products that may be spent, some 1 ns each: cuts legs into as many pieces as this allows.
///                   Lowered by those of the search
/// @param more  whether there is time left  @param best  receives the weights of that time; may be nullptr
double largest_weighted_time(const WeightedSection& section, double& work_left, const std::function<bool()>& more,
                             std::optional<MotionWeights>* best = nullptr);

}  // namespace accdec
