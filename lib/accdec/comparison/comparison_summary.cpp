#include <stdexcept>

#include <accdec/comparison/comparison_report.hpp>
#include <accdec/formats/design_report.hpp>

namespace accdec {

std::string summary_text(const comparison::ComparisonData& data) {
  struct Column {
    const char* name;
    const char* shown;
  };
  constexpr Column columns[] = {{"solver", "solver"},
                                {"runs", "runs"},
                                {"reference reached", "reached"},
                                {"stationary, worse", "worse"},
                                {"feasible only", "feasible"},
                                {"breaks a limit", "broken"},
                                {"no point", "none"},
                                {"infeasible recognised", "infeasible"},
                                {"refused", "refused"},
                                {"killed or crashed", "killed"},
                                {"wrong claims", "wrong claims"},
                                {"time to end median / s", "median s"},
                                {"evaluations median", "evaluations"}};
  const ComparisonTable all = summary_table(data);
  std::vector<std::string> head;
  std::vector<std::size_t> places;
  for (const Column& column : columns) {
    std::size_t c = 0;
    while (c < all.head.size() && all.head[c] != column.name) ++c;
    if (c == all.head.size()) throw std::logic_error("the summary has no such column");
    head.emplace_back(column.shown);
    places.push_back(c);
  }
  TextTable table(head);
  for (const auto& row : all.rows) {
    std::vector<std::string> cells;
    for (const std::size_t c : places) cells.push_back(row[c].empty() ? "-" : row[c]);
    table.add(std::move(cells));
  }
  return table.str();
}

}  // namespace accdec
