// Cases that must not work, must stop, or must be said: for every registered algorithm.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <limits>
#include <thread>

#include <unistd.h>

#include <conformance/cases.hpp>
#include <gmock/gmock.h>

#include <accdec/solver.hpp>

namespace accdec::testing {
namespace {

using nlp::Bound;
using nlp::infinity;
using nlp::ProblemClass;
using solvers::Claim;
using solvers::Options;
using solvers::Result;
using solvers::Solver;
using solvers::Verdict;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// A two-variable box problem that every algorithm accepts; `hook` sees every evaluation of the objective, counted from
/// 1, and may change the value.
class Hooked : public FormulaProblem {
 public:
  using Hook = std::function<double(int count, double value)>;
  Hooked(const Solver& solver, Hook hook)
      : FormulaProblem("hooked", {{-1.5, 4.0}, {-3.0, 3.0}},
                       solver.capabilities().linear_only
                           ? Formula([](const Variables& x) { return 2.0 * x[0] + x[1]; })
                           : Formula([](const Variables& x) {
                               return sin(x[0] + x[1]) + sqr(x[0] - x[1]) - 1.5 * x[0] + 2.5 * x[1] + 1.0;
                             }),
                       {}, solver.capabilities().linear_only ? ProblemClass::linear : ProblemClass::general),
        hook_(std::move(hook)) {}
  double objective(std::span<const double> x) const override {
    if (recording) points.emplace_back(x.begin(), x.end());
    return hook_(++count, FormulaProblem::objective(x));
  }
  mutable std::atomic<int> count = 0;
  bool recording = false;
  mutable std::vector<std::vector<double>> points;

 private:
  Hook hook_;
};

const std::vector<double> start{0.0, 0.0};

/// Everything written to descriptors 1 and 2 while it lives.
class Capture {
 public:
  Capture() {
    std::fflush(nullptr);
    for (int fd : {1, 2}) saved_[fd] = dup(fd), dup2(fileno(file_), fd);
  }
  ~Capture() { restore(), std::fclose(file_); }
  std::string text() {
    restore();
    std::string all;
    std::rewind(file_);
    for (int c = std::fgetc(file_); c != EOF; c = std::fgetc(file_)) all.push_back(static_cast<char>(c));
    return all;
  }

