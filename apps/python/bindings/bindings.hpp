#pragma once

#include <string>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

// What the files of the module share. One file a subject, each with one function that registers it.

namespace accdec {
struct Figure;
}

namespace accdec::python {

namespace py = pybind11;

void bind_errors(py::module_& module);
void bind_task(py::module_& module);
void bind_result(py::module_& module);
void bind_design(py::module_& module);
void bind_explain(py::module_& module);
void bind_motion(py::module_& module);
void bind_nlp(py::module_& module);
void bind_figure(py::module_& module);
void bind_program(py::module_& module);
void bind_study(py::module_& module);

/// A figure of the library as dicts, lists and arrays.
py::dict figure_dict(const Figure& figure);

/// A path as Python gives it, a text or anything with __fspath__.
inline std::string file_name(const py::object& path) {
  return py::module_::import("os").attr("fspath")(path).cast<std::string>();
}

/// The same array, refusing to be written to: what it shows belongs to somebody else.
inline py::array read_only(py::array array) {
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

}  // namespace accdec::python
