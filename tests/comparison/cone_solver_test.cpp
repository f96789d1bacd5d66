#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <unistd.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <accdec/exact/exact.hpp>
#include <accdec/instances/instance.hpp>

#include "support/paths.hpp"
#include "support/tasks.hpp"

// The cone programs of a design, handed to a cone solver (cvxopt's conelp) as files, against the exact method's linear
// programs.

namespace accdec {
namespace {

bool has_cvxopt() {
  return std::system("/usr/bin/python3 -c 'import cvxopt' > /dev/null 2>&1") == 0;
}

/// Least (error / tolerance)^2 at these places, as a CBF file.
std::string program(const Task& task, int order, int delay, int sample) {
  FormulationOptions options;
  options.order = order;
  options.margin = 0.0;
  options.blend_delays = {delay};
  const MarginProblem problem(task, options, std::vector<int>{sample});
  return instances::cbf_text(instances::instance_of(problem, problem.start_from(boxcar(order)))).content;
}

constexpr const char* script = R"(import glob, sys
sys.path.insert(0, sys.argv[1])
import cone_solver
for file in sorted(glob.glob(sys.argv[2] + "/*.cbf")):
    status, objective, _ = cone_solver.solve(file)
    print(status.split()[0], {"optimal": objective, "primal infeasible": "inf"}.get(status, "nan"))
)";

/// The least optimum of all of them.
double solved_by_cvxopt(const std::vector<std::string>& programs) {
  const std::filesystem::path folder =
      std::filesystem::path(::testing::TempDir()) / fmt::format("accdec_cones.{}", ::getpid());
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "solve.py") << script;
  for (std::size_t i = 0; i < programs.size(); ++i) std::ofstream(folder / fmt::format("{:06}.cbf", i)) << programs[i];
  const std::string command = fmt::format(
      "OPENBLAS_NUM_THREADS=1 /usr/bin/python3 '{0}/solve.py' '{1}/problems/suite' '{0}' > '{0}/answers.txt'",
      folder.string(), test_support::source_folder());
  EXPECT_EQ(std::system(command.c_str()), 0);
  std::ifstream answers(folder / "answers.txt");
  double least = unlimited;
  std::size_t read = 0, unknown = 0;
  for (std::string status, value; answers >> status >> value; ++read) {
    if (value == "nan")
      ++unknown;
    else
      least = std::min(least, std::stod(value));
  }
  std::filesystem::remove_all(folder);
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

// At the shortest design's own place the error is within the tolerance; a sample shorter it is not, at every order,
// delay and sample.
TEST(ConeSolver, AgreesWithTheExactMethod) {
  if (!has_cvxopt()) GTEST_SKIP() << "python3-cvxopt is not installed";
  for (const Task& task : corners()) {
    const DesignResult shortest = design_exact(task);
    ASSERT_EQ(shortest.status, Status::optimal);
    const int order = shortest.filter->order(), delay = shortest.corners[0].delay, total = order + delay;
    std::vector<std::string> same, shorter;
    for (int k = delay; k <= order; ++k) same.push_back(program(task, order, delay, k));
    for (int n = (total - 1) / 2; n < total; ++n) {
      const int d = total - 1 - n;
      for (int k = std::min(d, n); k <= std::max(d, n); ++k) shorter.push_back(program(task, n, d, k));
    }
    EXPECT_LT(solved_by_cvxopt(same), 1.0 + 1e-6);
    EXPECT_GT(solved_by_cvxopt(shorter), 1.0 - 1e-7);
  }
}

}  // namespace
}  // namespace accdec
