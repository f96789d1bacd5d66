#include <string>
#include <vector>

#include <pybind11/stl.h>

#include <accdec/comparison/comparison_folder.hpp>
#include <accdec/study/study_folder.hpp>

#include "bindings.hpp"

namespace accdec::python {
namespace {

std::function<void(const batch::Progress&)> listener(const py::object& progress) {
  if (progress.is_none()) return {};
  return [progress](const batch::Progress& p) {
    const py::gil_scoped_acquire gil;
    progress(p.done, p.total, p.seconds);
  };
}

/// The options that studies and comparisons share.
template <class Options>
Options options_of(const std::string& out, int workers, const std::string& command, const py::object& progress) {
  Options options;
  options.out = out;
  options.workers = workers;
  options.command = command;
  options.version = ACCDEC_VERSION;
  options.progress = listener(progress);
  return options;
}

template <class Call>
auto without_gil(Call call) {
  const py::gil_scoped_release release;
  return call();
}

}  // namespace

/// Both fork children and so are for a process without other threads: the package runs them in one of its own. Points
/// computed in threads say so from there, which is why the GIL is let go.
void bind_study(py::module_& module) {
  module.def(
      "run_study",
      [](const std::string& path, const std::string& out, int workers, bool large, bool fresh,
         const std::string& command, const py::object& progress) {
        auto options = options_of<StudyRunOptions>(out, workers, command, progress);
        options.large = large;
        options.fresh = fresh;
        const StudySummary s = without_gil([&] { return run_study(read_study(path), options); });
        return py::dict(py::arg("points") = s.points, py::arg("computed") = s.computed, py::arg("found") = s.found,
                        py::arg("bad") = s.bad, py::arg("lost") = s.lost, py::arg("workers") = s.workers,
                        py::arg("wall_time") = s.wall_time, py::arg("method_time") = s.method_time,
                        py::arg("empty_figures") = s.empty_figures);
      },
      py::arg("path"), py::arg("out"), py::arg("workers"), py::arg("large"), py::arg("fresh"), py::arg("command"),
      py::arg("progress"));
  module.def(
      "run_comparison",
      [](const std::string& path, const std::string& out, const std::vector<std::string>& solvers, int workers,
         const std::string& command, const py::object& progress) {
        const auto options = options_of<ComparisonRunOptions>(out, workers, command, progress);
        const ComparisonSummary s = without_gil([&] { return run_comparison(read_suite(path, solvers), options); });
        return py::dict(py::arg("problems") = s.problems, py::arg("runs") = s.runs, py::arg("computed") = s.computed,
                        py::arg("found") = s.found, py::arg("contradictions") = s.contradictions,
                        py::arg("wall_time") = s.wall_time);
      },
      py::arg("path"), py::arg("out"), py::arg("solvers"), py::arg("workers"), py::arg("command"), py::arg("progress"));
}

}  // namespace accdec::python
