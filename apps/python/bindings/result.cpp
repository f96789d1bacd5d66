#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <accdec/files/output_files.hpp>
#include <accdec/formats/certificate_json.hpp>
#include <accdec/machine/limit_unit.hpp>
#include <accdec/result.hpp>
#include <accdec/task/settings_text.hpp>
#include <accdec/verify.hpp>

#include "bindings.hpp"
#include "interrupt.hpp"

namespace accdec::python {

py::dict settings_dict(const ChosenSettings& settings, const std::string& answer) {
  py::list values, kinds;
  for (const Setting& s : settings.values)
    values.append(py::dict(py::arg("name") = s.name, py::arg("value") = s.value, py::arg("unit") = s.unit));
  for (const DelayKind kind : settings.delays) kinds.append(to_string(kind));
  const auto& width = settings.width;
  const auto or_none = [&](double value) { return width ? py::object(py::float_(value)) : py::object(py::none()); };
  return py::dict(py::arg("family") = to_string(settings.family), py::arg("values") = values, py::arg("delays") = kinds,
                  py::arg("width") = or_none(width ? width->middle() : 0.0),
                  py::arg("width_low") = or_none(width ? width->low : 0.0),
                  py::arg("width_high") = or_none(width ? width->high : 0.0), py::arg("answer") = answer);
}

namespace {

bool success(const DesignResult& r) {
  return r.status == Status::optimal || r.status == Status::feasible;
}

/// The numbers of scipy.optimize.milp: 0 optimal, 1 stopped with an answer, 2 infeasible, 4 anything else.
int status_number(const DesignResult& r) {
  switch (r.status) {
    case Status::optimal: return 0;
    case Status::feasible: return 1;
    case Status::infeasible: return 2;
    case Status::failed: break;
  }
  return 4;
}

/// A view of the result's own taps: nothing is copied, and the view keeps the result alive.
py::object taps_view(const py::object& self) {
  const auto& result = self.cast<const DesignResult&>();
  if (!result.filter) return py::none();
  const auto taps = result.filter->taps();
  return read_only(py::array_t<double>(static_cast<py::ssize_t>(taps.size()), taps.data(), self));
}

py::object time_or_none(const DesignResult& r, double time) {
  return r.filter ? py::object(py::float_(time)) : py::object(py::none());
}

py::array_t<int> delays_of(const DesignResult& r) {
  std::vector<int> list;
  for (const CornerResult& corner : r.corners) list.push_back(corner.delay);
  return py::array_t<int>(static_cast<py::ssize_t>(list.size()), list.data());
}

py::list corners(const DesignResult& r) {
  py::list list;
  for (const CornerResult& c : r.corners) {
    list.append(py::dict(py::arg("name") = c.name, py::arg("delay") = c.delay, py::arg("corner_error") = c.corner_error,
                         py::arg("polyline_error") = c.polyline_error,
                         py::arg("contour_deviation") = c.contour_deviation, py::arg("speed_min") = c.speed_min,
                         py::arg("corner_time") = c.corner_time, py::arg("settling_time") = c.settling_time,
                         py::arg("feed_part") = c.feed_part));
  }
  return list;
}

py::list limits(const DesignResult& r) {
  py::list list;
  for (const LimitUse& use : r.limits) {
    const double in_si = si_over_inside(use.kind, use.axis);
    list.append(py::dict(py::arg("kind") = to_string(use.kind), py::arg("axis") = use.axis,
                         py::arg("corner") = use.corner, py::arg("event") = to_string(use.event),
                         py::arg("value") = in_si * use.value, py::arg("bound") = in_si * use.bound,
                         py::arg("utilisation") = use.utilisation, py::arg("sample") = use.sample,
                         py::arg("frequency") = use.frequency));
  }
  return list;
}

py::dict verification(const VerificationReport& v) {
  return py::dict(py::arg("performed") = v.performed, py::arg("feasible") = v.feasible,
                  py::arg("max_violation") = v.max_violation, py::arg("tolerance") = v.tolerance,
                  py::arg("worst") = v.worst, py::arg("certificate_checked") = v.certificate_checked,
                  py::arg("certificate") = v.certificate);
}

py::dict solver(const SolverReport& s) {
  return py::dict(py::arg("method") = s.method, py::arg("name") = s.name, py::arg("version") = s.version,
                  py::arg("claimed") = s.claimed, py::arg("wall_time") = s.wall_time);
}

py::object quantisation(const DesignResult& r) {
  if (!r.quantisation) return py::none();
  return py::dict(py::arg("bits") = r.quantisation->bits, py::arg("coefficients") = r.quantisation->coefficients,
                  py::arg("unquantised") = r.quantisation->unquantised);
}

py::object certificate(const DesignResult& r) {
  if (!r.certificate) return py::none();
  return py::module_::import("json").attr("loads")(certificate_to_json(*r.certificate));
}

/// None for a task without families.
py::object settings_or_none(const DesignResult& r) {
  return r.settings ? py::object(settings_dict(*r.settings, settings_answer(r))) : py::object(py::none());
}

/// Keys of the result as a dict, SciPy's names first.
py::list keys() {
  py::list list;
  for (const char* const name : {"message", "success",        "status",       "fun",          "x",
                                 "mip_gap", "mip_dual_bound", "nfev",         "outcome",      "stop",
                                 "order",   "delays",         "cycle_time",   "corner_time",  "corners",
                                 "limits",  "verification",   "solver",       "quantisation", "certificate",
                                 "task",    "settings",       "family_bound", "free_taps",    "answer"})
    list.append(name);
  return list;
}

/// As SciPy shows its results; what is long is said to be there.
std::string describe_result(const py::object& self) {
  std::string text;
  for (const char* const name : {"message", "success", "status", "outcome", "stop", "fun", "x", "mip_gap",
                                 "mip_dual_bound", "nfev", "order", "delays", "cycle_time", "corner_time"}) {
    const auto value = py::str(self.attr(name)).cast<std::string>();
    text += fmt::format("{:>15}: {}\n", name, value);
  }
  const auto& result = self.cast<const DesignResult&>();
  return text + fmt::format("{:>15}: {} corners, {} limits, verification, solver{}", "also", result.corners.size(),
                            result.limits.size(), result.certificate ? ", certificate" : "");
}

constexpr const char* result_doc = R"(The answer to a task, verified by simulation. Like SciPy's OptimizeResult.

Attributes
----------
x, taps : ndarray or None
    b_0 .. b_N, sum 1: a read-only view of the result's own memory. None without an answer.
fun : float or None
    s, the objective: the cycle time, or the corner time where the task asks for that.
success : bool
    There is a design, and it holds all limits in simulation.
status : int
    As scipy.optimize.milp's: 0 proved optimal; 1 verified, nothing proved; 2 infeasible; 4 failed, see `message`.
outcome : str
    The same in words: "optimal", "feasible", "infeasible", "failed".
stop : str
    Why the design ended: "finished" (nothing more to try), "gap reached", "time limit", "interrupted".
message : str
mip_dual_bound : float or None
    s; no design is shorter, proved.
mip_gap : float or None
    (fun - mip_dual_bound)/fun; 0 when proved optimal.
order : int or None
    N.
delays : ndarray of int
    Samples, one a corner.
cycle_time, corner_time : float or None
    s.
corners : list of dict
    name, delay, corner_error, polyline_error, contour_deviation (m), speed_min (m/s), corner_time, settling_time (s),
    feed_part (of the feed, at which the corner is passed).
limits : list of dict
    The worst use of every limit: kind, axis, corner, event, value, bound (SI; axes a, b and c: rad, and N m of kind
    force), utilisation (1 is the bound), sample, frequency (Hz).
verification, solver : dict
quantisation : dict or None
    With coefficient_bits: bits, coefficients (whole numbers of sum 2**bits), unquantised (s, with free taps).
certificate : dict or None
    The proof, as `verify` rechecks it.
settings : dict or None
    For a task that names families of a controller: family, values (name, value, unit), delays (the kind at each
    corner), width, width_low, width_high (m, in-position), answer (a sentence).
family_bound : float or None
    s; no member of the families is shorter, proved.
answer : str
    Sentences on what to set, as the program prints them first; empty if the task says nothing of a control.
free_taps : float or None
    s; the best design known of free taps with delays of any number of samples.
nfev : int
task : Task
)";

constexpr const char* recheck_doc = R"(The outcome of an independent recheck of a result; true if it is accepted.

Attributes
----------
accepted : bool
reasons : list of str
    Why not; empty when accepted.
proof : str
    The part of the lower bound that was checked, in words; empty without one.
verification : dict
    The findings of the simulation run now.
)";

