#include <exception>
#include <stdexcept>
#include <string>

#include <accdec/files.hpp>
#include <accdec/formats/si_names.hpp>
#include <accdec/problem.hpp>

#include "bindings.hpp"

namespace accdec::python {
namespace {

// The classes live as long as the process: exceptions may come until the interpreter has ended.
PyObject* input_error = nullptr;
PyObject* output_error = nullptr;
PyObject* stop_run = nullptr;

PyObject* new_class(py::module_& module, const char* name, PyObject* base, const char* doc) {
  const std::string full = std::string("accdec.") + name;
  // Errors that Python code raises have the attributes, too.
  const py::dict members(py::arg("file") = "", py::arg("line") = 0, py::arg("column") = 0, py::arg("message") = "",
                         py::arg("pointer") = "");
  PyObject* made =
      PyErr_NewExceptionWithDoc(full.c_str(), doc, base, base == PyExc_ValueError ? members.ptr() : nullptr);
  if (made == nullptr) throw py::error_already_set();
  module.add_object(name, py::reinterpret_borrow<py::object>(made));
  return made;
}

void raise_input_error(const InputError& error) {
  py::object said = py::str(error.what());
  // Without a place in a file it is about arguments, whose names are there already.
  if (error.line() == 0 && error.file() == "task")
    said = py::module_::import("accdec._fields").attr("in_python_words")(said);
  py::object raised = py::reinterpret_borrow<py::object>(input_error)(said);
  raised.attr("file") = error.file();
  raised.attr("line") = error.line();
  raised.attr("column") = error.column();
  raised.attr("message") = error.message();
  raised.attr("pointer") = error.pointer();
  PyErr_SetObject(input_error, raised.ptr());
}

}  // namespace

py::object in_python_words(const std::string& said) {
  return py::module_::import("accdec._fields").attr("in_python_words")(in_si_names(said, ""));
}

void bind_errors(py::module_& module) {
  input_error = new_class(
      module, "InputError", PyExc_ValueError,
      "Something in a task, program, study or result is wrong.\n\nThe text is that of the command line, "
      "``file:line:column: what is wrong; what is allowed``; `file`, `line`, `column` (from 1; 0: none), `message` and "
      "`pointer` (a JSON pointer, or empty) are its parts.");
  output_error =
      new_class(module, "OutputError", PyExc_OSError, "A file could not be written; nothing is left behind.");
  stop_run = new_class(module, "StopRun", PyExc_Exception,
                       "A solver's run is to end: raised inside a problem's functions at its limits of time and "
                       "evaluations. Let it pass; the best point seen is the answer.");
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const InputError& error) {
      raise_input_error(error);
    } catch (const std::invalid_argument& error) {
      PyErr_SetObject(PyExc_ValueError, in_python_words(error.what()).ptr());
    } catch (const OutputError& error) {
      PyErr_SetString(output_error, error.what());
    } catch (const nlp::StopRun& stop) {
      PyErr_SetString(stop_run, stop.what());
    }
  });
}

}  // namespace accdec::python
