#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <accdec/certificate/checked_tree.hpp>
#include <accdec/certificate/instance_proof.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

constexpr double rounding = 1e-9;  // of a bound that is a sum

/// @throws Rejected if the problem has limits that its rows state otherwise, or its place is none
void require_known(const InstanceProof& r) {
  const Task& task = r.task;
  if (!Response(task.machine, task.sample_period).ideal() || limits_supply(task.machine) ||
      has_mode_of_axis(task.machine) ||
      std::ranges::any_of(task.corners, [](const TaskCorner& c) { return c.contour_max.has_value(); }))
    throw Rejected("refutations know no response, shared supply, contour or mode of an axis");
  const std::size_t corners = task.corners.size();
  if (r.at.delays.size() != corners || r.at.samples.size() != (r.of_delay ? 0 : corners) ||
      r.at.frequencies.size() != task.machine.modes.size())
    throw Rejected("the place has not one delay and sample a corner, or not one list of frequencies a mode");
  if (r.at.order < 0 || r.at.order > 1'000'000) throw Rejected("the place has no order");
  for (std::size_t j = 0; j < corners; ++j) {
    if (r.at.delays[j] < 0 || r.at.delays[j] > 100'000'000) throw Rejected("the place has a delay out of range");
    if (!r.of_delay && (r.at.samples[j] < 0 || r.at.samples[j] > r.at.order + r.at.delays[j] + 1))
      throw Rejected("the place has a sample that no blend has");
  }
  for (std::size_t m = 0; m < task.machine.modes.size(); ++m) {
    const Mode& mode = task.machine.modes[m];
    const auto outside = [&](double f) { return !(f >= mode.frequency_low && f <= mode.frequency_high); };
    if (std::ranges::any_of(r.at.frequencies[m], outside))
      throw Rejected("the place bounds a mode at a frequency outside its band");
  }
}

/// The task of the one order and these delays, without a corner's tolerance of zero. A mode is bounded at the problem's
/// frequencies and the ends of its damping only.
Task narrowed(const InstanceProof& r) {
  Task task = r.task;
  task.design.order_min = task.design.order_max = r.at.order;
  task.settings.reset();
  task.filter.reset();
  for (std::size_t j = 0; j < task.corners.size(); ++j) {
    TaskCorner& corner = task.corners[j];
    corner.delay = r.at.delays[j];
    if (corner.error_max == 0.0) corner.error_max.reset();
  }
  task.machine.modes.clear();
  for (std::size_t m = 0; m < r.task.machine.modes.size(); ++m) {
    Mode one = r.task.machine.modes[m];
    const std::set<double> ratios{one.damping_low, one.damping_high};
    for (const double f : r.at.frequencies[m]) {
      for (const double ratio : ratios) {
        one.frequency_low = one.frequency_high = f;
        one.damping_low = one.damping_high = ratio;
        task.machine.modes.push_back(one);
      }
    }
  }
  return task;
}

/// @throws Rejected for a certificate that is about more than limits of the narrowed task
const proof::BranchAndBound& tree_of(const InstanceProof& r, const Certificate& certificate) {
  const auto* proof = std::get_if<proof::BranchAndBound>(&certificate.proof);
  if (proof == nullptr) throw Rejected("a refutation needs a certificate with a tree");
  proof::BranchAndBound plain, bare = *proof;
  plain.objective = r.task.design.objective;
  if (plain.objective == Objective::cycle) plain.runs = r.task.design.runs;
  bare.multipliers.clear(), bare.tree.clear();
  if (!(bare == plain))
    throw Rejected("the certificate of a refutation has a bound, lemmas, merged corners or another objective");
  return *proof;
}

/// The corner that a part is about; its delay undercuts what is claimed.
const TaskCorner& corner_of(const InstanceProof& r, const InstanceProof::Part& part) {
  if (*part.corner < 0 || *part.corner >= static_cast<int>(r.task.corners.size()))
    throw Rejected("a part is about a corner that is not there");
  const TaskCorner& corner = r.task.corners[static_cast<std::size_t>(*part.corner)];
  if (!(corner.error_max.value_or(0.0) > 0.0)) throw Rejected("a part is about a corner without a tolerance");
  if (!(part.delay >= 0.0 && part.delay <= 1e8)) throw Rejected("a part has a delay out of range");
  return corner;
}

