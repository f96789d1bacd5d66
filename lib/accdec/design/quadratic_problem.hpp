#pragma once

#include <algorithm>
#include <exception>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <accdec/problem.hpp>

namespace accdec {

/// constant + sum_i coefficient_i x_{index_i}. Indices may repeat; they are merged.
struct Affine {
  double constant = 0.0;
  std::vector<std::pair<int, double>> terms;

  Affine& add(int index, double coefficient);
  Affine& operator+=(const Affine& other);
  Affine& operator*=(double factor);
  double operator()(std::span<const double> x) const;
};
Affine operator*(double factor, Affine a);
Affine operator+(Affine a, const Affine& b);

/// An affine form plus sum_n coefficient_n x_{first_n} x_{second_n}, with first <= second and no pair twice.
struct Polynomial {
  struct Product {
    int first = 0, second = 0;
    double coefficient = 0.0;
  };
  Affine affine;
  std::vector<Product> products;
};

/// The time for a problem was over before all its rows were made.
struct BuildStopped : std::exception {
  const char* what() const noexcept override { return "stopped while the rows of a problem were made"; }
};

/// A problem with an affine objective. Its rows are an affine form plus products of two affine forms. In the cumulative
/// variables, all limits of a corner motion at fixed delays have this form. Taps, accelerations, jerks and forces are
/// affine with a few neighbours each. Power is one product; squared speeds and distances are sums of products.
///
/// Built by add_* calls, then `finish`. Evaluations cost O(number of stored coefficients).
class QuadraticProblem : public nlp::Problem {
 public:
  int add_variable(std::string name, nlp::Bound bound);
  void set_variable_bound(int i, nlp::Bound bound) { variables_[static_cast<std::size_t>(i)].bound = bound; }
  void set_integer(int i) { variables_[static_cast<std::size_t>(i)].integer = true; }
  /// @throws BuildStopped
  int add_row(std::string name, nlp::Bound bound);
  /// From now on, building ends when `stop` is true.
  void stop_when(std::function<bool()> stop) { stop_ = std::move(stop); }
  /// Asks it where no row is added for long. @throws BuildStopped
  void go_on() const {
    if (stop_ && stop_()) throw BuildStopped();
  }
  void add_to_row(int row, const Affine& a);
  /// row += coefficient * left * right
  void add_product(int row, double coefficient, Affine left, Affine right);
  void set_objective(Affine a) { objective_ = std::move(a); }
  void set_name(std::string name) { name_ = std::move(name); }
  /// Leaves second derivatives out, for dense products, whose Hessian would take O(n^2).
  void omit_hessian() { with_hessian_ = false; }
  /// Compiles the sparsity patterns; call once, after the last add. @throws BuildStopped
  void finish();

  /// The quadratic part of a row, multiplied out. A derived class may add terms of its own to the row.
  Polynomial polynomial(int row) const;
  const Affine& objective_form() const { return objective_; }

  std::string name() const override { return name_; }
  int num_variables() const override { return static_cast<int>(variables_.size()); }
  int num_rows() const override { return static_cast<int>(rows_.size()); }
  nlp::Bound variable_bound(int i) const override { return variables_[static_cast<std::size_t>(i)].bound; }
  nlp::Bound row_bound(int i) const override { return rows_[static_cast<std::size_t>(i)].bound; }
  std::string variable_name(int i) const override { return variables_[static_cast<std::size_t>(i)].name; }
  bool is_integer(int i) const override { return variables_[static_cast<std::size_t>(i)].integer; }
  std::string row_name(int i) const override { return rows_[static_cast<std::size_t>(i)].name; }
  nlp::ProblemClass problem_class() const override;
  double objective(std::span<const double> x) const override { return objective_(x); }
  void gradient(std::span<const double> x, std::span<double> g) const override;
  void rows(std::span<const double> x, std::span<double> c) const override;
  const std::vector<nlp::Entry>& jacobian_pattern() const override { return jacobian_pattern_; }
  void jacobian(std::span<const double> x, std::span<double> values) const override;
  bool has_hessian() const override { return with_hessian_; }
  const std::vector<nlp::Entry>& hessian_pattern() const override { return hessian_pattern_; }
  void hessian(std::span<const double> x, double objective_factor, std::span<const double> multipliers,
               std::span<double> values) const override;

 protected:
  /// Structural nonzeros that a derived class writes itself, after those of the quadratic part; `finish` returns their
  /// slots.
  struct Product {
    double coefficient;
    Affine left, right;
    std::vector<int> left_slots, right_slots;  // Jacobian slots of the terms
    std::vector<int> hessian_slots;            // left x right, row-major
  };
  struct Row {
    std::string name;
    nlp::Bound bound;
    Affine affine;
    std::vector<int> slots;
    std::vector<Product> products;
    std::vector<std::pair<int, int>> extra;  // (variable, slot), for derived classes
  };
  struct Variable {
    std::string name;
    nlp::Bound bound;
    bool integer;
  };
  /// For a derived class, before `finish`: reserves the Jacobian entry (row, variable). After `finish` its slot is in
  /// Row::extra.
  void reserve_jacobian(int row, int variable) {
    rows_[static_cast<std::size_t>(row)].extra.emplace_back(variable, -1);
  }
  /// The same for a Hessian entry; the slot is found with `hessian_slot` after `finish`.
  void reserve_hessian(int i, int j) { reserved_hessian_.emplace_back(std::max(i, j), std::min(i, j)); }
  int hessian_slot(int i, int j) const;

  std::vector<Row> rows_;

 private:
  std::string name_ = "quadratic";
  std::function<bool()> stop_;
  std::vector<Variable> variables_;
  Affine objective_;
  bool with_hessian_ = true;
  std::vector<nlp::Entry> jacobian_pattern_, hessian_pattern_;
  std::vector<std::pair<int, int>> reserved_hessian_;
};

}  // namespace accdec
