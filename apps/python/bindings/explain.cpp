#include <memory>
#include <string>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <accdec/design.hpp>
#include <accdec/formats/explanation.hpp>
#include <accdec/study/baseline_table.hpp>

#include "bindings.hpp"
#include "interrupt.hpp"

namespace accdec::python {
namespace {

std::shared_ptr<Explanation> explain(const std::shared_ptr<Task>& task, double share, double time_limit,
                                     double design_time_limit, const py::object& progress) {
  const auto result = std::make_shared<std::shared_ptr<Explanation>>();
  run_interruptibly(
      [=](const Work& work) {
        ExplainOptions options;
        options.share = share;
        options.time_limit = time_limit;
        options.design.time_limit = design_time_limit;
        options.design.cancel = &work.cancelled;
        options.progress = [&](int done, int total) { work.tell(fmt::format("{} of about {} designs", done, total)); };
        *result = std::make_shared<Explanation>(explain_task(*task, options));
      },
      progress);
  return *result;
}

std::shared_ptr<DesignResult> shared(const DesignResult& result) {
  return std::make_shared<DesignResult>(result);
}

/// A row of the table; its name and, of a shape, what it was chosen to be are the caller's.
py::dict row(const std::string& name, const DesignResult& result, const FilterSpec* spec) {
  return py::dict(py::arg("filter") = name, py::arg("kind") = spec != nullptr ? to_string(spec->kind) : "",
                  py::arg("parameters") = spec != nullptr ? describe_parameters(*spec, Digits::all) : "",
                  py::arg("exact_stop") = stops_exactly(result), py::arg("result") = shared(result));
}

/// The design, the filter in use today where the task names one, and the best of every family.
py::list baselines(const std::shared_ptr<Task>& task, int finer, double time_limit, const py::object& progress) {
  const auto table = std::make_shared<study::BaselineTable>();
  run_interruptibly(
      [=](const Work& work) {
        DesignOptions options;
        options.time_limit = time_limit;
        options.cancel = &work.cancelled;
        options.progress = work.tell;
        *table = study::compare_with_baselines(finer > 1 ? study::at_shorter_period(*task, finer) : *task, options);
      },
      progress);
  py::list rows;
  rows.append(row("designed", table->design, nullptr));
  if (table->own) rows.append(row("yours", *table->own, &*table->own->task.filter));
  for (std::size_t i = 0; i < table->families.size(); ++i) {
    const FamilyResult& family = table->families[i];
    rows.append(row(accdec::families()[i].title, family.result, family.spec ? &*family.spec : nullptr));
  }
  return rows;
}

/// A part of the same explanation as JSON, which has everything in the words and units of a task file.
py::object part(const Explanation& explanation, const char* name) {
  const py::object all = py::module_::import("json").attr("loads")(explanation_to_json(explanation));
  return all.attr("get")(name, py::list());
}

std::string describe_explanation(const Explanation& e) {
  return fmt::format("<accdec.Explanation \"{}\": {}, {} gains, {} remedies{}>", e.base.task.title,
                     to_string(e.base.status), e.gains.size(), e.remedies.size(), e.complete ? "" : ", not complete");
}

constexpr const char* explanation_doc = R"(The limits that prevent a shorter design, or any design. Made by `explain`.

Its text (`str`, `print`) is that of the command line. Levers are the numbers of a task that more room is given to, by
their keys and in the units of a task file, as `Task.set` takes them.

Attributes
----------
result : Result
    The task's own design.
proved : bool
    Its bound was rechecked: nothing is shorter, or no design exists.
bindings : list of dict
    Places where limits are used to the full: kind, axis, corner, event, samples, bound (as in
    `Result.limits`), frequency_Hz.
gains : list of dict
    Savings by more room, largest first: name, key, levers (name, key, value, relaxed), gain_s, gain_at_most_s (None:
    nothing is proved), objective_s, order, delays_samples, proved, solved.
remedies : list of dict
    If the task is infeasible: the smallest change of each lever that makes it feasible. Each has name, key, helps
    ("yes", "no", "unknown"), levers (name, key, value, enough), share, objective_s, and smallest: whether it is proved
    that less is not enough.
complete : bool
    Everything was tried.
)";

}  // namespace

void bind_explain(py::module_& module) {
  py::options options;
  options.disable_function_signatures();
  py::class_<Explanation, std::shared_ptr<Explanation>>(module, "Explanation", explanation_doc)
      .def_property_readonly("result", [](const Explanation& e) { return shared(e.base); })
      .def_property_readonly("proved", [](const Explanation& e) { return e.base_proved; })
      .def_property_readonly("bindings", [](const Explanation& e) { return part(e, "bindings"); })
      .def_property_readonly("gains", [](const Explanation& e) { return part(e, "gains"); })
      .def_property_readonly("remedies", [](const Explanation& e) { return part(e, "remedies"); })
      .def_property_readonly("complete", [](const Explanation& e) { return e.complete; })
      .def("to_json", &explanation_to_json, "to_json(self)\n--\n\nAs `accdec explain --json` writes it.")
      .def("__repr__", &describe_explanation)
      .def("__str__", [](const Explanation& e) { return explanation_text(e); });
  module.def("explain", &explain, py::arg("task"), py::kw_only(), py::arg("share"), py::arg("time_limit"),
             py::arg("design_time_limit"), py::arg("progress"));
  module.def("baselines", &baselines, py::arg("task"), py::kw_only(), py::arg("finer"), py::arg("time_limit"),
             py::arg("progress"));
}

}  // namespace accdec::python
