#pragma once

#include <cstddef>
#include <vector>

namespace accdec::comparison {

/// A distribution as its steps: from x[i] on (inclusive) the share is y[i]; it is 0 before x[0]. x and y increase
/// strictly, and y is at most 1.
struct Distribution {
  std::vector<double> x, y;
};

/// Share of `total` items whose value is at most x. Values that are not finite never count, but their items stay in the
/// total.
/// @param total  >= the number of values, > 0; 0 stands for that number
Distribution distribution(std::vector<double> values, std::size_t total = 0);

/// Value of a distribution at x.
double at(const Distribution& d, double x);

/// r[s][p] = cost of solver s on problem p over the least cost of any solver there; infinite where the solver failed
/// (infinite cost). The share of problems with r <= tau is the performance profile: E. Dolan, J. More, Math. Program.
/// 91 (2002) 201-213.
/// @param costs  [solver][problem], > 0 or infinite
/// @param among  solvers whose least cost is the divisor, so that others, for example their own variants, take no wins
///               from them; empty: all. The ratio of another solver may then be below 1, and 0 if it alone succeeds.
/// @throws std::invalid_argument if the solvers' lists differ in length or a cost is not positive.
std::vector<std::vector<double>> performance_ratios(const std::vector<std::vector<double>>& costs,
                                                    const std::vector<std::size_t>& among = {});

/// Evaluations over the n + 1 that a simplex gradient takes. The share of problems with at most alpha is the data
/// profile: J. More, S. Wild, SIAM J. Optim. 20 (2009) 172-191.
/// @param evaluations  until the target was met, infinite where it never was
/// @param variables    n of each problem
/// @throws std::invalid_argument if the lists differ in length.
std::vector<double> simplex_gradients(const std::vector<double>& evaluations, const std::vector<int>& variables);

struct Quartiles {
  double lower = 0.0, median = 0.0, upper = 0.0;
};
/// By linear interpolation between order statistics (Hyndman and Fan's type 7). Infinite values are allowed. Without
/// values, all quartiles are NaN.
Quartiles quartiles(std::vector<double> values);

}  // namespace accdec::comparison
