#include <algorithm>
#include <stdexcept>

#include <accdec/comparison/competitor.hpp>
#include <accdec/comparison/external_solver.hpp>
#include <accdec/problem.hpp>

namespace accdec::comparison {
namespace {

/// minimise x over 0 <= x <= 1: every solver accepts it.
class Line final : public nlp::Problem {
 public:
  std::string name() const override { return "line"; }
  int num_variables() const override { return 1; }
  int num_rows() const override { return 0; }
  nlp::ProblemClass problem_class() const override { return nlp::ProblemClass::linear; }
  nlp::Bound variable_bound(int) const override { return {0.0, 1.0}; }
  nlp::Bound row_bound(int) const override { return {}; }
  double objective(std::span<const double> x) const override { return x[0]; }
  void gradient(std::span<const double>, std::span<double> g) const override { g[0] = 1.0; }
  void rows(std::span<const double>, std::span<double>) const override {}
  const std::vector<nlp::Entry>& jacobian_pattern() const override { return none_; }
  void jacobian(std::span<const double>, std::span<double>) const override {}
  const std::vector<nlp::Entry>& hessian_pattern() const override { return none_; }
  void hessian(std::span<const double>, double, std::span<const double>, std::span<double>) const override {}

 private:
  std::vector<nlp::Entry> none_;
};

/// Stands for the exact method where solvers are listed; Comparison calls the method itself.
class ExactMethod final : public solvers::Solver {
 public:
  std::string name() const override { return exact_name; }
  std::string library_version() const override { return "accdec"; }
  solvers::Capabilities capabilities() const override {
    solvers::Capabilities can;
    can.linear_only = can.global = can.integers = true;
    return can;
  }
  std::string settings() const override { return "one thread, with its certificate"; }

 protected:
  solvers::Result do_solve(const nlp::Problem&, std::span<const double>, const solvers::Options&) const override {
    throw std::logic_error("the exact method takes tasks");
  }
};

}  // namespace

const ExternalSolver* Competitor::program() const {
  return dynamic_cast<const ExternalSolver*>(external.get());
}

void Competitor::warm_up() const {
  if (external) return;
  solvers::Options options;
  options.native = native;
  options.time_limit = 0.01;  // random searches would run for a second
  options.evaluation_limit = 10;
  registered().solve(Line(), std::vector<double>{0.5}, options);
}

bool takes_both_forms(const solvers::Solver& solver) {
  const solvers::Capabilities can = solver.capabilities();
  return can.equality_rows && !can.needs_finite_bounds && !can.linear_only;
}

bool Competitor::wants_reduced(const std::vector<std::string>& reduced) const {
  if (form != Form::suited) return form == Form::reduced;
  const solvers::Capabilities can = registered().capabilities();
  return !can.equality_rows || can.needs_finite_bounds ||
         std::find(reduced.begin(), reduced.end(), solver) != reduced.end();
}

Competitor competitor_from_entry(const std::string& entry) {
  Competitor c;
  c.name = entry;
  c.solver = entry.substr(0, entry.find('/'));
  if (c.is_exact()) c.external = std::make_shared<ExactMethod>();
  if (entry.ends_with("/sparse")) c.form = Competitor::Form::sparse;
  if (entry.ends_with("/reduced")) c.form = Competitor::Form::reduced;
  return c;
}

}  // namespace accdec::comparison
