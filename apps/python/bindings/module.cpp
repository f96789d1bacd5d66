#include "bindings.hpp"

PYBIND11_MODULE(_core, module) {
  using namespace accdec::python;
  module.doc() = "The compiled part of accdec. Use the package accdec: it has the names, the units and the examples.";
  module.attr("__version__") = ACCDEC_VERSION;
  bind_errors(module);
  bind_task(module);
  bind_result(module);
  bind_design(module);
  bind_explain(module);
  bind_identify(module);
  bind_motion(module);
  bind_nlp(module);
  bind_figure(module);
  bind_program(module);
  bind_study(module);
}
