#include <cmath>
#include <cstdint>
#include <vector>

#include <fmt/format.h>

#include <accdec/bounds/filter_bound.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/plan/report/leg_error.hpp>
#include <accdec/simulate.hpp>
#include <accdec/simulate/command_stream.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// A straight part of the path, and the samples of the motion that feel no other part.
struct JudgedLeg {
  std::size_t first, last;  // blocks
  double from, to;          // samples
};

std::vector<JudgedLeg> judged_legs(const Toolpath& path, const BlockTimes& times, double felt) {
  std::vector<JudgedLeg> legs;
  double from = 0.0;
  for (std::size_t first = 0, last = 0; first < path.blocks(); first = ++last) {
    while (last + 1 < path.blocks() && path.joint[last] == Joint::straight) ++last;
    const double to = last + 1 < path.blocks() ? std::floor(times.begins[last + 1] + near_sample) : unlimited;
    if (from <= to && !is_chord(path, first)) legs.push_back({first, last, from, to});
    from = std::ceil(times.ends[last] - near_sample) + felt + 1.0;
  }
  return legs;
}

double off_leg(const double* at, const double* begin, const double* end, std::size_t n) {
  double along = 0.0, length = 0.0, square = 0.0;
  for (std::size_t a = 0; a < n; ++a) {
    along += (end[a] - begin[a]) * (at[a] - begin[a]);
    length += (end[a] - begin[a]) * (end[a] - begin[a]);
  }
  for (std::size_t a = 0; a < n; ++a) {
    const double off = at[a] - begin[a] - along / length * (end[a] - begin[a]);
    square += off * off;
  }
  return std::sqrt(square);
}

}  // namespace

std::optional<LegError> leg_error(const ProgramResult& result, const Machine& machine) {
  const FilteredCommand* command = result.plan.command();
  if (command == nullptr || command->moved.size() < 2) return std::nullopt;
  const Toolpath& path = result.plan.path;
  const CommandTiming timing(path, result.sample_period, command->delays);
  const int felt = FilterBehind(command->filter, machine, result.sample_period).felt_order();
  const std::vector<JudgedLeg> legs = judged_legs(path, block_times(timing, 0, path.blocks() - 1), felt);
  std::optional<LegError> worst;
  auto leg = legs.begin();
  Motion motion(result.plan, result.sample_period, true);
  for (Sample sample; motion.next(sample); motion.pass_steady()) {
    const auto k = static_cast<double>(sample.number);
    while (leg != legs.end() && leg->to < k) ++leg;
    if (leg == legs.end()) break;
    if (k < leg->from) continue;
    const double off = off_leg(sample.position.data(), path.programmed_point(leg->first),
                               path.programmed_point(leg->last + 1), path.dimensions());
    // At constant feed all samples are as far, but for rounding.
    if (!worst || off > worst->error * (1.0 + 1e-9) + position_floor) worst = {off, path.line[leg->first]};
  }
  return worst;
}

std::string leg_error_text(const ProgramResult& result) {
  if (!result.servo || result.plan.command()->moved.size() < 2) return "";
  if (!result.servo->legs) return "axes lag differently, but every straight leg is too short to be judged by itself";
  return fmt::format("axes lag differently: the motion leaves straight legs by up to {:.4g} um, in line {}",
                     result.servo->legs->error * 1e6, result.servo->legs->line);
}

}  // namespace accdec
