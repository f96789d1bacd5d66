#include <stdexcept>

#include <accdec/instances/instance.hpp>

namespace accdec::instances {

Instance instance_of(const QuadraticProblem& problem, std::span<const double> start) {
  Instance instance{problem.name(), 0, problem.objective_form(), {}, {}};
  for (int i = 0; i < problem.num_variables(); ++i)
    instance.variables.push_back({problem.variable_name(i), problem.variable_bound(i),
                                  start[static_cast<std::size_t>(i)], problem.is_integer(i)});
  for (int r = 0; r < problem.num_rows(); ++r)
    instance.rows.push_back({problem.row_name(r), problem.row_bound(r), problem.polynomial(r), {}});
  if (const auto* delay = dynamic_cast<const DelayProblem*>(&problem)) {
    if (!delay->ideal())
      throw std::invalid_argument(
          "a delay problem behind a servo or the control's smoothing is not written: files have the nearest points of "
          "the filter itself; `accdec compare` takes it");
    instance.order = delay->order();
    for (const Approach& a : delay->approaches())
      instance.rows[static_cast<std::size_t>(a.row)].approaches.push_back(a);
  }
  return instance;
}

Text text_of(const Instance& instance, std::string_view format) {
  if (format == "nl") return nl_text(instance);
  if (format == "mps") return mps_text(instance);
  if (format == "cbf") return cbf_text(instance);
  return dat_s_text(instance);
}

}  // namespace accdec::instances
