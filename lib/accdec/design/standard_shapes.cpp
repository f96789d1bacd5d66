#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include <accdec/design/standard_shapes.hpp>
#include <accdec/motion/shapes.hpp>
#include <accdec/task/contradictions.hpp>
#include <accdec/task/delays_below.hpp>
#include <accdec/task/objective.hpp>
#include <accdec/task/verifier.hpp>

namespace accdec {
namespace {

/// Every member of a shape's family at one order.
std::vector<FilterSpec> members(Shape shape, int order) {
  std::vector<FilterSpec> all;
  FilterSpec spec;
  spec.kind = shape;
  spec.order = order;
  switch (shape) {
    case Shape::boxcar: all.push_back(spec); break;
    case Shape::trapezoid:
      for (spec.ramp = 0; spec.ramp <= order / 2; ++spec.ramp) all.push_back(spec);
      break;
    case Shape::s_curve:
    case Shape::hann:
    case Shape::blackman:
      if (order >= 2) all.push_back(spec);
      break;
    case Shape::blackman_sinc:
      for (int j = 1; order >= 2 && j <= blackman_sinc_cutoffs; ++j) {
        spec.cutoff = 2.0 / order * j / blackman_sinc_cutoffs;
        all.push_back(spec);
      }
      break;
    case Shape::taps: throw std::invalid_argument("given taps are no standard shape");
  }
  return all;
}

}  // namespace

StandardShapeResult best_standard_shape(const Task& task, Shape shape) {
  const auto began = std::chrono::steady_clock::now();
  StandardShapeResult answer;
  std::vector<int> best_delays;
  double best = unlimited;  // samples
  long tried = 0;
  const LinearCost cost = cost_of(task);
  const double fixed = cost.given_delays(task);

  std::string message;
  if (const auto impossible = contradictions(task); !impossible.empty()) message = impossible.front();
  for (int order = task.design.order_min; message.empty() && order <= task.design.order_max; ++order) {
    if (cost.filter * (order + 1.0) + fixed >= best) break;
    for (const FilterSpec& spec : members(shape, order)) {
      ++tried;
      const auto delays = delays_below(make_filter(spec), task, best);
      if (!delays) continue;
      best = cost(order, *delays);
      best_delays = *delays;
      answer.spec = spec;
    }
  }
  Task chosen = task;
  chosen.filter = answer.spec;
  if (answer.spec) {
    answer.result = assess(chosen, make_filter(*answer.spec), best_delays, false);
  } else {
    answer.result.task = task;
    answer.result.status = Status::infeasible;
    answer.result.message = message.empty() ? fmt::format("no {} of order {} to {} holds all limits", to_string(shape),
                                                          task.design.order_min, task.design.order_max)
                                            : message;
  }
  answer.result.solver.method = "given";
  answer.result.solver.name = fmt::format("best {}", to_string(shape));
  answer.result.solver.evaluations = tried;
  answer.result.solver.wall_time = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  return answer;
}

}  // namespace accdec
