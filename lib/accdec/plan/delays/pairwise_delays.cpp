#include <algorithm>

#include <accdec/plan/delays/joint_delays.hpp>
#include <accdec/plan/delays/pairwise_delays.hpp>
#include <accdec/simulate/command_stream.hpp>

namespace accdec {
namespace {

/// Blocks of one line of the program are one for the operator: chords of an arc, and steps of the feed on a line.
bool inside_line(const Toolpath& path, std::size_t b) {
  return path.inside_arc[b] != 0 || (path.joint[b] == Joint::straight && path.line[b] == path.line[b + 1]);
}

}  // namespace

PairwiseDelays pairwise_delays(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine,
                               DelayRule rule, const Deadline* until) {
  JointDelays joints(path, filter, sample_period, machine);
  const std::size_t blocks = path.blocks();
  PairwiseDelays result;
  const auto judge = [&](std::size_t b) {
    if (!joints.take_possible()) result.impossible.push_back(b);
  };
  const auto ended = [&] {
    result.limits_possible = until == nullptr || (result.impossible.empty() && !until->over());
    return !result.limits_possible;
  };
  std::vector<int>& delays = result.delays;
  delays.assign(blocks, 0);
  // All joints except corners come first: delays of smooth joints decide where runs end, and so how much feeds are
  // lowered. Unlowered feeds are the worse case.
  for (std::size_t b = 0; b + 1 < blocks; ++b) {
    if (path.joint[b] == Joint::stop || (rule == DelayRule::exact_stop && !inside_line(path, b))) {
      delays[b] = joints.stop(b);
    } else if (path.joint[b] != Joint::corner && rule == DelayRule::smallest) {
      delays[b] = joints.smooth(b);
    }
    judge(b);
    if (ended()) return result;
  }
  if (rule == DelayRule::smallest) {
    const CommandTiming timing(path, sample_period, delays);
    std::size_t run_last = 0;
    double factor = 1.0;  // D/n of the run of a block
    const auto lowered = [&](std::size_t b) {
      if (b == 0 || b > run_last) {
        run_last = timing.run_end(b);
        const double length = timing.run_length(b, run_last);
        factor = length / static_cast<double>(CommandTiming::run_samples(length));
      }
      return factor;
    };
    double factor_in = 1.0, factor_out = lowered(0);
    for (std::size_t b = 0; b + 1 < blocks; ++b) {
      factor_in = factor_out;
      factor_out = lowered(b + 1);
      if (path.joint[b] != Joint::corner) continue;
      delays[b] = joints.corner(b, factor_in, factor_out);
      judge(b);
      if (ended()) return result;
    }
  }
  std::sort(result.impossible.begin(), result.impossible.end());
  result.limits_possible = result.impossible.empty();
  return result;
}

std::size_t raised_delays(const Toolpath& path, const Filter& filter, double sample_period, const Machine& machine,
                          const std::vector<int>& delays, const std::vector<int>& alone) {
  std::vector<int> found;
  if (alone.empty()) found = pairwise_delays(path, filter, sample_period, machine).delays;
  const std::vector<int>& least = alone.empty() ? found : alone;
  std::size_t raised = 0;
  for (std::size_t b = 0; b < least.size(); ++b) raised += delays[b] > least[b] ? 1 : 0;
  return raised;
}

}  // namespace accdec