void bind_recheck(py::module_& module) {
  py::class_<ResultCheck>(module, "Recheck", recheck_doc)
      .def_readonly("accepted", &ResultCheck::accepted)
      .def_readonly("reasons", &ResultCheck::reasons)
      .def_readonly("proof", &ResultCheck::proof)
      .def_property_readonly("verification", [](const ResultCheck& r) { return verification(r.verification); })
      .def("__bool__", [](const ResultCheck& r) { return r.accepted; })
      .def("__repr__", [](const ResultCheck& r) {
        std::string text = r.accepted ? "<accdec.Recheck accepted" : "<accdec.Recheck rejected";
        for (const std::string& reason : r.reasons) text += "; " + reason;
        return text + (r.proof.empty() ? "" : "; proof accepted: " + r.proof) + ">";
      });
  module.def(
      "verify",
      [](const std::shared_ptr<DesignResult>& result, double time_limit) {
        const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(time_limit);
        const auto check = std::make_shared<ResultCheck>();
        run_interruptibly(
            [=](const Work& work) {
              *check = verify_result(*result, [&] { return work.cancelled || std::chrono::steady_clock::now() > end; });
            },
            py::none());
        return *check;
      },
      py::arg("result"), py::arg("time_limit"));
}

using ResultClass = py::class_<DesignResult, std::shared_ptr<DesignResult>>;

