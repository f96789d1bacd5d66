#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include <accdec/corner.hpp>
#include <accdec/paper/paper_case.hpp>
#include <accdec/paper/paper_figures.hpp>
#include <accdec/task/simulation.hpp>

namespace accdec::paper {
namespace {

constexpr double mm = 1e-3, um = 1e-6;
const double sin_half = std::sin(0.5 * angle), cos_half = std::cos(0.5 * angle);

/// Direction of a leg in the a-b frame: leg 1 runs down towards the a-axis, leg 2 up from it.
Corner a_b_corner(double feed_in, double ratio) {
  return make_corner(Eigen::Vector2d(sin_half, -cos_half), Eigen::Vector2d(sin_half, cos_half), feed_in,
                     ratio * feed_in);
}

/// Appends the components of both legs and their sums, mm/s, over k = first .. last.
void add_components(FigureData& data, const Filter& filter, int delay, int first, int last, const std::string& suffix) {
  const Corner corner = a_b_corner(figure_feed, 1.0);
  const Blend blend(filter, corner, delay, sample_period);
  std::array<Column, 6> columns;
  const std::array<const char*, 6> names{"v1a", "v2a", "va", "v1b", "v2b", "vb"};
  for (std::size_t i = 0; i < 6; ++i) columns[i].name = fmt::format("{}{}_mm_s", names[i], suffix);
  for (int k = first; k <= last; ++k) {
    const double in = blend.speed_in(k) / mm, out = blend.speed_out(k) / mm;
    const std::array<double, 6> row{in * sin_half,  out * sin_half, (in + out) * sin_half,
                                    -in * cos_half, out * cos_half, (out - in) * cos_half};
    for (std::size_t i = 0; i < 6; ++i) columns[i].values.push_back(row[i]);
  }
  data.columns.insert(data.columns.end(), columns.begin(), columns.end());
}

Column sample_times(int first, int last) {
  Column time{"t_ms", {}};
  for (int k = first; k <= last; ++k) time.values.push_back(k * sample_period * 1e3);
  return time;
}

LinearCorner figure12_linear(int delay, double theta) {
  return {theta, figure12_feed, figure12_ratio * figure12_feed, ramp_samples * sample_period, delay * sample_period};
}

constexpr int margin = 5;  ///< samples shown before and after the blend
constexpr int last_shown = ramp_samples + figure_delay + margin;

}  // namespace

const std::vector<double>& FigureData::operator[](const std::string& name) const {
  for (const Column& column : columns) {
    if (column.name == name) return column.values;
  }
  throw std::out_of_range(fmt::format("figure {} has no column {}", number, name));
}

FigureData figure5() {
  const SampledMotion motion = simulate_corner(linear(), a_b_corner(figure_feed, 1.0), 0, sample_period);
  FigureData data{5, {{"t_ms", {}}, {"va_mm_s", {}}, {"vb_mm_s", {}}}};
  for (int n = 0; n < motion.velocity.rows(); ++n) {
    data.columns[0].values.push_back((n - motion.corner) * sample_period * 1e3);
    data.columns[1].values.push_back(motion.velocity(n, 0) / mm);
    data.columns[2].values.push_back(motion.velocity(n, 1) / mm);
  }
  return data;
}

FigureData figure6() {
  FigureData data{6, {sample_times(-margin, last_shown)}};
  const Filter filter = linear();
  const Corner corner = a_b_corner(figure_feed, 1.0);
  for (const int delay : {0, figure_delay}) {
    const Blend blend(filter, corner, delay, sample_period);
    const std::string suffix = fmt::format("_d{}_mm_s", delay);
    Column in{"v1" + suffix, {}}, out{"v2" + suffix, {}}, speed{"v" + suffix, {}};
    for (int k = -margin; k <= last_shown; ++k) {
      in.values.push_back(blend.speed_in(k) / mm);
      out.values.push_back(blend.speed_out(k) / mm);
      speed.values.push_back(blend.tangential_speed(k) / mm);
    }
    data.columns.insert(data.columns.end(), {in, out, speed});
  }
  return data;
}

FigureData figure7() {
  FigureData data{7, {sample_times(-margin, ramp_samples + margin)}};
  add_components(data, linear(), 0, -margin, ramp_samples + margin, "");
  return data;
}

FigureData figure8() {
  FigureData data{8, {sample_times(-margin, last_shown)}};
  add_components(data, linear(), figure_delay, -margin, last_shown, "");
  return data;
}

FigureData figure10() {
  FigureData data{10, {sample_times(-margin, last_shown)}};
  for (const int delay : {0, figure_delay})
    add_components(data, fir(), delay, -margin, last_shown, fmt::format("_d{}", delay));
  return data;
}

FigureData figure9() {
  FigureData data{9, {{"dT_ms", {}}}};
  for (int d = 0; d <= ramp_samples; ++d) data.columns[0].values.push_back(d * sample_period * 1e3);
  for (const char* ratio : {"1", "1.5", "2", "3", "5", "10"}) {
    Column column{fmt::format("error_c{}_um", ratio), {}};
    const double c = std::stod(ratio);
    for (int d = 0; d <= ramp_samples; ++d) {
      const LinearCorner corner(angle, figure_feed, c * figure_feed, ramp_samples * sample_period, d * sample_period);
      column.values.push_back(corner.corner_error() / um);
    }
    data.columns.push_back(column);
  }
  return data;
}

FigureData figure11() {
  FigureData data{11, {{"dT_samples", {}}, {"c", {}}, {"E_ms", {}}}};
  const Filter filter = fir();
  for (int quarter = 4; quarter <= 20; ++quarter) {
    for (int d = 0; d <= 24; ++d) {
      const double c = 0.25 * quarter;
      const Corner corner = a_b_corner(figure_feed, c);
      data.columns[0].values.push_back(d);
      data.columns[1].values.push_back(c);
      data.columns[2].values.push_back(corner_error(Blend(filter, corner, d, sample_period)) / figure_feed * 1e3);
    }
  }
  return data;
}

double figure12_error(Processor processor, int delay, double theta) {
  if (processor == Processor::linear) return figure12_linear(delay, theta).sampled_corner_error(sample_period);
  const Corner corner = planar_corner(theta, 0.0, Turn::left, figure12_feed, figure12_ratio * figure12_feed);
  return corner_error(Blend(processor == Processor::fir ? fir() : quintic(), corner, delay, sample_period));
}

int figure12_delay(Processor processor, double theta) {
  const double bound = figure12_error(Processor::fir, 0, theta);
  int delay = 0;
  while (figure12_error(processor, delay, theta) > bound) ++delay;
  return delay;
}

FigureData figure12_paths() {
  FigureData data{12, {{"k", {}}}};
  constexpr int last = ramp_samples + 14;
  for (int k = -margin; k <= last; ++k) data.columns[0].values.push_back(k);
  const Corner corner = a_b_corner(figure12_feed, figure12_ratio);
  const auto add = [&](const char* name, Processor processor, int delay) {
    const Filter filter = processor == Processor::fir ? fir() : quintic();
    const Blend blend(filter, corner, delay, sample_period);
    const LinearCorner exact = figure12_linear(delay, angle);
    Column a{fmt::format("{}_d{}_a_mm", name, delay), {}}, b{fmt::format("{}_d{}_b_mm", name, delay), {}};
    for (int k = -margin; k <= last; ++k) {
      const Eigen::Vector2d s =
          processor == Processor::linear ? exact.position(k * sample_period) : Eigen::Vector2d(blend.position(k));
      a.values.push_back(s[0] / mm);
      b.values.push_back(s[1] / mm);
    }
    data.columns.push_back(a);
    data.columns.push_back(b);
  };
  add("linear", Processor::linear, 0);
  add("scurve", Processor::s_curve, 0);
  add("fir", Processor::fir, 0);
  add("linear", Processor::linear, 12);
  add("scurve", Processor::s_curve, 4);
  add("linear", Processor::linear, 14);
  return data;
}

FigureData figure12_errors() {
  FigureData data{12, {{"delay_samples", {}}, {"linear_um", {}}, {"scurve_um", {}}, {"fir_um", {}}}};
  for (int d = 0; d <= ramp_samples; ++d) {
    data.columns[0].values.push_back(d);
    data.columns[1].values.push_back(figure12_error(Processor::linear, d) / um);
    data.columns[2].values.push_back(figure12_error(Processor::s_curve, d) / um);
    data.columns[3].values.push_back(figure12_error(Processor::fir, d) / um);
  }
  return data;
}

double mean_absolute_deviation(const Filter& filter) {
  double sum = 0.0;
  for (int i = 0; i <= filter.order(); ++i) sum += filter.tap(i) * std::abs(i - filter.mean_delay());
  return sum;
}

EqualLimits equal_limits() {
  const Filter reference = fir();
  EqualLimits e;
  e.fir_mad = mean_absolute_deviation(reference);
  const auto largest = [](const Filter& f) { return *std::max_element(f.taps().begin(), f.taps().end()); };
  const auto steepest = [](const Filter& f) {
    double step = 0.0;
    for (int i = 0; i <= f.order() + 1; ++i) step = std::max(step, std::abs(f.tap(i) - f.tap(i - 1)));
    return step;
  };
  e.tap_max = largest(reference);
  e.step_max = steepest(reference);
  // No tap can exceed this envelope. So no filter has an order whose envelope sums to less than 1.
  for (;; ++e.least_order) {
    std::vector<double> envelope;
    e.least_sum = 0.0;
    for (int i = 0; i <= e.least_order; ++i) {
      envelope.push_back(std::min({e.tap_max, (i + 1) * e.step_max, (e.least_order + 1 - i) * e.step_max}));
      e.least_sum += envelope.back();
    }
    if (e.least_sum < 1.0) continue;
    e.envelope_mad = mean_absolute_deviation(Filter(envelope));
    break;
  }
  constexpr double rounding = 1.0 + 1e-12;
  for (int n = e.least_order; e.trapezoid_order == 0; ++n) {
    for (int ramp = n / 2; ramp >= 0; --ramp) {
      const Filter candidate = trapezoid(n, ramp);
      if (largest(candidate) > e.tap_max * rounding || steepest(candidate) > e.step_max * rounding) continue;
      e.trapezoid_order = n;
      e.trapezoid_ramp = ramp;
      e.trapezoid_mad = mean_absolute_deviation(candidate);
      break;
    }
  }
  e.boxcar_order = static_cast<int>(std::ceil(1.0 / (e.tap_max * rounding))) - 1;
  e.boxcar_mad = mean_absolute_deviation(boxcar(e.boxcar_order));
  return e;
}

}  // namespace accdec::paper
