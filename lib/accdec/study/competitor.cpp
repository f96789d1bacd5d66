#include <accdec/study/competitor.hpp>

#include <algorithm>

namespace accdec::study {

bool takes_both_forms(const solvers::Solver& solver) {
  const solvers::Capabilities can = solver.capabilities();
  return can.equality_rows && !can.needs_finite_bounds && !can.linear_only;
}

bool Competitor::wants_reduced(const std::vector<std::string>& reduced) const {
  if (form != Form::suited) return form == Form::reduced;
  const solvers::Capabilities can = registered().capabilities();
  return !can.equality_rows || can.needs_finite_bounds || std::find(reduced.begin(), reduced.end(), solver) != reduced.end();
}

Competitor competitor_from_entry(const std::string& entry) {
  Competitor c;
  c.name = entry;
  c.solver = entry.substr(0, entry.find('/'));
  if (entry.ends_with("/sparse")) c.form = Competitor::Form::sparse;
  if (entry.ends_with("/reduced")) c.form = Competitor::Form::reduced;
  return c;
}

}  // namespace accdec::study
