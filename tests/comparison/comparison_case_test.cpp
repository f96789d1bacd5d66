#include <cmath>
#include <set>
#include <stdexcept>

#include <gmock/gmock.h>

#include <accdec/comparison/comparison_run.hpp>
#include <accdec/comparison/recorded_problem.hpp>
#include <accdec/solver.hpp>

#include "support/tasks.hpp"

namespace accdec::comparison {
namespace {

/// One corner along the axes at 0.1 m/s, acceleration such that a filter of `taps` taps must be a boxcar.
CaseSpec boxcar_case(int taps, int delay, double angle = 90.0, double heading = 0.0) {
  Axis axis;
  axis.acceleration_max = 0.1 / (taps * 1e-3);
  CaseSpec spec;
  spec.name = "boxcar";
  spec.task = accdec::testing::plane_task(axis, accdec::testing::plane_corner("A", angle, heading, 0.1, 0.1), 100e-6);
  spec.order = taps - 1;
  spec.delays = {delay};
  return spec;
}

// Only one filter is left, so the least error is that of the boxcar: 2 v T cos(theta/2) E[max(i - N/2 - d/2, 0)]. The
// sum is computed by hand: the sum of i - 20 - d/2 over i = 20 + d/2 .. 40 is m (m + 1)/2 with m = 20 - d/2.
TEST(Reference, OfTheLeastErrorWhereOnlyABoxcarHolds) {
  for (const int delay : {0, 10, 20}) {
    const double m = 20 - delay / 2;
    const double error = 2.0 * 0.1 * 1e-3 * std::cos(accdec::testing::degrees(45)) * m * (m + 1) / 2 / 41;
    const double sigma = error * error / (100e-6 * 100e-6);
    const Reference r = reference_of(ComparisonCase(boxcar_case(41, delay)), 30.0);
    EXPECT_EQ(r.proof, Reference::Proof::optimal) << r.method;
    EXPECT_NEAR(r.upper, sigma, 1e-5 * std::max(1.0, sigma)) << delay;
    EXPECT_LE(r.lower, r.upper);
    EXPECT_NEAR(r.lower, sigma, 1e-5 * std::max(1.0, sigma)) << delay;
  }
}

TEST(Reference, ProvesThatOneTapLessIsTooFew) {
  CaseSpec spec = boxcar_case(41, 0);
  spec.order = 39;
  EXPECT_EQ(reference_of(ComparisonCase(spec), 30.0).proof, Reference::Proof::infeasible);
  spec.question = Question::delay;
  EXPECT_EQ(reference_of(ComparisonCase(spec), 30.0).proof, Reference::Proof::infeasible);
  spec.question = Question::design;
  EXPECT_EQ(reference_of(ComparisonCase(spec), 30.0).proof, Reference::Proof::infeasible);
}

// A second opinion on a case with room to choose: the interior-point solver comes to the same least error as the
// bisection.
TEST(Reference, AgreesWithASolverThatSharesNothingWithIt) {
  CaseSpec spec = boxcar_case(30, 12, 60.0, 25.0);
  spec.order = 64;  // room for both legs' accelerations in one axis
  spec.task.machine.axes[0].jerk_max = spec.task.machine.axes[1].jerk_max = 400.0;
  const ComparisonCase subject(spec);
  const Reference r = reference_of(subject, 30.0);
  ASSERT_EQ(r.proof, Reference::Proof::optimal) << r.method;
  for (const bool reduced : {false, true}) {
    const auto result = solvers::find_solver("ipopt").solve(*subject.problem(reduced), subject.start(reduced, 0, 1));
    EXPECT_NEAR(result.verification.objective, r.upper, 1e-5 * std::max(1.0, r.upper));
  }
}

TEST(ComparisonCase, RefinementKeepsTheMotion) {
  CaseSpec spec = boxcar_case(41, 10);
  spec.task.corners[0].delay = 3;
  const CaseSpec fine = refined(spec, 4);
  EXPECT_EQ(fine.order + 1, 4 * 41);
  EXPECT_DOUBLE_EQ(fine.task.sample_period, 0.25e-3);
  EXPECT_EQ(fine.delays[0], 40);
  EXPECT_EQ(fine.task.corners[0].delay, 12);
  EXPECT_THROW(refined(spec, 0), std::invalid_argument);
}

TEST(ComparisonCase, StartsAreTheSameForBothFormsAndRepeat) {
  CaseSpec spec = boxcar_case(41, 10);
  for (const Question q : {Question::margin, Question::delay}) {
    spec.question = q;
    const ComparisonCase subject(spec);
    for (const int index : {0, 1, 2}) {
      const auto sparse = subject.start(false, index, 7), reduced = subject.start(true, index, 7);
      EXPECT_EQ(subject.to_reduced(false, sparse), reduced) << index;
      EXPECT_EQ(sparse, subject.start(false, index, 7));
    }
    EXPECT_NE(subject.start(true, 1, 7), subject.start(true, 2, 7));
    EXPECT_NE(subject.start(true, 1, 7), subject.start(true, 1, 8));
  }
}

ComparisonSettings settings(const std::vector<std::string>& names) {
  ComparisonSettings s;
  for (const std::string& name : names) s.solvers.push_back(competitor_from_entry(name));
  s.starts = 2;
  s.repeats = 5;
  return s;
}

TEST(Schedule, HoldsEveryRunOnceAndShufflesTheOrder) {
  CaseSpec second = boxcar_case(31, 0);
  second.name = "second";
  const Comparison c(settings({"ipopt", "nlopt-slsqp", "nlopt-mma"}), {boxcar_case(41, 0), second});
  ASSERT_EQ(c.size(), 2u + 2 * 2 * 3 * 5);
  std::set<std::tuple<std::size_t, int, std::size_t, int>> seen;
  std::set<std::size_t> first_solvers;
  std::set<std::pair<std::size_t, std::size_t>> neighbours;
  std::size_t before = 0;
  for (std::size_t i = 0; i < c.size(); ++i) {
    const ScheduledRun run = c.at(i);
    EXPECT_EQ(run.reference, i < 2);
    if (run.reference) continue;
    EXPECT_EQ(c.index_of(run, run.repeat), i);
    EXPECT_TRUE(seen.emplace(run.case_index, run.start, run.solver, run.repeat).second);
    EXPECT_EQ(run.repeat, static_cast<int>((i - 2) / 12)) << "repeats are the outermost loop";
    if ((i - 2) % 3 == 0)
      first_solvers.insert(run.solver);
    else
      neighbours.emplace(before, run.solver);
    before = run.solver;
  }
  EXPECT_EQ(first_solvers.size(), 3u) << "each solver is the first somewhere";
  EXPECT_EQ(neighbours.size(), 6u) << "each follows each somewhere";
  EXPECT_THROW(c.at(c.size()), std::out_of_range);
}

TEST(Schedule, RefusesWhatIsNoComparison) {
  EXPECT_THROW(Comparison(settings({"ipopt"}), {}), std::invalid_argument);
  EXPECT_THROW(Comparison(settings({}), {boxcar_case(41, 0)}), std::invalid_argument);
  EXPECT_THROW(Comparison(settings({"simplex-9000"}), {boxcar_case(41, 0)}), std::invalid_argument);
}

TEST(ComparisonRun, RecordsRefusalsAndLostProcesses) {
  CaseSpec spec = boxcar_case(41, 0);
  const Comparison c(settings({"clp"}), {spec});
  const batch::Row refused = c.run(1);
  EXPECT_EQ(refused["claim"], "refused");
  EXPECT_EQ(refused["verdict"], "none");
  EXPECT_THAT(refused["message"].get<std::string>(), ::testing::HasSubstr("not linear"));
  EXPECT_EQ(c.lost(1, "given up after 2 s")["claim"], "killed");
  EXPECT_EQ(c.lost(1, "the process computing it was ended by signal 11")["claim"], "crashed");
}

TEST(ComparisonRun, HasWhatTheTablesNeed) {
  const Comparison c(settings({"ipopt"}), {boxcar_case(41, 0)});
  const batch::Row row = c.run(1);
  EXPECT_EQ(row["claim"], "solved");
  EXPECT_EQ(row["verdict"], "optimal");
  EXPECT_LE(row["violation"].get<double>(), 1e-6);
  EXPECT_GT(row["evaluations"]["objective"].get<int>(), 0);
  EXPECT_GT(row["evaluations"]["jacobian"].get<int>(), 0);
  EXPECT_LE(row["evaluation_time_s"].get<double>(), row["wall_time_s"].get<double>());
}

TEST(ComparisonRun, WhatIsFoundOnTheWayIsJudgedAsTheAnswerIs) {
  // Ipopt has the sparse form, COBYLA the reduced one; in both, no improvement is below the optimum and the last is the
  // answer.
  const CaseSpec spec = boxcar_case(41, 10);
  const double optimum = reference_of(ComparisonCase(spec), 30.0).upper;
  ComparisonSettings both = settings({"ipopt", "nlopt-slsqp"});
  both.reduced = {"nlopt-slsqp"};
  const Comparison c(both, {spec});
  for (std::size_t index = 1; index <= 2; ++index) {
    const batch::Row row = c.run(index);
    ASSERT_FALSE(row["history"].empty()) << row.dump();
    double before = nlp::infinity;
    for (const batch::Row& step : row["history"]) {
      EXPECT_GE(step[2].get<double>(), optimum * (1.0 - 1e-5));
      EXPECT_LT(step[2].get<double>(), before);
      before = step[2];
    }
    EXPECT_NEAR(before, row["objective"].get<double>(), 1e-4 * optimum) << row.dump();
  }
}

TEST(ComparisonRun, OneSolverInBothForms) {
  const Comparison c(settings({"nlopt-slsqp", "nlopt-slsqp/reduced"}), {boxcar_case(41, 10)});
  EXPECT_EQ(c.header()["solvers"][0]["form"], "sparse");
  EXPECT_EQ(c.header()["solvers"][1]["form"], "reduced");
  const auto row_of = [&](std::size_t solver) {
    ScheduledRun run;
    run.solver = solver;
    return c.run(c.index_of(run, 0));
  };
  const batch::Row sparse = row_of(0), reduced = row_of(1);
  EXPECT_EQ(reduced["solver"], "nlopt-slsqp/reduced");
  EXPECT_EQ(reduced["verdict"], "optimal");
  EXPECT_NEAR(reduced["objective"].get<double>(), sparse["objective"].get<double>(),
              1e-6 * sparse["objective"].get<double>());
  EXPECT_NE(reduced["evaluations"], sparse["evaluations"]);
}

// The reduced form has no second derivatives, whoever would use them.
TEST(ComparisonRun, SaysWhatIsUsed) {
  const Comparison c(settings({"ipopt", "ipopt/reduced", "nlopt-cobyla"}), {boxcar_case(41, 10)});
  const batch::Row solvers = c.header()["solvers"];
  EXPECT_EQ(solvers[0]["uses"], "second derivatives");
  EXPECT_EQ(solvers[1]["uses"], "first derivatives");
  EXPECT_EQ(solvers[1]["solver"], "ipopt");
  EXPECT_EQ(solvers[2]["uses"], "values");
}

TEST(ComparisonRun, DesignsStartWhereToldAndAreCounted) {
  CaseSpec spec = boxcar_case(41, 0);
  spec.task.machine.axes[0].acceleration_max = spec.task.machine.axes[1].acceleration_max = 0.1 / 20e-3;
  spec.question = Question::design;
  ComparisonSettings two_starts = settings({"ipopt"});
  two_starts.starts = 2;
  const Comparison c(two_starts, {spec});
  std::set<std::int64_t> counts;
  for (std::size_t index = 1; index <= 2; ++index) {
    const batch::Row row = c.run(index);
    ASSERT_EQ(row["claim"], "solved") << row.dump();
    for (const char* key : {"gradient", "rows", "jacobian", "hessian"})
      EXPECT_GT(row["evaluations"][key].get<int>(), 0) << key;
    EXPECT_GT(row["evaluation_time_s"].get<double>(), 0.0);
    ASSERT_FALSE(row["history"].empty());
    EXPECT_EQ(row["history"].back()[2], row["objective"]);
    counts.insert(row["evaluations"]["objective"].get<std::int64_t>());
  }
  EXPECT_EQ(counts.size(), 2U) << "another start takes another way";
}

TEST(RecordedProblem, JudgesAllThatWasAskedForHoweverLittleItMayKeep) {
  const ComparisonCase subject(boxcar_case(41, 10));
  const nlp::Problem& problem = *subject.problem(true);
  for (const std::size_t bytes : {std::size_t{0}, std::size_t{1'000'000}}) {
    // Judged by a measure of its own: the first variable, if that is at least 0.3.
    RecordedProblem recorded(
        problem, [](const std::vector<double>& x) { return x[0] >= 0.3 ? x[0] : nlp::infinity; }, bytes);
    std::vector<double> x = subject.start(true, 0, 1), rows(static_cast<std::size_t>(problem.num_rows()));
    for (const double first : {0.9, 0.2, 0.5, 0.7, 0.3, 0.25}) {
      x[0] = first;
      EXPECT_EQ(recorded.objective(x), problem.objective(x));
      recorded.rows(x, rows);
    }
    std::vector<double> objectives;
    for (const nlp::Improvement& step : recorded.history()) objectives.push_back(step.objective);
    EXPECT_THAT(objectives, ::testing::ElementsAre(0.9, 0.5, 0.3));
    EXPECT_EQ(recorded.history()[2].evaluations, 5);
    EXPECT_EQ(recorded.best()[0], 0.3);
  }
}

}  // namespace
}  // namespace accdec::comparison
