#include <algorithm>
#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <accdec/corner.hpp>
#include <accdec/machine.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/task.hpp>
#include <accdec/task/simulation.hpp>
#include <accdec/task/verification_cost.hpp>

#include "bindings.hpp"
#include "interrupt.hpp"

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

/// The motion of a corner, four matrices, with what it asks of every axis. Behind a response: also the command.
struct Simulation {
  SampledMotion motion;
  std::optional<SampledMotion> command;
  Eigen::MatrixXd force, power;
  Eigen::VectorXd time;
};

Simulation simulate(const Task& task, const Filter& filter, std::size_t corner, int delay) {
  Simulation s;
  SampledResponse sampled =
      simulate_response(filter, task.corners.at(corner).geometry(), delay, task.sample_period, task.machine);
  if (sampled.moved) {
    s.motion = std::move(*sampled.moved);
    s.command = std::move(sampled.command);
  } else {
    s.motion = std::move(sampled.command);
  }
  const Eigen::Index rows = s.motion.velocity.rows(), axes = s.motion.velocity.cols();
  s.force.resize(rows, axes), s.power.resize(rows, axes), s.time.resize(rows);
  std::vector<AxisSampler> samplers;
  const Corner& legs = task.corners.at(corner).geometry();
  const double still = still_part * std::max(legs.feed_in, legs.feed_out);
  for (const Axis& axis : task.machine.axes) samplers.emplace_back(axis, task.sample_period, still);
  for (Eigen::Index n = 0; n < rows; ++n) {
    s.time[n] = static_cast<double>(n - s.motion.corner) * task.sample_period;
    for (Eigen::Index a = 0; a < axes; ++a) {
      const AxisState state =
          samplers[static_cast<std::size_t>(a)].next(s.motion.velocity(n, a), s.motion.acceleration(n, a));
      s.force(n, a) = state.force, s.power(n, a) = state.motoring;
    }
  }
  return s;
}

/// Work so short that Ctrl-C can wait for its end is done at once: a thread would take longer.
void run(bool is_short, const std::function<void(const std::atomic<bool>& cancelled)>& work) {
  if (is_short) {
    const py::gil_scoped_release release;
    work(std::atomic<bool>(false));
  } else {
    run_interruptibly([work](const Work& w) { work(w.cancelled); }, py::none());
  }
}

py::dict simulate(const std::shared_ptr<Task>& task, const Numbers& taps, std::size_t corner, int delay) {
  const Filter filter = filter_of(taps);
  constexpr double matrices = 7.0;  // those of a Simulation
  require_simulation_room(*task, filter.order(), {delay}, matrices);
  const auto s = std::make_shared<Simulation>();
  run(verification_cost(*task, filter.order(), {delay}).seconds() < 5e-3,
      [=](const std::atomic<bool>&) { *s = simulate(*task, filter, corner, delay); });
  py::dict d;
  d["time"] = as_array(Eigen::MatrixXd(std::move(s->time))).attr("ravel")();
  d["position"] = as_array(std::move(s->motion.position));
  d["velocity"] = as_array(std::move(s->motion.velocity));
  d["acceleration"] = as_array(std::move(s->motion.acceleration));
  d["jerk"] = as_array(std::move(s->motion.jerk));
  if (s->command) {
    d["command_position"] = as_array(std::move(s->command->position));
    d["command_velocity"] = as_array(std::move(s->command->velocity));
    d["command_acceleration"] = as_array(std::move(s->command->acceleration));
    d["command_jerk"] = as_array(std::move(s->command->jerk));
  }
  d["force"] = as_array(std::move(s->force));
  d["power"] = as_array(std::move(s->power));
  d["start"] = s->motion.start, d["corner"] = s->motion.corner, d["stop"] = s->motion.stop;
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

std::vector<double> copied(const Numbers& numbers) {
  return {numbers.data(), numbers.data() + numbers.size()};
}

template <class Number>
py::array_t<Number> array_of(const std::vector<Number>& numbers) {
  return py::array_t<Number>(static_cast<py::ssize_t>(numbers.size()), numbers.data());
}

/// All arrays have the same size: the caller broadcasts and checks ranges. They are copied, because an interrupted
/// call may leave its work behind.
py::array_t<int> smallest_delays(const std::shared_ptr<DelayFinder>& find, const Numbers& cos_interior,
                                 const Numbers& step_in, const Numbers& step_out, const Numbers& error_max) {
  const auto count = static_cast<std::size_t>(cos_interior.size());
  for (const Numbers* other : {&step_in, &step_out, &error_max}) {
    if (static_cast<std::size_t>(other->size()) != count)
      throw std::invalid_argument("smallest_delay: arrays of one size are needed");
  }
  struct Corners {
    std::vector<double> cosine, in, out, error;
    std::vector<int> delays;
  };
  const auto corners = std::make_shared<Corners>(
      Corners{copied(cos_interior), copied(step_in), copied(step_out), copied(error_max), std::vector<int>(count)});
  // A corner takes O(N) at worst.
  run(static_cast<double>(count) * (100.0 + find->exact_stop_delay()) < 1e6, [=](const std::atomic<bool>& cancelled) {
    in_parallel(count, [&](std::size_t first, std::size_t last) {
      Corners& c = *corners;
      for (std::size_t i = first; i < last && !cancelled; ++i)
        c.delays[i] = (*find)(c.cosine[i], c.in[i], c.out[i], c.error[i]);
    });
  });
  return array_of(corners->delays);
}

py::array_t<double> residual(const Numbers& taps, const Numbers& frequency, double sample_period) {
  const Filter filter = filter_of(taps);
  const auto values = std::make_shared<std::vector<double>>(copied(frequency));
  run(static_cast<double>(values->size()) * (1.0 + filter.order()) < 1e5, [=](const std::atomic<bool>& cancelled) {
    for (double& value : *values) {
      if (cancelled) return;
      value = residual_vibration(filter, value, sample_period);
    }
  });
  return array_of(*values);
}

}  // namespace

void bind_motion(py::module_& module) {
  module.def("simulate", py::overload_cast<const std::shared_ptr<Task>&, const Numbers&, std::size_t, int>(&simulate),
             py::arg("task"), py::arg("taps"), py::arg("corner"), py::arg("delay"));
  py::class_<DelayFinder, std::shared_ptr<DelayFinder>>(module, "DelayFinder")
      .def(py::init([](const Numbers& taps) { return std::make_shared<DelayFinder>(filter_of(taps)); }),
           py::arg("taps"))
      .def("__call__", &smallest_delays, py::arg("cos_interior"), py::arg("step_in"), py::arg("step_out"),
           py::arg("error_max"));
  module.def("residual_vibration", &residual, py::arg("taps"), py::arg("frequency"), py::arg("sample_period"));
}

}  // namespace accdec::python
