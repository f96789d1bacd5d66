#include <cmath>
#include <numbers>

#include <conformance/cases.hpp>

namespace accdec::testing {

using nlp::Bound;
using nlp::infinity;
using nlp::ProblemClass;

FormulaProblem::FormulaProblem(std::string name, std::vector<Bound> bounds, Formula objective, std::vector<Row> rows,
                               ProblemClass problem_class, std::vector<Formula> residuals)
    : bounds_(std::move(bounds)),
      rows_(std::move(rows)),
      name_(std::move(name)),
      objective_(std::move(objective)),
      class_(problem_class),
      residuals_(std::move(residuals)) {
  for (int r = 0; r < num_rows(); ++r) {
    for (int i = 0; i < num_variables(); ++i) jacobian_pattern_.push_back({r, i});
  }
  for (int i = 0; i < num_variables(); ++i) {
    for (int j = 0; j <= i; ++j) hessian_pattern_.push_back({i, j});
  }
}

Variables FormulaProblem::lift(std::span<const double> x) const {
  Variables v;
  for (int i = 0; i < num_variables(); ++i)
    v.push_back(Second::variable(x[static_cast<std::size_t>(i)], i, num_variables()));
  return v;
}

double FormulaProblem::objective(std::span<const double> x) const {
  return objective_(lift(x)).v;
}

void FormulaProblem::gradient(std::span<const double> x, std::span<double> g) const {
  const Second f = objective_(lift(x));
  std::copy(f.g.begin(), f.g.end(), g.begin());
}

void FormulaProblem::rows(std::span<const double> x, std::span<double> c) const {
  const Variables v = lift(x);
  for (std::size_t r = 0; r < rows_.size(); ++r) c[r] = rows_[r].formula(v).v;
}

void FormulaProblem::jacobian(std::span<const double> x, std::span<double> values) const {
  const Variables v = lift(x);
  auto out = values.begin();
  for (const Row& row : rows_) {
    const Second c = row.formula(v);
    out = std::copy(c.g.begin(), c.g.end(), out);
  }
}

void FormulaProblem::hessian(std::span<const double> x, double objective_factor, std::span<const double> multipliers,
                             std::span<double> values) const {
  const Variables v = lift(x);
  Eigen::MatrixXd h = objective_factor * objective_(v).h;
  for (std::size_t r = 0; r < rows_.size(); ++r) h += multipliers[r] * rows_[r].formula(v).h;
  for (std::size_t e = 0; e < values.size(); ++e) values[e] = h(hessian_pattern_[e].row, hessian_pattern_[e].column);
}

void FormulaProblem::residuals(std::span<const double> x, std::span<double> r) const {
  const Variables v = lift(x);
  for (std::size_t i = 0; i < residuals_.size(); ++i) r[i] = residuals_[i](v).v;
}

void FormulaProblem::residual_jacobian(std::span<const double> x, std::span<double> values) const {
  const Variables v = lift(x);
  auto out = values.begin();
  for (const Formula& formula : residuals_) {
    const Second r = formula(v);
    out = std::copy(r.g.begin(), r.g.end(), out);
  }
}

namespace {

using V = const Variables&;

const Bound free_variable{};
Bound at_least(double l) {
  return {l, infinity};
}
Bound at_most(double u) {
  return {-infinity, u};
}
Bound equal(double e) {
  return {e, e};
}

/// sum_i weight(i) x_i
template <class Weight>
Second sum(V x, Weight weight) {
  Second s = 0.0 * x[0];
  for (std::size_t i = 0; i < x.size(); ++i) s = s + weight(static_cast<int>(i)) * x[i];
  return s;
}

const double root2 = std::sqrt(2.0);
/// The sums of squares below in residual form, 1/2 |r|^2.
const std::vector<Formula> rosenbrock_residuals{[](V x) { return 10.0 * root2 * (x[1] - sqr(x[0])); },
                                                [](V x) { return root2 * (1.0 - x[0]); }};
const std::vector<Formula> distance_residuals{[](V x) { return root2 * (x[0] - 2.0); },
                                              [](V x) { return root2 * (x[1] - 1.0); }};

Second rosenbrock(V x) {
  return 100.0 * sqr(x[1] - sqr(x[0])) + sqr(1.0 - x[0]);
}
Second distance_to_2_1(V x) {
  return sqr(x[0] - 2.0) + sqr(x[1] - 1.0);
}

Case hs015(std::string name, std::vector<Bound> bounds) {
  return {{std::move(name),
           std::move(bounds),
           rosenbrock,
           {{at_least(1.0), [](V x) { return x[0] * x[1]; }}, {at_least(0.0), [](V x) { return x[0] + sqr(x[1]); }}},
           ProblemClass::least_squares,
           rosenbrock_residuals},
          {-2.0, 1.0},
          306.5,
          {0.5, 2.0},
          360.379767};
}

Case hs022(std::string name, std::vector<Bound> bounds) {
  return {{std::move(name),
           std::move(bounds),
           distance_to_2_1,
           {{at_most(2.0), [](V x) { return x[0] + x[1]; }}, {at_least(0.0), [](V x) { return x[1] - sqr(x[0]); }}},
           ProblemClass::least_squares,
           distance_residuals},
          {2.0, 2.0},
          1.0,
          {1.0, 1.0}};
}

Case hs035(std::string name, Bound bound) {
  return {{std::move(name),
           {bound, bound, bound},
           [](V x) {
             return 9.0 - 8.0 * x[0] - 6.0 * x[1] - 4.0 * x[2] + 2.0 * sqr(x[0]) + 2.0 * sqr(x[1]) + sqr(x[2]) +
                    2.0 * x[0] * x[1] + 2.0 * x[0] * x[2];
           },
           {{at_most(3.0), [](V x) { return x[0] + x[1] + 2.0 * x[2]; }}}},
          {0.5, 0.5, 0.5},
          1.0 / 9.0,
          {4.0 / 3.0, 7.0 / 9.0, 4.0 / 9.0}};
}

/// Residual of one undamped mode of ten samples' period; shortest mean delay at residual 0.
Case zv_shaper() {
  const auto wave = [](auto function) {
    return [function](V x) { return sum(x, [&](int k) { return function(2.0 * std::numbers::pi * k / 10.0); }); };
  };
  Case c{{"ZV shaper",
          std::vector<Bound>(11, at_least(0.0)),
          [](V x) { return sum(x, [](int k) { return static_cast<double>(k); }); },
          {{equal(1.0), [](V x) { return sum(x, [](int) { return 1.0; }); }},
           {equal(0.0), wave([](double a) { return std::cos(a); })},
           {equal(0.0), wave([](double a) { return std::sin(a); })}},
          ProblemClass::linear},
         std::vector<double>(11, 1.0 / 11.0),
         2.5,
         std::vector<double>(11, 0.0)};
  c.solution[0] = c.solution[5] = 0.5;
  return c;
}

Case least_energy() {
  std::vector<Formula> residuals;
  for (std::size_t i = 0; i < 8; ++i) residuals.push_back([i](V x) { return std::sqrt(2.0) * x[i]; });
  Case c{{"least energy",
          std::vector<Bound>(8),
          [](V x) {
            Second s = 0.0 * x[0];
            for (const Second& h : x) s = s + sqr(h);
            return s;
          },
          {{equal(1.0), [](V x) { return sum(x, [](int) { return 1.0; }); }},
           {equal(2.0), [](V x) { return sum(x, [](int k) { return static_cast<double>(k); }); }}},
          ProblemClass::least_squares,
          residuals},
         {1, 0, 0, 0, 0, 0, 0, 0},
         5.0 / 28.0,
         {}};
  // Lagrange: h_k = a + b k with sum 8a + 28b = 1 and 28a + 140b = 2.
  const double b = (2.0 - 28.0 / 8.0) / (140.0 - 28.0 * 28.0 / 8.0), a = (1.0 - 28.0 * b) / 8.0;
  for (int k = 0; k < 8; ++k) c.solution.push_back(a + b * k);
  return c;
}

/// From Hock and Schittkowski's Test Examples for Nonlinear Programming Codes, 1981: two variables.
void add_of_two_variables(std::vector<Case>& all) {
  const double root3 = std::sqrt(3.0), root7 = std::sqrt(7.0), pi = std::numbers::pi;
  all.push_back(
      {{"HS002", {free_variable, at_least(1.5)}, rosenbrock, {}, ProblemClass::least_squares, rosenbrock_residuals},
       {-2.0, 1.0},
       0.05042618789,
       {1.2243707487363527, 1.5},
       4.94122931799});
  all.push_back({{"HS004", {at_least(1.0), at_least(0.0)}, [](V x) { return 1.0 / 3.0 * cube(x[0] + 1.0) + x[1]; }, {}},
                 {1.125, 0.125},
                 8.0 / 3.0,
                 {1.0, 0.0}});
  all.push_back({{"HS005",
                  {{-1.5, 4.0}, {-3.0, 3.0}},
                  [](V x) { return sin(x[0] + x[1]) + sqr(x[0] - x[1]) - 1.5 * x[0] + 2.5 * x[1] + 1.0; },
                  {}},
                 {0.0, 0.0},
                 -(root3 / 2.0 + pi / 3.0),
                 {0.5 - pi / 3.0, -0.5 - pi / 3.0}});
  all.push_back({{"HS007",
                  {free_variable, free_variable},
                  [](V x) { return log(sqr(x[0]) + 1.0) - x[1]; },
                  {{equal(4.0), [](V x) { return sqr(sqr(x[0]) + 1.0) + sqr(x[1]); }}}},
                 {2.0, 2.0},
                 -root3,
                 {0.0, root3}});
  all.push_back({{"HS014",
                  {free_variable, free_variable},
                  distance_to_2_1,
                  {{equal(-1.0), [](V x) { return x[0] - 2.0 * x[1]; }},
                   {at_most(1.0), [](V x) { return 0.25 * sqr(x[0]) + sqr(x[1]); }}},
                  ProblemClass::least_squares,
                  distance_residuals},
                 {2.0, 2.0},
                 9.0 - 23.0 * root7 / 8.0,
                 {0.5 * (root7 - 1.0), 0.25 * (root7 + 1.0)}});
  all.push_back(hs015("HS015", {at_most(0.5), free_variable}));
  all.push_back(hs015("HS015 in a box", {{-4.0, 0.5}, {-4.0, 4.0}}));
  all.push_back({{"HS021",
                  {{2.0, 50.0}, {-50.0, 50.0}},
                  [](V x) { return 0.01 * sqr(x[0]) + sqr(x[1]) - 100.0; },
                  {{at_least(10.0), [](V x) { return 10.0 * x[0] - x[1]; }}}},
                 {-1.0, -1.0},
                 -99.96,
                 {2.0, 0.0}});
  all.push_back(hs022("HS022", {free_variable, free_variable}));
  all.push_back(hs022("HS022 in a box", {{-3.0, 3.0}, {-3.0, 3.0}}));
}

/// From the same book: more variables, and one case whose optimum is not regular.
void add_of_more_variables(std::vector<Case>& all) {
  all.push_back(hs035("HS035", at_least(0.0)));
  all.push_back(hs035("HS035 in a box", {0.0, 3.0}));
  all.push_back({{"HS040",
                  std::vector<Bound>(4),
                  [](V x) { return -1.0 * (x[0] * x[1] * x[2] * x[3]); },
                  {{equal(1.0), [](V x) { return cube(x[0]) + sqr(x[1]); }},
                   {equal(0.0), [](V x) { return sqr(x[0]) * x[3] - x[2]; }},
                   {equal(0.0), [](V x) { return sqr(x[3]) - x[1]; }}}},
                 {0.8, 0.8, 0.8, 0.8},
                 -0.25,
                 {std::pow(2.0, -1.0 / 3.0), std::pow(2.0, -0.5), std::pow(2.0, -11.0 / 12.0), std::pow(2.0, -0.25)}});
  all.push_back({{"HS071",
                  std::vector<Bound>(4, {1.0, 5.0}),
                  [](V x) { return x[0] * x[3] * (x[0] + x[1] + x[2]) + x[2]; },
                  {{equal(40.0), [](V x) { return sqr(x[0]) + sqr(x[1]) + sqr(x[2]) + sqr(x[3]); }},
                   {at_least(25.0), [](V x) { return x[0] * x[1] * x[2] * x[3]; }}}},
                 {1.0, 5.0, 5.0, 1.0},
                 17.01401728916,
                 {1.0, 4.742999643, 3.821149979, 1.379408293}});
  Case hs013{{"HS013",
              {at_least(0.0), at_least(0.0)},
              [](V x) { return sqr(x[0] - 2.0) + sqr(x[1]); },
              {{at_least(0.0), [](V x) { return cube(1.0 - x[0]) - x[1]; }}}},
             {-2.0, -2.0},
             1.0,
             {1.0, 0.0}};
  hs013.regular = false;
  hs013.tolerance = 1e-2;
  all.push_back(hs013);
}

/// Our own cases with answers in closed form: linear, degenerate, fixed.
void add_of_our_own(std::vector<Case>& all) {
  all.push_back(
      {{"dependent equalities",
        {free_variable, free_variable},
        [](V x) { return sqr(x[0]) + sqr(x[1]); },
        {{equal(1.0), [](V x) { return x[0] + x[1]; }}, {equal(2.0), [](V x) { return 2.0 * x[0] + 2.0 * x[1]; }}}},
       {0.0, 0.0},
       0.5,
       {0.5, 0.5}});
  all.push_back({{"LP",
                  {at_least(0.0), at_least(2.0)},
                  [](V x) { return 2.0 * x[0] + x[1]; },
                  {{at_most(1.0), [](V x) { return x[1] - x[0]; }},
                   {at_least(2.0), [](V x) { return x[0] + x[1]; }},
                   {at_most(4.0), [](V x) { return x[0] - 2.0 * x[1]; }}},
                  ProblemClass::linear},
                 {0.0, 2.0},
                 4.0,
                 {1.0, 2.0}});
  all.push_back(zv_shaper());
  all.push_back(least_energy());
  all.push_back({{"a fixed variable",
                  {free_variable, equal(2.0)},
                  [](V x) { return sqr(x[0] - x[1]) + x[1]; },
                  {{at_most(1.0), [](V x) { return x[0]; }}}},
                 {0.0, 2.0},
                 3.0,
                 {1.0, 2.0}});
  all.push_back(
      {{"all variables fixed", {equal(1.0), equal(2.0)}, [](V x) { return x[0] + x[1]; }, {}, ProblemClass::linear},
       {1.0, 2.0},
       3.0,
       {1.0, 2.0}});
  all.push_back(
      {{"no objective",
        {{-4.0, 4.0}, {-4.0, 4.0}},
        [](V x) { return 0.0 * x[0]; },
        {{at_least(1.0), [](V x) { return x[0] + x[1]; }}, {at_most(4.0), [](V x) { return sqr(x[0]) + sqr(x[1]); }}}},
       {0.0, 0.0},
       0.0,
       {1.0, 0.5}});
}

}  // namespace

const std::vector<Case>& cases() {
  static const std::vector<Case> all = [] {
    std::vector<Case> made;
    add_of_two_variables(made);
    add_of_more_variables(made);
    add_of_our_own(made);
    return made;
  }();
  return all;
}

}  // namespace accdec::testing