 private:
  void restore() {
    std::fflush(nullptr);
    for (int fd : {1, 2}) {
      if (saved_[fd] >= 0) dup2(saved_[fd], fd), close(saved_[fd]), saved_[fd] = -1;
    }
  }
  std::FILE* file_ = std::tmpfile();
  int saved_[3] = {-1, -1, -1};
};

FormulaProblem infeasible_linear() {
  return {"infeasible linear",
          {{0.0, infinity}, {2.0, infinity}},
          [](const Variables& x) { return -1.0 * (x[0] + x[1]); },
          {{{-infinity, 3.0}, [](const Variables& x) { return x[0] + 2.0 * x[1]; }},
           {{4.0, 4.0}, [](const Variables& x) { return 2.0 * x[0] + x[1]; }}},
          ProblemClass::linear};
}

FormulaProblem infeasible_curved() {
  return {"infeasible curved",
          {{-3.0, 3.0}, {-3.0, 3.0}},
          [](const Variables& x) { return x[0]; },
          {{{-infinity, 1.0}, [](const Variables& x) { return sqr(x[0]) + sqr(x[1]); }},
           {{3.0, infinity}, [](const Variables& x) { return x[0] + x[1]; }}}};
}

FormulaProblem unbounded() {
  return {"unbounded",
          {{0.0, infinity}, {2.0, infinity}},
          [](const Variables& x) { return -1.0 * (x[0] + x[1]); },
          {{{4.0, infinity}, [](const Variables& x) { return 2.0 * x[0] + x[1]; }}},
          ProblemClass::linear};
}

class Negative : public ::testing::TestWithParam<std::string> {
 protected:
  const Solver& solver() const { return solvers::find_solver(GetParam()); }
  bool linear() const { return solver().capabilities().linear_only; }
  Options limited() const {
    Options options;
    options.time_limit = 10.0;
    options.evaluation_limit = 3000;
    return options;
  }
};

#define SKIP_UNLESS_ACCEPTED(problem) \
  if (const std::string reason = solvers::reason_to_refuse(solver(), problem); !reason.empty()) GTEST_SKIP() << reason

TEST_P(Negative, InfeasibleRowsAreNeverCalledSolved) {
  int accepted = 0;
  for (const FormulaProblem& problem : {infeasible_linear(), infeasible_curved()}) {
    if (!solvers::reason_to_refuse(solver(), problem).empty()) continue;
    ++accepted;
    const Result result = solver().solve(problem, std::vector<double>{1.0, 2.0}, limited());
    EXPECT_EQ(result.verification.verdict, Verdict::infeasible) << problem.name();
    EXPECT_FALSE(result.verification.worst.empty());
    EXPECT_GT(std::max(result.verification.row_violation, result.verification.bound_violation), 0.1);
    if (GetParam() == "ipopt" || linear()) {
      EXPECT_EQ(result.claim, Claim::infeasible) << result.message;
    }
    if (linear()) {
      EXPECT_THAT(result.message, ::testing::HasSubstr("proved infeasible"));
    }
  }
  if (accepted == 0) GTEST_SKIP() << "accepts no rows";
}

TEST_P(Negative, UnboundedIsNeverCalledOptimal) {
  const FormulaProblem problem = unbounded();
  SKIP_UNLESS_ACCEPTED(problem);
  const Result result = solver().solve(problem, std::vector<double>{1.0, 2.0}, limited());
  EXPECT_NE(result.verification.verdict, Verdict::optimal) << result.message;
  if (GetParam() == "ipopt" || linear()) {
    EXPECT_EQ(result.claim, Claim::unbounded) << result.message;
  }
}

TEST_P(Negative, NotANumberStopsAtOnce) {
  for (const int first : {1, 4}) {
    if (first > 1 && linear()) continue;  // evaluates once
    const Hooked problem(solver(), [&](int count, double value) { return count >= first ? nan : value; });
    const Result result = solver().solve(problem, start, limited());
    EXPECT_EQ(result.claim, Claim::invalid_number) << result.message;
    EXPECT_LE(result.counts.objective, first);
    // The best point before that is kept.
    if (first > 1) {
      EXPECT_EQ(static_cast<int>(result.x.size()), 2);
    }
  }
}

TEST_P(Negative, TheProblemsOwnExceptionComesBackAndTheSolverStaysUsable) {
  struct Mine : std::runtime_error {
    using std::runtime_error::runtime_error;
  };
  const Hooked sound(solver(), [](int, double value) { return value; });
  const Result before = solver().solve(sound, start, limited());
  EXPECT_NE(before.claim, Claim::failed) << before.message;
  const int at = linear() ? 1 : 3;
  const Hooked throwing(solver(), [&](int count, double value) { return count == at ? throw Mine("mine") : value; });
  try {
    solver().solve(throwing, start, limited());
    FAIL() << "no exception";
  } catch (const Mine& e) {
    EXPECT_STREQ(e.what(), "mine");
  }
  const Result after = solver().solve(sound, start, limited());
  EXPECT_EQ(after.claim, before.claim);
  EXPECT_EQ(after.x, before.x);
}

TEST_P(Negative, MalformedProblemsAreRefusedWithoutAnEvaluation) {
  class Crossed : public Hooked {
   public:
    using Hooked::Hooked;
    Bound variable_bound(int i) const override { return i == 0 ? Bound{2.0, 1.0} : Hooked::variable_bound(i); }
  };
  const Crossed crossed(solver(), [](int, double value) { return value; });
  Result result = solver().solve(crossed, start);
  EXPECT_EQ(result.claim, Claim::refused);
  EXPECT_THAT(result.message, ::testing::HasSubstr("x1"));
  EXPECT_EQ(crossed.count, 0);
  const Hooked sound(solver(), [](int, double value) { return value; });
  result = solver().solve(sound, std::vector<double>{1.0, 2.0, 3.0});
  EXPECT_EQ(result.claim, Claim::refused);
  EXPECT_EQ(result.verification.verdict, Verdict::none);
  EXPECT_EQ(sound.count, 0);
}

TEST_P(Negative, AStartOutsideTheBoundsIsProjectedAndSaidSo) {
  Hooked problem(solver(), [](int, double value) { return value; });
  problem.recording = true;
  const Result result = solver().solve(problem, std::vector<double>{10.0, 0.0}, limited());
  EXPECT_THAT(result.message, ::testing::HasSubstr("projected"));
  for (const std::vector<double>& x : problem.points) EXPECT_LE(x[0], 4.0);
}

TEST_P(Negative, ThreeLimitsThreeStatuses) {
  const auto check = [&](const Result& result, Claim claim, bool point) {
    EXPECT_EQ(result.claim, claim) << to_string(result.claim) << ": " << result.message;
    if (point) {
      EXPECT_TRUE(result.verification.verdict == Verdict::feasible || result.verification.verdict == Verdict::optimal);
    }
  };
  Options options;
  options.evaluation_limit = linear() ? 0 : 3;
  const Hooked plain(solver(), [](int, double value) { return value; });
  check(solver().solve(plain, start, options), Claim::evaluation_limit, !linear());
  EXPECT_LE(plain.count, 3 + 1);  // and one of the verifier's

  options = {};
  options.time_limit = 0.02;
  const Hooked slow(solver(), [](int count, double value) {
    if (count == 1) std::this_thread::sleep_for(std::chrono::milliseconds(40));
    return value;
  });
  check(solver().solve(slow, start, options), Claim::time_limit, true);

  options = {};
  std::atomic<bool> cancel = false;
  options.cancel = &cancel;
  const Hooked cancelling(solver(), [&](int count, double value) {
    if (count == (linear() ? 1 : 3)) cancel = true;
    return value;
  });
  check(solver().solve(cancelling, start, options), Claim::cancelled, true);
}

TEST_P(Negative, StoppingKeepsTheBestFeasiblePoint) {
  if (linear()) GTEST_SKIP() << "evaluates once";
  double best = infinity;
  const Hooked problem(solver(), [&](int count, double value) {
    if (count <= 6) best = std::min(best, value);
    return value;
  });
  Options options;
  options.evaluation_limit = 6;
  const Result result = solver().solve(problem, start, options);
  if (result.claim == Claim::evaluation_limit) {
    EXPECT_DOUBLE_EQ(result.verification.objective, best);
  }
}

TEST_P(Negative, UnknownOptionsAreErrors) {
  const Hooked problem(solver(), [](int, double value) { return value; });
  Options options;
  options.native["no_such_option"] = "1";
  EXPECT_THROW(solver().solve(problem, start, options), std::invalid_argument);
  EXPECT_EQ(problem.count, 0);
}

TEST_P(Negative, SolvedTwiceGivesTheSame) {
  const Hooked problem(solver(), [](int, double value) { return value; });
  const Result first = solver().solve(problem, start), second = solver().solve(problem, start);
  EXPECT_EQ(first.x, second.x);
  EXPECT_EQ(first.counts.objective, second.counts.objective);
}

TEST_P(Negative, WritesNothing) {
  Capture capture;
  const Hooked sound(solver(), [](int, double value) { return value; });
  const Hooked broken(solver(), [](int, double) { return nan; });
  const Hooked breaking(solver(), [](int count, double value) { return count > 3 ? nan : value; });
  for (const Hooked* problem : {&sound, &broken, &breaking}) solver().solve(*problem, start, limited());
  for (const FormulaProblem& problem : {infeasible_linear(), infeasible_curved(), unbounded()}) {
    if (solvers::reason_to_refuse(solver(), problem).empty())
      solver().solve(problem, std::vector<double>{1.0, 2.0}, limited());
  }
  EXPECT_EQ(capture.text(), "");
}

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const auto& solver : solvers::registry()) all.push_back(solver->name());
  return all;
}

