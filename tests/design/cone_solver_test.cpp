#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include <accdec/design/cone_formulation.hpp>
#include <accdec/exact/exact.hpp>

#include "support/tasks.hpp"

// The cone program of a design, handed to a cone solver (cvxopt's conelp), against the exact method's linear programs.

namespace accdec {
namespace {

bool has_cvxopt() {
  return std::system("/usr/bin/python3 -c 'import cvxopt' > /dev/null 2>&1") == 0;
}

/// One program after another: sizes, then c, b, h, A and G by rows and columns.
void write(std::ostream& out, const nlp::ConeData& data) {
  out.precision(17);
  out << data.c.size() << ' ' << data.b.size() << ' ' << data.h.size() << ' ' << data.linear << ' '
      << data.cones.size();
  for (const int n : data.cones) out << ' ' << n;
  for (const auto* numbers : {&data.c, &data.b, &data.h}) {
    for (const double x : *numbers) out << ' ' << x;
  }
  for (const auto* coefficients : {&data.a, &data.g}) {
    out << ' ' << coefficients->size();
    for (const auto& e : *coefficients) out << ' ' << e.row << ' ' << e.column << ' ' << e.value;
  }
  out << '\n';
}

constexpr const char* script = R"(import sys
from cvxopt import matrix, solvers, spmatrix
solvers.options["show_progress"] = False
for line in open(sys.argv[1]):
    it = iter(line.split())
    n, eq, rows, linear, cones = (int(next(it)) for _ in range(5))
    q = [int(next(it)) for _ in range(cones)]
    c, b, h = (matrix([float(next(it)) for _ in range(k)], (k, 1), "d") for k in (n, eq, rows))
    sparse = []
    for k in (eq, rows):
        e = [(int(next(it)), int(next(it)), float(next(it))) for _ in range(int(next(it)))]
        sparse.append(spmatrix([x[2] for x in e], [x[0] for x in e], [x[1] for x in e], (k, n)))
    status = "unknown"
    for tolerance in (1e-9, 1e-8, 1e-7):  # its steps break down now and then
        solvers.options.update(abstol=tolerance, reltol=tolerance, feastol=tolerance)
        try:
            answer = solvers.conelp(c, sparse[1], h, {"l": linear, "q": q, "s": []}, sparse[0], b)
        except (ArithmeticError, ValueError):
            continue
        status = answer["status"]
        if status != "unknown":
            break
    found = {"primal infeasible": "inf", "unknown": "nan"}.get(status) or repr(answer["primal objective"])
    print(status.split()[0], found)
)";

/// The least excess of all of them.
double solved_by_cvxopt(const std::vector<nlp::ConeData>& programs) {
  const std::string folder = ::testing::TempDir() + "accdec_cones";
  std::filesystem::create_directories(folder);
  {
    std::ofstream(folder + "/solve.py") << script;
    std::ofstream file(folder + "/programs.txt");
    for (const nlp::ConeData& data : programs) write(file, data);
  }
  const std::string command =
      "/usr/bin/python3 '" + folder + "/solve.py' '" + folder + "/programs.txt' > '" + folder + "/answers.txt'";
  EXPECT_EQ(std::system(command.c_str()), 0);
  std::ifstream answers(folder + "/answers.txt");
  double least = unlimited;
  std::size_t read = 0, unknown = 0;
  for (std::string status, value; answers >> status >> value; ++read) {
    if (status == "unknown")
      ++unknown;
    else
      least = std::min(least, std::stod(value));
  }
  EXPECT_EQ(read, programs.size());
  EXPECT_LE(unknown, read / 20);
  return least;
}

/// Jerk limits, forces with friction, feeds that differ.
std::vector<Task> corners() {
  std::vector<Task> tasks;
  for (const int i : {0, 3, 4}) {
    Axis axis;
    axis.acceleration_max = 9.0;
    if (i % 2 == 0) axis.jerk_max = 3000.0;
    if (i == 3) axis.mass = 30.0, axis.damping = 200.0, axis.force_max = 220.0;
    tasks.push_back(testing::plane_task(
        axis, testing::plane_corner("A", 40.0 + 25.0 * i, 15.0 * i, 0.1, i == 4 ? 0.07 : 0.1), 50e-6));
  }
  return tasks;
}

// At the shortest design's own place there is no excess; a sample shorter there is one, at every order, delay and
// sample.
TEST(ConeSolver, AgreesWithTheExactMethod) {
  if (!has_cvxopt()) GTEST_SKIP() << "python3-cvxopt is not installed";
  for (const Task& task : corners()) {
    const DesignResult shortest = design_exact(task);
    ASSERT_EQ(shortest.status, Status::optimal);
    const int order = shortest.filter->order(), delay = shortest.corners[0].delay, total = order + delay;
    std::vector<nlp::ConeData> same, shorter;
    for (int k = delay; k <= order; ++k) same.push_back(cone_problem(task, order, {{delay, k}}).data());
    for (int n = (total - 1) / 2; n < total; ++n) {
      const int d = total - 1 - n;
      for (int k = std::min(d, n); k <= std::max(d, n); ++k) shorter.push_back(cone_problem(task, n, {{d, k}}).data());
    }
    EXPECT_LT(solved_by_cvxopt(same), 1e-6);
    EXPECT_GT(solved_by_cvxopt(shorter), -1e-7);
  }
}

}  // namespace
}  // namespace accdec
