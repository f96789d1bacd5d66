#include <algorithm>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <accdec/machine/limits.hpp>
#include <accdec/machine/utilisation.hpp>
#include <accdec/motion/smallest_delay.hpp>
#include <accdec/task/simulation.hpp>
#include <accdec/task/task.hpp>

#include "bindings.hpp"

namespace accdec::python {
namespace {

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

Filter filter_of(const Numbers& taps) {
  if (taps.ndim() != 1) throw std::invalid_argument("taps: one dimension is needed, b_0 .. b_N");
  return Filter(std::vector<double>(taps.data(), taps.data() + taps.size()));
}

/// A matrix of the simulation, samples by axes, handed over without a copy: the array keeps it.
py::array as_array(Eigen::MatrixXd&& matrix) {
  auto kept = std::make_unique<Eigen::MatrixXd>(std::move(matrix));
  const Eigen::MatrixXd& m = *kept;
  const py::capsule owner(kept.get(), [](void* p) { delete static_cast<Eigen::MatrixXd*>(p); });
  kept.release();
  constexpr auto size = static_cast<py::ssize_t>(sizeof(double));
  return py::array_t<double>({m.rows(), m.cols()}, {size, size * m.rows()}, m.data(), owner);
}

py::dict simulate(const Task& task, const Numbers& taps, std::size_t corner, int delay) {
  const Filter filter = filter_of(taps);
  if (delay < 0) throw std::invalid_argument("delay: allowed is a whole number of samples >= 0");
  SampledMotion motion;
  Eigen::MatrixXd force, power;
  Eigen::VectorXd time;
  {
    const py::gil_scoped_release release;
    motion = simulate_corner(filter, task.corners.at(corner).geometry(), delay, task.sample_period);
    const Eigen::Index rows = motion.velocity.rows(), axes = motion.velocity.cols();
    force.resize(rows, axes), power.resize(rows, axes), time.resize(rows);
    std::vector<AxisSampler> samplers;
    for (const Axis& axis : task.machine.axes) samplers.emplace_back(axis, task.sample_period);
    for (Eigen::Index n = 0; n < rows; ++n) {
      time[n] = static_cast<double>(n - motion.corner) * task.sample_period;
      for (Eigen::Index a = 0; a < axes; ++a) {
        const AxisState state =
            samplers[static_cast<std::size_t>(a)].next(motion.velocity(n, a), motion.acceleration(n, a));
        force(n, a) = state.force, power(n, a) = state.motoring;
      }
    }
  }
  py::dict d;
  d["time"] = py::array_t<double>(time.size(), time.data());
  d["position"] = as_array(std::move(motion.position));
  d["velocity"] = as_array(std::move(motion.velocity));
  d["acceleration"] = as_array(std::move(motion.acceleration));
  d["jerk"] = as_array(std::move(motion.jerk));
  d["force"] = as_array(std::move(force));
  d["power"] = as_array(std::move(power));
  d["start"] = motion.start, d["corner"] = motion.corner, d["stop"] = motion.stop;
  return d;
}

/// Calls `part(first, last)` for parts of 0 .. count on all cores.
template <class Part>
void in_parallel(std::size_t count, Part part) {
  constexpr std::size_t worth_a_thread = 20'000;
  const std::size_t cores = std::max(1u, std::thread::hardware_concurrency());
  const std::size_t parts = std::clamp<std::size_t>(count / worth_a_thread, 1, cores);
  std::vector<std::thread> threads;
  for (std::size_t i = 1; i < parts; ++i) threads.emplace_back(part, count * i / parts, count * (i + 1) / parts);
  part(0, count / parts);
  for (std::thread& thread : threads) thread.join();
}

/// All arrays have the same size: the caller broadcasts and checks ranges.
py::array_t<int> smallest_delay(const Numbers& taps, const Numbers& cos_interior, const Numbers& step_in,
                                const Numbers& step_out, const Numbers& error_max) {
  const DelayFinder find(filter_of(taps));
  const py::ssize_t count = cos_interior.size();
  if (step_in.size() != count || step_out.size() != count || error_max.size() != count)
    throw std::invalid_argument("smallest_delay: arrays of one size are needed");
  py::array_t<int> delays(count);
  int* out = delays.mutable_data();
  const double *c = cos_interior.data(), *in = step_in.data(), *leave = step_out.data(), *bound = error_max.data();
  const py::gil_scoped_release release;
  in_parallel(static_cast<std::size_t>(count), [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) out[i] = find(c[i], in[i], leave[i], bound[i]);
  });
  return delays;
}

py::array_t<double> residual(const Numbers& taps, const Numbers& frequency, double sample_period) {
  const Filter filter = filter_of(taps);
  py::array_t<double> out(frequency.size());
  double* to = out.mutable_data();
  const double* f = frequency.data();
  const py::gil_scoped_release release;
  for (py::ssize_t i = 0; i < frequency.size(); ++i) to[i] = residual_vibration(filter, f[i], sample_period);
  return out;
}

}  // namespace

void bind_motion(py::module_& module) {
  module.def("simulate", &simulate, py::arg("task"), py::arg("taps"), py::arg("corner"), py::arg("delay"));
  module.def("smallest_delay", &smallest_delay, py::arg("taps"), py::arg("cos_interior"), py::arg("step_in"),
             py::arg("step_out"), py::arg("error_max"));
  module.def("residual_vibration", &residual, py::arg("taps"), py::arg("frequency"), py::arg("sample_period"));
}

}  // namespace accdec::python
