#pragma once

#include <string>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

// Shared by the files of the module. There is one file per subject, each with one function that registers it.

namespace accdec {
struct ChosenSettings;
}  // namespace accdec

namespace accdec::python {

namespace py = pybind11;

void bind_errors(py::module_& module);
void bind_task(py::module_& module);
void bind_result(py::module_& module);
void bind_design(py::module_& module);
void bind_explain(py::module_& module);
void bind_identify(py::module_& module);
void bind_motion(py::module_& module);
void bind_nlp(py::module_& module);
void bind_figure(py::module_& module);
void bind_program(py::module_& module);
void bind_study(py::module_& module);

/// The drawing of `draw`, while other threads of Python run.
template <class Draw>
py::bytes drawn(Draw draw) {
  std::string drawing;
  {
    const py::gil_scoped_release others;
    drawing = draw();
  }
  return drawing;
}

/// The values to set in a controller, with the answer in words.
py::dict settings_dict(const ChosenSettings& settings, const std::string& answer);

/// The library's words, with Python's names of arguments in place of keys of files and options of commands.
py::object in_python_words(const std::string& said);

/// A list with what `make` makes of every item.
template <class Item, class Make>
py::list list_of(const std::vector<Item>& items, Make make) {
  py::list list;
  for (const Item& item : items) list.append(make(item));
  return list;
}

/// An argument of a method, checked like the arguments of the package's functions (accdec/_arguments.py). `check` names
/// a function there that takes a name and a value.
/// @throws TypeError or ValueError of Python that names the argument and what is allowed
template <class Type>
Type argument(const char* check, const char* name, const py::object& value) {
  return py::module_::import("accdec._arguments").attr(check)(name, value).cast<Type>();
}

/// A path as Python gives it, a text or anything with __fspath__.
inline std::string file_name(const py::object& path) {
  return argument<std::string>("path", "path", path);
}

/// The same array, refusing to be written to: what it shows belongs to somebody else.
inline py::array read_only(py::array array) {
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

}  // namespace accdec::python