/// Whether the delays that a part refutes are all that its corner may have.
bool leaves_none(const InstanceProof& r, const InstanceProof::Part& part) {
  const std::optional<int> given = corner_of(r, part).delay;
  // From a delay of N + 1 on the path passes every corner itself.
  return part.delay >= r.at.order + 1.0 || (given && *given <= part.delay);
}

/// @throws Rejected if the parts, once proved, do not prove the bound
void require_claim(const InstanceProof& r) {
  if (r.parts.empty()) throw Rejected("a refutation has no parts");
  if (r.lower && !(*r.lower > 0.0 && *r.lower <= 1e300)) throw Rejected("the bound is not above zero");
  const bool summed = r.of_delay && r.parts.front().corner;
  if (!summed) {
    if (r.parts.size() > 1 || r.parts.front().corner || (r.of_delay && r.lower))
      throw Rejected("the parts are not those of such a bound");
    return;
  }
  double sum = 0.0;
  bool none = false;
  std::set<int> seen;
  for (const InstanceProof::Part& part : r.parts) {
    if (!part.corner || !seen.insert(*part.corner).second) throw Rejected("the parts are not one a corner");
    const TaskCorner& corner = corner_of(r, part);
    none |= leaves_none(r, part);
    if (!corner.delay) sum += corner.weight * part.delay;
  }
  if (!r.lower && !none) throw Rejected("a corner may have more than the delays that are refuted");
  if (r.lower && !(*r.lower <= sum * (1.0 + rounding)))
    throw Rejected(fmt::format("the delays refuted are a bound of {:.9g}, {:.9g} is claimed", sum, *r.lower));
}

std::size_t check_part(const InstanceProof& r, const InstanceProof::Part& part, const std::function<bool()>& stop) {
  Task task = narrowed(r);
  CheckedWhole whole;
  whole.samples = r.at.samples;
  for (std::size_t j = 0; j < task.corners.size(); ++j) {
    std::optional<double>& tolerance = task.corners[j].error_max;
    if (r.of_delay ? part.corner != static_cast<int>(j) : !r.lower) tolerance.reset();
    if (tolerance && !r.of_delay) *tolerance *= std::sqrt(*r.lower);
  }
  if (part.corner) whole.instants = CheckedInstants{*part.corner, part.delay, 0.0, 2.0 * (r.at.order + 1)};
  return check_tree(granted_limits(task), tree_of(r, part.certificate), whole, stop);
}

std::string claim_of(const InstanceProof& r) {
  std::string text =
      fmt::format("of order {} with limits on the blends at delay {}", r.at.order, fmt::join(r.at.delays, ", "));
  for (const InstanceProof::Part& part : r.parts) {
    if (r.lower || !part.corner || !leaves_none(r, part)) continue;
    const TaskCorner& corner = corner_of(r, part);
    return fmt::format("no filter {} passes corner {} within its tolerance {}", text, corner.name,
                       corner.delay ? fmt::format("at its given delay {}", *corner.delay) : "at any delay");
  }
  if (!r.lower) return "no filter " + text + " holds all limits";
  if (r.of_delay) return fmt::format("filters {} need weighted delays of more than {:.9g} samples", text, *r.lower);
  return fmt::format("no filter {} has a sigma of {:.9g} or less at sample {}", text, *r.lower,
                     fmt::join(r.at.samples, ", "));
}

}  // namespace

CheckReport check_instance_proof(const InstanceProof& refutation, const std::function<bool()>& stop) {
  try {
    require_known(refutation);
    require_claim(refutation);
    std::size_t leaves = 0;
    for (const InstanceProof::Part& part : refutation.parts) leaves += check_part(refutation, part, stop);
    return {true, fmt::format("{} parts refuted: {}", leaves, claim_of(refutation))};
  } catch (const Rejected& e) {
    return {false, e.what()};
  }
}

}  // namespace accdec
