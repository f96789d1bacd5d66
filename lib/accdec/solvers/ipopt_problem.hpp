#pragma once

#include <algorithm>
#include <cstddef>
#include <mutex>
#include <span>
#include <vector>

#include <IpTNLP.hpp>

#include <accdec/problem.hpp>

// Only for modules that link to Ipopt.

namespace accdec::solvers {

/// A problem as Ipopt and Bonmin see it. The exception StopRun never passes through them: a callback reports failure.
/// @tparam Base  Ipopt::TNLP or Bonmin::TMINLP, which have the same functions
template <class Base>
class IpoptProblem : public Base {
 public:
  IpoptProblem(nlp::Evaluator& evaluator, std::span<const double> start)
      : evaluator_(evaluator), start_(start.begin(), start.end()) {}

  bool get_nlp_info(Ipopt::Index& n, Ipopt::Index& m, Ipopt::Index& jacobian, Ipopt::Index& hessian,
                    Ipopt::TNLP::IndexStyleEnum& style) override {
    n = problem().num_variables();
    m = problem().num_rows();
    jacobian = static_cast<Ipopt::Index>(problem().jacobian_pattern().size());
    hessian = problem().has_hessian() ? static_cast<Ipopt::Index>(problem().hessian_pattern().size()) : 0;
    style = Ipopt::TNLP::C_STYLE;
    return true;
  }

  bool get_bounds_info(Ipopt::Index n, double* xl, double* xu, Ipopt::Index m, double* cl, double* cu) override {
    const auto fill = [](nlp::Bound b, double& lower, double& upper) {
      lower = std::max(b.lower, -2e19);  // beyond 1e19 Ipopt takes a bound as absent
      upper = std::min(b.upper, 2e19);
    };
    for (int i = 0; i < n; ++i) fill(problem().variable_bound(i), xl[i], xu[i]);
    for (int i = 0; i < m; ++i) fill(problem().row_bound(i), cl[i], cu[i]);
    return true;
  }

  bool get_starting_point(Ipopt::Index, bool, double* x, bool, double*, double*, Ipopt::Index, bool, double*) override {
    std::copy(start_.begin(), start_.end(), x);
    return true;
  }

  bool eval_f(Ipopt::Index n, const double* x, bool, double& value) override {
    return guarded([&] { value = evaluator_.objective({x, at(n)}); });
  }
  bool eval_grad_f(Ipopt::Index n, const double* x, bool, double* g) override {
    return guarded([&] { evaluator_.gradient({x, at(n)}, {g, at(n)}); });
  }
  bool eval_g(Ipopt::Index n, const double* x, bool, Ipopt::Index m, double* c) override {
    return guarded([&] { evaluator_.rows({x, at(n)}, {c, at(m)}); });
  }
  bool eval_jac_g(Ipopt::Index n, const double* x, bool, Ipopt::Index, Ipopt::Index count, Ipopt::Index* rows,
                  Ipopt::Index* columns, double* values) override {
    if (values == nullptr) return copy_pattern(problem().jacobian_pattern(), rows, columns);
    return guarded([&] { evaluator_.jacobian({x, at(n)}, {values, at(count)}); });
  }
  bool eval_h(Ipopt::Index n, const double* x, bool, double factor, Ipopt::Index m, const double* multipliers, bool,
              Ipopt::Index count, Ipopt::Index* rows, Ipopt::Index* columns, double* values) override {
    if (values == nullptr) return copy_pattern(problem().hessian_pattern(), rows, columns);
    return guarded([&] { evaluator_.hessian({x, at(n)}, factor, {multipliers, at(m)}, {values, at(count)}); });
  }

 protected:
  const nlp::Problem& problem() const { return evaluator_.problem(); }
  nlp::Evaluator& evaluator() { return evaluator_; }

  template <class Call>
  static bool guarded(Call call) {
    try {
      call();
      return true;
    } catch (const nlp::StopRun&) {
      return false;
    }
  }

 private:
  static bool copy_pattern(const std::vector<nlp::Entry>& pattern, Ipopt::Index* rows, Ipopt::Index* columns) {
    for (const nlp::Entry& e : pattern) {
      *rows++ = e.row;
      *columns++ = e.column;
    }
    return true;
  }

  static std::size_t at(Ipopt::Index i) { return static_cast<std::size_t>(i); }

  nlp::Evaluator& evaluator_;
  std::vector<double> start_;
};

}  // namespace accdec::solvers

/// MUMPS keeps global state: two Ipopts at once in one process crash. Ipopt's module has the mutex for all.
extern "C" std::mutex* accdec_ipopt_mutex();
