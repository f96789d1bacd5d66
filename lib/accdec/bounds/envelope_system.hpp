#pragma once

#include <cstddef>
#include <vector>

namespace accdec {

/// A symmetric system of equations with few entries beside its diagonal. Every row has entries from a first column on.
/// It is factored as L D L' in its order, without pivots. That exists for every quasi-definite matrix.
class EnvelopeSystem {
 public:
  /// @param first  column of every row, up to the row itself
  explicit EnvelopeSystem(std::vector<std::size_t> first);
  void clear() { entries_.assign(entries_.size(), 0.0); }
  void add(std::size_t i, std::size_t j, double value) { at(i < j ? j : i, i < j ? i : j) += value; }
  double diagonal(std::size_t i) const { return entries_[begin_[i] + i - first_[i]]; }
  /// Solves it for one right side, which becomes the answer; the matrix becomes its factors.
  void solve(std::vector<double>& x);
  /// Products of one factorisation.
  double work() const;

 private:
  double& at(std::size_t row, std::size_t column) { return entries_[begin_[row] + column - first_[row]]; }
  void factor();

  std::vector<std::size_t> first_, begin_;
  std::vector<double> entries_, pivots_;
};

}  // namespace accdec
