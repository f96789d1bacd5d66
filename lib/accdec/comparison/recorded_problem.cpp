#include <algorithm>

#include <accdec/comparison/recorded_problem.hpp>
#include <accdec/files.hpp>

namespace accdec::comparison {

RecordedProblem::RecordedProblem(const nlp::Problem& problem, Judge judge, std::size_t most_bytes)
    : problem_(problem),
      judge_(std::move(judge)),
      most_points_(
          most_bytes / (sizeof(Point) + sizeof(double) * static_cast<std::size_t>(problem.num_variables() + 1)) + 1) {}

double RecordedProblem::objective(std::span<const double> x) const {
  const double value = problem_.objective(x);
  if (points_.size() >= most_points_) judge_points();
  const double time = seconds_since(began_);
  points_.push_back({std::max(++objectives_, rows_), time, {x.begin(), x.end()}});
  return value;
}

void RecordedProblem::rows(std::span<const double> x, std::span<double> c) const {
  ++rows_;
  problem_.rows(x, c);
}

void RecordedProblem::judge_points() const {
  for (Point& point : points_) {
    const double objective = judge_(point.x);
    if (!(objective < best_objective_)) continue;
    best_objective_ = objective;
    history_.push_back({point.evaluations, point.time, objective});
    best_ = std::move(point.x);
  }
  points_.clear();
}

const std::vector<nlp::Improvement>& RecordedProblem::history() {
  judge_points();
  return history_;
}

}  // namespace accdec::comparison