INSTANTIATE_TEST_SUITE_P(All, Negative, ::testing::ValuesIn(names()), [](const auto& info) {
  std::string name = info.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST(Threads, EveryAlgorithmAtOnceGivesWhatItGivesAlone) {
  struct Job {
    const Solver* solver;
    const Case* c;
    std::vector<double> alone, together;
  };
  std::vector<Job> jobs;
  Options options;
  options.evaluation_limit = 1500;
  for (const auto& solver : solvers::registry()) {
    for (const Case& c : cases()) {
      if (solvers::reason_to_refuse(*solver, c.problem).empty()) jobs.push_back({solver.get(), &c, {}, {}});
    }
  }
  for (Job& job : jobs) job.alone = job.solver->solve(job.c->problem, job.c->start, options).x;
  std::atomic<std::size_t> next = 0;
  std::vector<std::thread> threads;
  for (int i = 0; i < 8; ++i) {
    threads.emplace_back([&] {
      for (std::size_t j = next++; j < jobs.size(); j = next++) {
        jobs[j].together = jobs[j].solver->solve(jobs[j].c->problem, jobs[j].c->start, options).x;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const Job& job : jobs) EXPECT_EQ(job.alone, job.together) << job.solver->name() << ", " << job.c->problem.name();
}

}  // namespace
}  // namespace accdec::testing
