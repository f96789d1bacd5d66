#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <accdec/design/formulation.hpp>
#include <accdec/task.hpp>

namespace accdec::instances {

/// A problem as data that a file can hold: minimise objective(x) subject to bounds on variables and on rows. Every row
/// is a polynomial of degree 2, plus terms of an approach.
struct Instance {
  struct Variable {
    std::string name;
    nlp::Bound bound;
    double start = 0.0;
    bool binary = false;
  };
  struct Row {
    std::string name;
    nlp::Bound bound;
    Polynomial body;
    std::vector<Approach> approaches;  ///< `row` of each is unused
  };
  std::string name;
  int order = 0;  ///< N, if a row has an approach: variables 0 .. N-1 are B_1 .. B_N
  Affine objective;
  std::vector<Variable> variables;
  std::vector<Row> rows;
};

/// A formulation as data. @param start  size num_variables
/// @throws std::invalid_argument for a DelayProblem behind a response
Instance instance_of(const QuadraticProblem& problem, std::span<const double> start);

/// The whole choice at one order, as a problem with whole variables, its start, and the delay of every corner of the
/// task as a form in its variables. Its variables begin with B_1 .. B_N.
struct Choice {
  QuadraticProblem problem;
  std::vector<double> start;
  std::vector<Affine> delays;
};

/// The whole choice at one order, as a mixed-integer problem: taps, and the delay d_j and the sample k_j of every
/// corner with a tolerance, as sums of binary variables. The objective is sum_j weight_j d_j + runs (N + 1), in
/// samples, or that of `objective = "corner"`.
///
/// P_j and Q_j are tied to the distances p(k_j) and Q(k_j - d_j) by big-M rows. Rows of a blend at delay d hold where
/// d_j = d, also by big-M. Every M bounds its row over the taps' range. Delays go to N + 2, as
/// longer ones help nothing. Vibration is bounded at the grid of `initial_frequencies`, so that a band is relaxed.
/// It is a choice of free taps and delays, also where the task narrows them.
/// @throws std::invalid_argument behind a response, and for modes of axes, contours, dry friction of axes that reverse
Choice choice_of(const Task& task, int order);

/// An instance as the text of a file.
struct Text {
  std::string content;
  /// Names in the order of the file.
  std::vector<std::string> columns, rows;
  std::vector<int> variables;  ///< of each column of the file: its variable of the instance, or one more
  std::vector<std::pair<int, Affine>> solved;  ///< variables of the instance without a column, as forms in the others
  std::string kind;                            ///< "linear program", ..
  /// The relation of its optimum to that of the instance.
  std::string relation = "the same problem";
};

/// AMPL's .nl, as text. Takes every instance.
Text nl_text(const Instance& instance);

/// Free MPS. Convex rows of degree 2 become `tangents` tangents to their cone, an outer approximation. If the only
/// variable of the objective bounds the squares, its root takes its place.
/// @throws std::invalid_argument naming a row that is not convex
Text mps_text(const Instance& instance, int tangents = 64);

/// CBF version 1: convex rows of degree 2 are rotated cones. @throws std::invalid_argument as mps_text
Text cbf_text(const Instance& instance);

/// Sparse SDPA (.dat-s): convex rows of degree 2 are blocks [slack s'; s I]. Equality rows are solved for one variable
/// each, so that the program keeps an interior. @throws std::invalid_argument also for binary variables
Text dat_s_text(const Instance& instance);

/// One of these, by its name in `accdec instances --format`.
Text text_of(const Instance& instance, std::string_view format);

}  // namespace accdec::instances
