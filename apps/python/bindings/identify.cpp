#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/stl.h>

#include <accdec/design/identify.hpp>
#include <accdec/formats/motion_log_file.hpp>

#include "bindings.hpp"
#include "interrupt.hpp"

namespace accdec::python {
namespace {

/// The table [filter] of a task.
py::dict filter_dict(const FilterSpec& spec) {
  py::dict table(py::arg("kind") = std::string(to_string(spec.kind)));
  const ShapeInfo& shape = info(spec.kind);
  if (shape.has_order) table["order"] = spec.order;
  if (shape.parameter)
    std::visit([&](auto member) { table[py::str(std::string(shape.parameter->key))] = spec.*member; },
               shape.parameter->member);
  if (const ShaperInfo* shaper = shaper_of(spec))
    table["shaper"] = std::string(shaper->name), table["shaper_delay"] = spec.pair_delay;
  return table;
}

py::dict alias_dict(const FittedFilter& alias) {
  return py::dict(py::arg("family") = std::string(to_string(alias.family)),
                  py::arg("filter") = filter_dict(alias.filter));
}

py::dict fit_dict(const FittedFilter& fit) {
  const auto move = [](const LoggedMove& m) {
    return py::dict(py::arg("first") = m.first, py::arg("samples") = m.samples, py::arg("first_step") = m.first_step,
                    py::arg("last_step") = m.last_step, py::arg("way") = m.way);
  };
  return py::dict(py::arg("family") = std::string(to_string(fit.family)), py::arg("filter") = filter_dict(fit.filter),
                  py::arg("rms") = fit.rms, py::arg("sigmas") = fit.sigmas, py::arg("likelihood") = fit.likelihood,
                  py::arg("time_constant") = fit.time_constant, py::arg("second_constant") = fit.second_constant,
                  py::arg("moves") = list_of(fit.moves, move), py::arg("aliases") = list_of(fit.aliases, alias_dict));
}

py::dict found_dict(const Identification& found, const MotionLog& log) {
  py::dict modelled;
  for (std::size_t a = 0; a < log.axes.size(); ++a)
    modelled[py::str(log.axes[a])] =
        py::array_t<double>(static_cast<py::ssize_t>(found.modelled[a].size()), found.modelled[a].data());
  const py::list fits = list_of(found.fits, fit_dict);
  return py::dict(py::arg("fits") = fits, py::arg("taps") = fit_dict(found.taps), py::arg("noise") = found.noise,
                  py::arg("rounding") = found.rounding, py::arg("moves") = fits[0]["moves"],
                  py::arg("modelled") = modelled);
}

/// @param file  of a log; empty: `axes` and `positions` are the log
py::dict identify_log(const std::shared_ptr<Task>& task, const std::string& file, const std::vector<std::string>& axes,
                      const std::vector<std::vector<double>>& positions, std::optional<double> noise,
                      std::optional<double> feed, const std::string& units, const py::object& progress) {
  MotionLog log{axes, positions};
  const ColumnUnits of_columns = units.empty() ? ColumnUnits{} : column_units(units);
  if (!file.empty()) log = read_motion_log(file, task->sample_period, of_columns);
  const auto found = std::make_shared<Identification>();
  run_interruptibly(
      [=](const Work&) {
        IdentifyOptions options;
        options.noise = noise;
        options.feed = feed;
        *found = identify(log, *task, options);
      },
      progress);
  return found_dict(*found, log);
}

}  // namespace

void bind_identify(py::module_& module) {
  module.def("identify", &identify_log, py::arg("task"), py::kw_only(), py::arg("file"), py::arg("axes"),
             py::arg("positions"), py::arg("noise"), py::arg("feed"), py::arg("units"), py::arg("progress"));
}

}  // namespace accdec::python
