#include <algorithm>
#include <cmath>

#include <accdec/task/objective.hpp>

namespace accdec {

double LinearCost::operator()(int order, const std::vector<int>& delays) const {
  double samples = filter * (order + 1.0);
  for (std::size_t j = 0; j < delay.size(); ++j) samples += delay[j] * delays[j];
  return samples;
}

double LinearCost::given_delays(const Task& task) const {
  double samples = 0.0;
  for (std::size_t j = 0; j < delay.size(); ++j) samples += delay[j] * task.corners[j].delay.value_or(0);
  return samples;
}

bool LinearCost::whole() const {
  const auto whole = [](double x) { return x == std::floor(x); };
  return whole(filter) && std::all_of(delay.begin(), delay.end(), whole);
}

LinearCost cost_of(const Task& task, Objective objective) {
  LinearCost cost;
  double weights = 0.0;
  for (const TaskCorner& corner : task.corners) {
    cost.delay.push_back(corner.weight);
    weights += corner.weight;
  }
  cost.filter = objective == Objective::cycle ? task.design.runs : weights;
  return cost;
}

LinearCost cost_of(const Task& task) {
  return cost_of(task, task.design.objective);
}

double cycle_time(const Task& task, int order, const std::vector<int>& delays) {
  return cost_of(task, Objective::cycle)(order, delays) * task.sample_period;
}

double corner_time(const Task& task, int order, const std::vector<int>& delays) {
  return cost_of(task, Objective::corner)(order, delays) * task.sample_period;
}

double objective_time(const Task& task, int order, const std::vector<int>& delays) {
  return cost_of(task)(order, delays) * task.sample_period;
}

std::string_view to_string(Objective objective) {
  return objective == Objective::cycle ? "cycle" : "corner";
}

}  // namespace accdec
