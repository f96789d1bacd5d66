#include <algorithm>
#include <array>
#include <iterator>

#include <nlohmann/json.hpp>

#include <accdec/program/write/program_report.hpp>
#include <accdec/program/write/samples.hpp>

namespace accdec {

SampleTable::SampleTable(const Toolpath& path, double sample_period, std::ostream& out)
    : path_(path), period_(sample_period), out_(out) {
  fmt::format_to(std::back_inserter(text_), "time_s");
  for (std::size_t a = 0; a < path.dimensions(); ++a) {
    const std::string unit = path.axes[a] >= 3 && path.axes[a] < 6 ? "deg" : "mm";
    fmt::format_to(std::back_inserter(text_), ",{0}_{1},{0}_{1}_s", path.axis_name(a), unit);
  }
  text_.push_back('\n');
}

void SampleTable::row(std::int64_t k, const double* position, const double* velocity) {
  const auto put = std::back_inserter(text_);
  fmt::format_to(put, "{:.9g}", static_cast<double>(k) * period_);
  for (std::size_t a = 0; a < path_.dimensions(); ++a) {
    fmt::format_to(put, ",{:.9f},{:.6f}", position[a] * 1e3, velocity[a] * 1e3);
  }
  text_.push_back('\n');
  if (text_.size() > 60000) flush();
}

void SampleTable::flush() {
  out_.write(text_.data(), static_cast<std::streamsize>(text_.size()));
  text_.clear();
}

void visit_samples(const ProgramResult& result, const SampleVisitor& row) {
  const Toolpath& path = result.path;
  std::array<double, program_axis_count> x{}, v{};
  std::copy_n(path.point(0), path.dimensions(), x.begin());
  row(std::int64_t{0}, x.data(), v.data());
  const CommandTiming timing(path, result.sample_period, result.plan.delays);
  std::vector<double> errors(path.blocks());
  SimulationOptions options;
  options.samples = [&](std::int64_t first, std::int64_t count, const double* const* position,
                        const double* const* velocity) {
    count = std::min(count, result.plan.simulation.samples + 1 - first);
    for (std::int64_t k = 0; k < count; ++k) {
      for (std::size_t a = 0; a < path.dimensions(); ++a) {
        x[a] = position[a][k];
        v[a] = velocity[a][k] / result.sample_period;
      }
      row(first + k, x.data(), v.data());
    }
  };
  simulate_program(timing, result.legs, 0, path.blocks() - 1, errors, options);
}

void write_samples(const ProgramResult& result, std::ostream& out) {
  SampleTable table(result.path, result.sample_period, out);
  visit_samples(result, [&](std::int64_t k, const double* x, const double* v) { table.row(k, x, v); });
}

void stream_row(const Toolpath& path, const double* position, std::ostream& out) {
  for (std::size_t a = 0; a < path.dimensions(); ++a) {
    out << fmt::format("{}{:.9f}", a == 0 ? "" : " ", position[a] * 1e3);
  }
  out << std::endl;  // the controller waits for it
}

void stream_samples(const ProgramResult& result, std::ostream& out) {
  visit_samples(result, [&](std::int64_t, const double* x, const double*) { stream_row(result.path, x, out); });
}

std::string describe(const PlanTime& plan) {
  return fmt::format("plan {}{}", plan.plan, plan.verified ? "" : ", not verified");
}

std::string describe(const CornerBound& bound) {
  return fmt::format("{} of {} corners between legs longer than cutting them takes, {} linear programs{}",
                     bound.counted, bound.corners, bound.classes, bound.complete ? "" : ", not all of them solved");
}

nlohmann::ordered_json corner_bound_to_json(const CornerBound& bound) {
  return {
      {"corners", bound.corners}, {"counted", bound.counted}, {"classes", bound.classes}, {"complete", bound.complete}};
}

nlohmann::ordered_json plan_times_to_json(const std::vector<PlanTime>& plans) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const PlanTime& plan : plans) {
    list.push_back({{"plan", plan.plan}, {"cycle_time_s", plan.time}, {"verified", plan.verified}});
  }
  return list;
}

}  // namespace accdec
