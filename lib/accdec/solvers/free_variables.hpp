#pragma once

#include <span>
#include <vector>

#include <accdec/problem.hpp>

namespace accdec::solvers {

/// The variables that are not fixed by their bounds. Several libraries mishandle or refuse lower == upper, so fixed
/// variables never reach them.
class FreeVariables {
 public:
  FreeVariables(const nlp::Problem& problem, std::span<const double> start) : full_(start.begin(), start.end()) {
    for (int i = 0; i < problem.num_variables(); ++i) {
      const nlp::Bound b = problem.variable_bound(i);
      position_.push_back(b.lower < b.upper ? static_cast<int>(index_.size()) : -1);
      if (b.lower < b.upper) index_.push_back(static_cast<std::size_t>(i)), bounds_.push_back(b);
    }
  }
  std::size_t size() const { return index_.size(); }
  nlp::Bound bound(std::size_t i) const { return bounds_[i]; }
  /// Position among the free variables, -1 for a fixed one.
  int position(int variable) const { return position_[static_cast<std::size_t>(variable)]; }
  /// All variables, the fixed ones at their value.
  const std::vector<double>& expand(const double* free) {
    for (std::size_t i = 0; i < index_.size(); ++i) full_[index_[i]] = free[i];
    return full_;
  }
  std::vector<double> restrict(std::span<const double> full) const {
    std::vector<double> free;
    for (const std::size_t i : index_) free.push_back(full[i]);
    return free;
  }
  void restrict(std::span<const double> full, double* free) const {
    for (std::size_t i = 0; i < index_.size(); ++i) free[i] = full[index_[i]];
  }

 private:
  std::vector<std::size_t> index_;
  std::vector<int> position_;
  std::vector<nlp::Bound> bounds_;
  std::vector<double> full_;
};

}  // namespace accdec::solvers
