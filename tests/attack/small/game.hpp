#pragma once

#include <cstddef>
#include <vector>

namespace accdec::attack {

/// The least worst use of limits by any filter: min over b >= 0, sum b = 1 of max over rows a of a . b. It is the value
/// of a matrix game. So both sides of an answer are checked without trusting the simplex method: taps show a reachable
/// value, and weights on the rows prove that no smaller one is.
class Game {
 public:
  /// @param most  no entry of any row is larger in magnitude
  Game(std::size_t taps, double most);

  void add(const double* row);
  /// Dense dual simplex from where the last call ended. False if rounding kept it from ending.
  bool solve();

  /// After solve(): optimal taps, sum 1.
  const std::vector<double>& taps() const { return best_; }
  /// Proved: no taps use all limits less. From the weights and the rows as they were added.
  double lower() const { return lower_; }

 private:
  void pivot(std::size_t row, std::size_t column);
  void read();

  std::size_t n_;
  double shift_;                               // added to all entries: the value becomes positive
  std::vector<double> rows_;                   // as added, n a row
  std::vector<double> table_;                  // n + 1 a row: basic = last - sum of the others times nonbasic
  std::vector<double> reduced_;                // n + 1: objective = last + sum of the others times nonbasic
  std::vector<std::size_t> basic_, nonbasic_;  // below n a tap over the value, from n on the slack of a row
  std::vector<double> best_;
  double lower_ = 0.0;
};

}  // namespace accdec::attack
