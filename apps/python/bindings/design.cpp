#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <pybind11/stl.h>

#include <accdec/design.hpp>
#include <accdec/verify.hpp>

#include "bindings.hpp"
#include "interrupt.hpp"

namespace accdec::python {
namespace {

using ResultPointer = std::shared_ptr<DesignResult>;

struct Arguments {
  std::string method, solver;
  double time_limit, gap;
  std::uint64_t seed;
  int threads;
  std::map<std::string, std::string> native;
  bool certificate;
  std::optional<bool> reduced;
  std::optional<std::vector<double>> start;
};

DesignOptions options_of(const Arguments& given) {
  DesignOptions options;
  options.method = given.method == "nlp" ? Method::nlp : Method::exact;
  options.nlp.solver = given.solver;
  options.time_limit = given.time_limit;
  options.exact.gap = given.gap;
  options.exact.threads = given.threads;
  options.nlp.options.seed = given.seed;
  options.nlp.options.native = given.native;
  options.exact.certificate = given.certificate;
  options.nlp.reduced = given.reduced;
  if (given.start) options.nlp.start = Filter(*given.start);
  return options;
}

/// The result of `make`, which cannot be cancelled: Ctrl-C leaves it.
template <class Make>
ResultPointer made(Make make) {
  const auto result = std::make_shared<ResultPointer>();
  run_interruptibly([=](const Work&) { *result = std::make_shared<DesignResult>(make()); }, py::none());
  return *result;
}

ResultPointer design(const std::shared_ptr<Task>& task, const Arguments& given, const py::object& progress) {
  const auto result = std::make_shared<ResultPointer>();
  run_interruptibly(
      [=, options = options_of(given)](const Work& work) {
        DesignOptions own = options;
        own.cancel = &work.cancelled;
        own.progress = work.tell;
        *result = std::make_shared<DesignResult>(design_task(*task, own));
      },
      progress);
  return *result;
}

}  // namespace

void bind_design(py::module_& module) {
  module.def(
      "design",
      [](const std::shared_ptr<Task>& task, const std::string& method, const std::string& solver, double time_limit,
         double gap, std::uint64_t seed, int threads, const std::map<std::string, std::string>& native,
         bool certificate, std::optional<bool> reduced, std::optional<std::vector<double>> start,
         const py::object& progress) {
        return design(task,
                      {method, solver, time_limit, gap, seed, threads, native, certificate, reduced, std::move(start)},
                      progress);
      },
      py::arg("task"), py::kw_only(), py::arg("method"), py::arg("solver"), py::arg("time_limit"), py::arg("gap"),
      py::arg("seed"), py::arg("threads"), py::arg("native"), py::arg("certificate"), py::arg("reduced"),
      py::arg("start"), py::arg("progress"));
  module.def(
      "assess",
      [](const std::shared_ptr<Task>& task, const std::vector<double>& taps, const std::vector<int>& delays) {
        return made([=, filter = Filter(taps)] { return assess(*task, filter, delays, true); });
      },
      py::arg("task"), py::arg("taps"), py::arg("delays"));
  module.def(
      "evaluate", [](const std::shared_ptr<Task>& task) { return made([=] { return evaluate_task(*task); }); },
      py::arg("task"));
}

}  // namespace accdec::python
