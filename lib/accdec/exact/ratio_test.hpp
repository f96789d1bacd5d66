#pragma once

#include <cstddef>
#include <vector>

namespace accdec::exact {

/// The bound flipping ratio test of the dual simplex method (Maros, Eur. J. Oper. Res. 149, 2003): which column enters
/// the basis, and which bounded columns go to their other bounds before.
class RatioTest {
 public:
  struct Candidate {
    int position;
    double dual, size;  ///< |reduced cost| and |entry of the pivot row|
    double drop;        ///< of the leaving variable's infeasibility where it goes to its other bound
  };

  /// @param tolerance  on the leaving variable's infeasibility
  explicit RatioTest(double tolerance) : tolerance_(tolerance) {}
  void begin() { candidates_.clear(); }
  void add(const Candidate& candidate) { candidates_.push_back(candidate); }
  /// Moves bounded variables to their other bounds as long as the leaving variable stays outside its own.
  /// @param flips  set to their positions
  /// @return the position that enters; -1 if even all of them do not bring it back
  int choose(double infeasibility, std::vector<int>& flips);

 private:
  bool group_candidates(double infeasibility, bool in_one_go);
  std::size_t pass_over(std::size_t begin, double& slope);
  int best_of_last_groups() const;
  int best_of_group(std::size_t begin, std::size_t end) const;

  double tolerance_;
  std::vector<Candidate> candidates_;
  std::vector<std::size_t> group_end_;
};

}  // namespace accdec::exact
