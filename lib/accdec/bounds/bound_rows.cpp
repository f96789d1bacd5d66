#include <algorithm>
#include <cmath>

#include <accdec/bounds/bound_rows.hpp>
#include <accdec/bounds/row_duals.hpp>
#include <accdec/solvers/module.hpp>

namespace accdec {

void BoundRows::add(const std::vector<std::pair<int, double>>& entries, double low, double high) {
  std::vector<std::pair<int, double>> row = entries;
  std::sort(row.begin(), row.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::size_t kept = 0;
  for (const auto& entry : row) {
    if (kept > 0 && row[kept - 1].first == entry.first) {
      row[kept - 1].second += entry.second;
    } else {
      row[kept++] = entry;
    }
  }
  row.resize(kept);
  rows_.push_back(std::move(row));
  low_.push_back(low);
  high_.push_back(high);
}

double BoundRows::Multipliers::least(const std::vector<double>& costs, const std::vector<double>& low,
                                     const std::vector<double>& high) const {
  double sum = sides;
  for (std::size_t j = 0; j < costs.size(); ++j) {
    const double left = costs[j] - part[j];
    sum += std::min(left * low[j], left * high[j]);
  }
  return sum;
}

BoundRows::Multipliers BoundRows::multipliers(const std::vector<double>& costs, const std::vector<double>& low,
                                              const std::vector<double>& high) const {
  RowProgram program{columns_, {0}, {}, {}, costs, low, high, low_, high_};
  for (const auto& row : rows_) {
    for (const auto& [column, factor] : row) {
      program.index.push_back(column);
      program.value.push_back(factor);
    }
    program.start.push_back(static_cast<int>(program.index.size()));
  }
  static auto* const row_duals = solvers::module_function<decltype(accdec_row_duals)>("clp", "accdec_row_duals");
  std::vector<double> dual;
  row_duals(program, dual);
  Multipliers result;
  result.part.assign(costs.size(), 0.0);
  if (dual.empty()) return result;
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const double side = dual[r] > 0.0 ? low_[r] : high_[r];
    if (dual[r] == 0.0 || !(std::abs(side) < 0.1 * none) || !std::isfinite(dual[r])) continue;
    result.sides += dual[r] * side;
    for (const auto& [column, factor] : rows_[r]) result.part[static_cast<std::size_t>(column)] += dual[r] * factor;
  }
  return result;
}

}  // namespace accdec