/// A result is a mapping of its numbers, too, as SciPy's are.
void bind_mapping(ResultClass& result) {
  result
      .def(
          "keys", [](const DesignResult&) { return keys(); },
          "keys(self)\n--\n\nThe names of the attributes, which are items too: ``result['x']``.")
      .def("__iter__", [](const DesignResult&) { return py::iter(keys()); })
      .def("__len__", [](const DesignResult&) { return py::len(keys()); })
      .def("__contains__", [](const DesignResult&, const py::object& key) { return keys().contains(key); })
      .def("__getitem__", [](const py::object& self, const std::string& key) {
        if (!keys().contains(key)) throw py::key_error(key);
        return self.attr(key.c_str());
      });
}

}  // namespace

void bind_result(py::module_& module) {
  py::options options;
  options.disable_function_signatures();
  ResultClass result(module, "Result", result_doc);
  bind_mapping(result);
  result
      .def_static(
          "parse",
          [](const py::object& text, const py::object& name) {
            return parse_result(argument<std::string>("text", "text", text),
                                argument<std::string>("text", "name", name));
          },
          py::arg("text"), py::arg("name") = "result",
          "parse(text, name='result')\n--\n\nThe text of a result file; `name` is what errors call it.")
      .def_static(
          "read", [](const py::object& path) { return read_result(file_name(path)); }, py::arg("path"),
          "read(path)\n--\n\nA result file, as recorded; `accdec.verify` recomputes it.")
      .def(
          "write",
          [](const DesignResult& r, const py::object& path) { write_file(file_name(path), result_to_json(r)); },
          py::arg("path"), "write(self, path)\n--\n\nAs a result file, whole or not at all.")
      .def_property_readonly("x", &taps_view)
      .def_property_readonly("taps", &taps_view)
      .def_property_readonly("fun", [](const DesignResult& r) { return time_or_none(r, r.objective()); })
      .def_property_readonly("success", &success)
      .def_property_readonly("status", &status_number)
      .def_property_readonly("outcome", [](const DesignResult& r) { return to_string(r.status); })
      .def_property_readonly("stop", [](const DesignResult& r) { return to_string(r.stop); })
      .def_property_readonly("message", [](const DesignResult& r) { return in_python_words(r.message); })
      .def_property_readonly("mip_gap", [](const DesignResult& r) { return r.gap; })
      .def_property_readonly("mip_dual_bound", [](const DesignResult& r) { return r.lower_bound; })
      .def_property_readonly("order",
                             [](const DesignResult& r) {
                               return r.filter ? py::object(py::int_(r.filter->order())) : py::object(py::none());
                             })
      .def_property_readonly("delays", &delays_of)
      .def_property_readonly("cycle_time", [](const DesignResult& r) { return time_or_none(r, r.cycle_time); })
      .def_property_readonly("corner_time", [](const DesignResult& r) { return time_or_none(r, r.corner_time); })
      .def_property_readonly("nfev", [](const DesignResult& r) { return r.solver.evaluations; })
      .def_property_readonly("corners", &corners)
      .def_property_readonly("limits", &limits)
      .def_property_readonly("verification", [](const DesignResult& r) { return verification(r.verification); })
      .def_property_readonly("solver", [](const DesignResult& r) { return solver(r.solver); })
      .def_property_readonly("quantisation", &quantisation)
      .def_property_readonly("certificate", &certificate)
      .def_property_readonly("settings", &settings_or_none)
      .def_property_readonly("family_bound", [](const DesignResult& r) { return r.family_bound; })
      .def_property_readonly("free_taps", [](const DesignResult& r) { return r.free_taps; })
      .def_property_readonly("answer", [](const DesignResult& r) { return settings_answer(r); })
      .def_property_readonly("task", [](const DesignResult& r) { return std::make_shared<Task>(r.task); })
      .def("to_json", &result_to_json, "to_json(self)\n--\n\nThe text of a result file.")
      .def(
          "export_taps",
          [](const DesignResult& r, const py::object& format) {
            return py::bytes(export_taps(r, argument<std::string>("text", "format", format)));
          },
          py::arg("format"), "export_taps(self, format)\n--\n\nThe bytes that `accdec.export` writes.")
      .def("__repr__", &describe_result)
      .def("__str__", &result_text)
      .def(py::pickle([](const DesignResult& r) { return result_to_json(r); },
                      [](const std::string& json) { return parse_result(json, "result"); }));
  module.def(
      "write_file", [](const std::string& path, const std::string& content) { write_file(path, content); },
      py::arg("path"), py::arg("content"));
  bind_recheck(module);
}

}  // namespace accdec::python
