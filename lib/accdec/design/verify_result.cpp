#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <accdec/certificate.hpp>
#include <accdec/design/design_settings.hpp>
#include <accdec/design/verify_settings.hpp>
#include <accdec/design/verify_today.hpp>
#include <accdec/machine/limit_unit.hpp>
#include <accdec/task/check_delays.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

constexpr double tolerance = 1e-9;

/// Parts of the feed at which the corners are passed.
std::vector<double> feed_parts(const DesignResult& result) {
  std::vector<double> parts;
  for (const CornerResult& corner : result.corners) parts.push_back(corner.feed_part);
  return parts;
}

class Comparison {
 public:
  explicit Comparison(std::vector<std::string>& reasons) : reasons_(reasons) {}
  void number(const std::string& what, double recorded, double found, double floor) {
    if (recorded == found) return;  // covers infinities too
    if (!(std::abs(recorded - found) <= tolerance * std::abs(found) + floor)) {
      reasons_.push_back(fmt::format("{} is recorded as {:.12g}, found {:.12g}", what, recorded, found));
    }
  }

 private:
  std::vector<std::string>& reasons_;
};

/// Units of task files are rounded: not every bound in SI corresponds to a number in a file.
bool same_bound(double a, double b) {
  return std::abs(a - b) <= 1e-15 * std::abs(b);
}

bool same_limit(const LimitUse& a, const LimitUse& b) {
  return a.kind == b.kind && a.axis == b.axis && a.corner == b.corner && same_bound(a.bound, b.bound);
}

/// The taps must be those that a control with whole coefficients has, to the last bit.
void compare_coefficients(const DesignResult& result, std::vector<std::string>& reasons) {
  const int bits = result.task.design.coefficient_bits;
  const auto& recorded = result.quantisation;
  if (bits == 0 || result.task.filter) {
    if (recorded) reasons.push_back("coefficients are recorded, for which the task does not ask");
    return;
  }
  std::vector<double> taps;
  for (const double tap : result.filter->taps()) taps.push_back(std::ldexp(tap, bits));
  if (std::any_of(taps.begin(), taps.end(), [](double tap) { return tap != std::floor(tap); }))
    reasons.push_back(fmt::format("the taps are no whole numbers over 2^{}, for which the task asks", bits));
  if (!recorded || recorded->bits != bits ||
      !std::equal(taps.begin(), taps.end(), recorded->coefficients.begin(), recorded->coefficients.end(),
                  [](double tap, std::int64_t c) { return tap == static_cast<double>(c); }))
    reasons.push_back("quantisation: the coefficients recorded are not those of the taps");
  else if (!(recorded->unquantised > 0.0 && recorded->unquantised <= result.objective() * (1.0 + tolerance)))
    reasons.push_back("quantisation.unquantised_s must be above 0 and at most the time of the design");
}

void compare_choice(const DesignResult& result, std::vector<std::string>& reasons) {
  const Task& task = result.task;
  const Filter& filter = *result.filter;
  if (task.filter) {
    const Filter given = make_filter(*task.filter);
    bool same = given.order() == filter.order();
    for (int i = 0; same && i <= given.order(); ++i) same = std::abs(given.tap(i) - filter.tap(i)) <= 1e-12;
    if (!same) reasons.push_back("the taps are not those of the task's filter");
  } else {
    if (filter.order() < task.design.order_min || filter.order() > task.design.order_max) {
      reasons.push_back(fmt::format("order {} is outside the task's {} to {}", filter.order(), task.design.order_min,
                                    task.design.order_max));
    }
    for (int i = 0; task.design.symmetric && i <= filter.order(); ++i) {
      if (std::abs(filter.tap(i) - filter.tap(filter.order() - i)) <= 1e-9) continue;
      reasons.push_back(fmt::format("the task asks for symmetric taps, b_{} and b_{} differ", i, filter.order() - i));
      break;
    }
  }
  compare_coefficients(result, reasons);
  for (std::size_t j = 0; j < task.corners.size(); ++j) {
    if (task.corners[j].delay && *task.corners[j].delay != result.corners[j].delay) {
      reasons.push_back(fmt::format("corner {}: the task gives delay {}, the result has {}", task.corners[j].name,
                                    *task.corners[j].delay, result.corners[j].delay));
    }
  }
}

/// Rounding of the measures of a limit that are close to zero.
double floor_of(const LimitUse& use) {
  const bool of_distance =
      use.kind == LimitKind::corner_error || use.kind == LimitKind::contour || use.kind == LimitKind::residual;
  return of_distance ? position_floor : 1e-12;
}

/// Whether a frequency is in a band of the task with this bound.
bool in_band(const Task& task, const LimitUse& use) {
  return std::any_of(task.machine.modes.begin(), task.machine.modes.end(), [&](const Mode& mode) {
    const double bound = mode.of_axis() ? mode.displacement_max : mode.residual_max;
    if (mode.of_axis() && task.machine.axes[static_cast<std::size_t>(mode.axis)].name != use.axis) return false;
    return mode.of_axis() == (use.kind == LimitKind::residual) && same_bound(use.bound, bound) &&
           use.frequency >= mode.frequency_low && use.frequency <= mode.frequency_high &&
           use.damping >= mode.damping_low && use.damping <= mode.damping_high;
  });
}

/// Whether a limit is recorded at a place of its kind. Vibration has a frequency, all others have a sample. Corner
/// errors and speeds belong to the blend, limits of axes to any event.
bool names_a_place(const Task& task, const LimitUse& use, const LimitUse& found) {
  if (use.kind == LimitKind::vibration)
    return use.sample == found.sample && use.event == found.event && in_band(task, use);
  if (use.kind == LimitKind::residual)
    return use.event != Event::none && (use.event != found.event || use.sample == found.sample) && in_band(task, use);
  const bool of_the_blend =
      use.kind == LimitKind::corner_error || use.kind == LimitKind::speed_min || use.kind == LimitKind::contour;
  return use.frequency == found.frequency && use.damping == found.damping &&
         (!of_the_blend || use.event == found.event);
}

/// Compares a recorded limit with the one found now. Only the value counts: its place may differ among samples with the
/// same value up to rounding.
void compare_limit(const DesignResult& recorded, std::size_t i, const LimitUse& found,
                   std::vector<std::string>& reasons) {
  Comparison compare(reasons);
  const LimitUse& use = recorded.limits[i];
  if (const std::string then = unit_of_before(found.kind, found.axis, use.bound, found.bound);
      !then.empty() && use.kind == found.kind && use.axis == found.axis) {
    if (std::ranges::find(reasons, then) == reasons.end()) reasons.push_back(then);
    return;
  }
  if (!same_limit(use, found)) {
    reasons.push_back(fmt::format("limits[{}] should be the {} limit{}{} of the task", i, to_string(found.kind),
                                  found.axis.empty() ? "" : " of axis ", found.axis));
    return;
  }
  const double floor = floor_of(found);
  compare.number("value of " + describe(found), use.value, found.value, floor);
  compare.number("utilisation of " + describe(found), use.utilisation, found.utilisation,
                 found.bound > 0.0 ? floor / found.bound : 0.0);
  if (use.sample == found.sample && use.event == found.event && use.frequency == found.frequency &&
      use.damping == found.damping) {
    return;
  }
  std::vector<int> delays;
  for (const CornerResult& corner : recorded.corners) delays.push_back(corner.delay);
  const std::vector<double> parts = feed_parts(recorded);
  if (!names_a_place(recorded.task, use, found)) {
    reasons.push_back(
        fmt::format("limits[{}] names an event, a sample or a frequency at which no {} is measured, found: {}", i,
                    to_string(use.kind), describe(found)));
    return;
  }
  const double there = std::max(0.0, value_where(recorded.task, *recorded.filter, delays, use, parts));
  if (std::abs(there - found.value) <= tolerance * std::abs(found.value) + floor) return;
  reasons.push_back(
      of_mode(use.kind)
          ? fmt::format("limits[{}] is recorded at {:.12g} Hz, found: {}", i, use.frequency, describe(found))
          : fmt::format("limits[{}] is recorded at k = {} of the {}, where it is not used most, found: {}", i,
                        use.sample, to_string(use.event), describe(found)));
}

/// The worst limit in words; any of several that are equal up to rounding.
void compare_worst(const DesignResult& recorded, const DesignResult& found, std::vector<std::string>& reasons) {
  const std::string& worst = recorded.verification.worst;
  // Earlier builds called a torque a force.
  const auto same = [&](const std::string& text) {
    return worst == text || (text.starts_with("torque") && worst == "force" + text.substr(6));
  };
  if (same(found.verification.worst)) return;
  double most = 0.0;
  for (const LimitUse& use : found.limits) most = std::max(most, use.utilisation);
  for (std::size_t i = 0; i < recorded.limits.size() && i < found.limits.size(); ++i) {
    const double floor = found.limits[i].bound > 0.0 ? floor_of(found.limits[i]) / found.limits[i].bound : 0.0;
    const bool as_worst = found.limits[i].utilisation >= most * (1.0 - tolerance) - floor;
    if (as_worst && same(describe(recorded.limits[i]))) return;
  }
  reasons.push_back(
      fmt::format("verification.worst is recorded as \"{}\", found: {}", worst, found.verification.worst));
}

void compare_numbers(const DesignResult& recorded, const DesignResult& found, std::vector<std::string>& reasons) {
  Comparison compare(reasons);
  compare.number("cycle_time_s", recorded.cycle_time, found.cycle_time, 0.0);
  compare.number("corner_time_s", recorded.corner_time, found.corner_time, 0.0);
  if (recorded.verification.performed != found.verification.performed)
    reasons.push_back("verification.performed is recorded wrongly");
  if (recorded.verification.feasible != found.verification.feasible)
    reasons.push_back("verification.feasible is recorded wrongly");
  compare.number("verification.tolerance", recorded.verification.tolerance, found.verification.tolerance, 0.0);
  compare_worst(recorded, found, reasons);
  compare.number("verification.max_violation", recorded.verification.max_violation, found.verification.max_violation,
                 1e-12);
  for (std::size_t j = 0; j < found.corners.size(); ++j) {
    const CornerResult &a = recorded.corners[j], &b = found.corners[j];
    const auto named = [&](const char* what) { return fmt::format("corner {}: {}", b.name, what); };
    compare.number(named("corner_error_m"), a.corner_error, b.corner_error, position_floor);
    compare.number(named("polyline_error_m"), a.polyline_error, b.polyline_error, position_floor);
    compare.number(named("contour_deviation_m"), a.contour_deviation, b.contour_deviation, position_floor);
    compare.number(named("speed_min_m_s"), a.speed_min, b.speed_min, 1e-12);
    compare.number(named("corner_time_s"), a.corner_time, b.corner_time, 0.0);
    compare.number(named("settling_time_s"), a.settling_time, b.settling_time, 0.0);
  }
  if (recorded.limits.size() != found.limits.size()) {
    reasons.push_back(
        fmt::format("{} limits are recorded, the task has {}", recorded.limits.size(), found.limits.size()));
  }
  // Both lists are in the order of the task: nothing else distinguishes modes with equal bounds.
  for (std::size_t i = 0; i < found.limits.size() && i < recorded.limits.size(); ++i)
    compare_limit(recorded, i, found.limits[i], reasons);
}

/// An infeasible result must not carry these members: they would have no meaning.
void check_nothing_besides(const DesignResult& result, std::vector<std::string>& reasons) {
  const auto refuse = [&](bool there, const char* what) {
    if (there) reasons.push_back(fmt::format("the result is infeasible, but records {}", what));
  };
  refuse(result.lower_bound.has_value(), "a lower bound");
  refuse(result.gap.has_value(), "a gap");
  refuse(result.filter.has_value(), "a filter");
  refuse(result.settings || result.family_bound || result.free_taps, "settings");
  refuse(!result.corners.empty(), "corners");
  refuse(!result.limits.empty(), "limits");
  refuse(result.cycle_time != 0.0 || result.corner_time != 0.0, "a time");
  refuse(result.stop != StopReason::finished, "that the search was stopped");
  const VerificationReport& v = result.verification;
  refuse(v.performed || v.feasible, "a verified design");
  refuse(v.max_violation != 0.0 || v.tolerance != 0.0 || !v.worst.empty(), "what a simulation found");
}

/// The recorded check of the certificate must agree with the check made now.
void check_certificate_words(const DesignResult& result, ResultCheck& report) {
  const VerificationReport& v = result.verification;
  if (v.certificate_checked && !result.certificate)
    report.reasons.push_back("verification.certificate_checked is recorded without a certificate");
  else if (v.certificate_checked && v.certificate.empty())
    report.reasons.push_back("verification.certificate_checked is recorded without what the check found");
  if (!v.certificate_checked && !v.certificate.empty())
    report.reasons.push_back("verification.certificate is recorded of a certificate that was not checked");
  if (!v.certificate.empty() && v.certificate != report.proof)
    report.reasons.push_back(
        fmt::format("verification.certificate is recorded as \"{}\", found: {}", v.certificate, report.proof));
}

/// @return whether the result claims that there is no design, which is then all that is checked
bool check_infeasible(const DesignResult& result, ResultCheck& report, const std::function<bool()>& stop) {
  if (result.status != Status::infeasible || (!result.certificate && !result.task.filter)) return false;
  // A certificate may also say that no filter at all holds the limits.
  const bool enumerated = result.task.filter && (!result.certificate ||
                                                 std::holds_alternative<proof::Enumeration>(result.certificate->proof));
  if (enumerated) {
    report.proof = "every delay of the given filter breaks a limit";
    if (const std::string reason = check_no_delays(result.task, make_filter(*result.task.filter), stop);
        !reason.empty())
      report.reasons.push_back("claims infeasible: " + reason);
  } else {
    const CheckReport check = check_certificate(result.task, result, stop);
    report.proof = check.reason;
    if (!check.accepted) report.reasons.push_back("the certificate does not hold: " + check.reason);
  }
  check_nothing_besides(result, report.reasons);
  return true;
}

/// Status, stop, lower bound and gap must agree: `optimal` means a gap of 0 and a finished search.
void check_claims(const DesignResult& result, std::vector<std::string>& reasons) {
  const auto reject = [&](std::string reason) { reasons.push_back(std::move(reason)); };
  const bool optimal = result.status == Status::optimal;
  const bool of_family = result.settings && result.settings->family != SettingFamily::taps;
  if (result.gap && !result.lower_bound) reject("a gap is recorded without a lower bound");
  if (result.lower_bound && !result.gap) reject("a lower bound is recorded without a gap");
  if (optimal && result.stop != StopReason::finished)
    reject(fmt::format("claims optimal, but records that the search was stopped: {}", to_string(result.stop)));
  if (result.stop == StopReason::gap_reached && !result.gap) reject("records that a gap was reached, but no gap");
  if (result.lower_bound) {
    const double gap = (result.objective() - *result.lower_bound) / result.objective();
    if (*result.lower_bound < 0.0) reject("the lower bound is negative");
    if (gap < -tolerance) reject("the lower bound exceeds the cycle time");
    if (result.gap && std::abs(*result.gap - gap) > tolerance)
      reject(fmt::format("gap is recorded as {:.12g}, found {:.12g}", *result.gap, gap));
    if (optimal && !of_family && gap > tolerance) reject("claims optimal with a lower bound below the cycle time");
    // Slightly less, as the design and this recheck round differently.
    if (!optimal && gap < tolerance * (1.0 - 1e-6))
      reject("the status is feasible, but the lower bound is the cycle time: that is optimal");
  }
  if (optimal && of_family && !result.family_bound) reject("claims optimal without a bound of the family");
  if (!optimal && result.family_bound) reject("records a bound of the family, but not that the settings are optimal");
  if (!result.certificate) {
    if (optimal) reject("claims optimal without a certificate");
    if (!optimal && result.lower_bound) reject("records a lower bound without a certificate");
  } else if (!result.lower_bound && !of_family) {
    reject("a certificate is recorded without a lower bound");
  }
}

/// The bound in the certificate must be the recorded one. For a given filter it proves that the delays are the
/// smallest.
void check_bound_of_certificate(const DesignResult& result, std::vector<std::string>& reasons) {
  if (result.task.filter && result.status != Status::optimal)
    reasons.push_back("the certificate proves the delays to be the smallest, but the status is feasible");
  const auto* proof = std::get_if<proof::BranchAndBound>(&result.certificate->proof);
  if (proof == nullptr || !proof->bound_samples || !result.lower_bound) return;
  const double proved = *proof->bound_samples * result.task.sample_period;
  if (*result.lower_bound < proved * (1.0 - tolerance))
    reasons.push_back(fmt::format("the lower bound is recorded as {:.12g} s, the certificate proves {:.12g} s",
                                  *result.lower_bound, proved));
}

void check_proof(const DesignResult& result, ResultCheck& report, const std::function<bool()>& stop) {
  const auto reject = [&](std::string reason) { report.reasons.push_back(std::move(reason)); };
  check_claims(result, report.reasons);
  if (!result.certificate) return;
  check_bound_of_certificate(result, report.reasons);
  if (!result.task.filter) {
    const CheckReport check = check_certificate(result.task, result, stop);
    if (!check.accepted) reject("the certificate does not hold: " + check.reason);
    report.proof = check.reason;
    return;
  }
  if (!std::holds_alternative<proof::Enumeration>(result.certificate->proof))
    reject("the task gives the filter, but the certificate is not about its delays");
  std::vector<int> delays;
  for (const CornerResult& corner : result.corners) delays.push_back(corner.delay);
  if (const std::string reason = check_smallest_delays(result.task, *result.filter, delays, stop); !reason.empty())
    reject(reason);
  report.proof = "every smaller delay breaks a limit";
}

/// The time with today's filter is found again. The parts come from a table that is not recorded: their sum is checked.
void check_savings(const DesignResult& result, std::vector<std::string>& reasons) {
  check_savings_recorded(result, reasons);
  if (!result.savings) return;
  const Savings& saved = *result.savings;
  if (!result.task.baseline) return reasons.push_back("savings are recorded, the task names no filter of today");
  DesignResult again;
  again.task = result.task, again.cycle_time = result.cycle_time, again.corner_time = result.corner_time;
  compare_with_today(again);
  if (!again.savings) return reasons.push_back("savings are recorded, but today's filter breaks a limit");
  const double floor = tolerance * again.savings->today;
  Comparison compare(reasons);
  compare.number("savings.today_s", saved.today, again.savings->today, 0.0);
  compare.number("savings.total_s", saved.total, again.savings->total, floor);
  check_time_of_today(result.task, saved.today, reasons);
  if (result.settings && (saved.by_retuning || saved.by_family || saved.by_taps))
    reasons.push_back("savings of settings have no parts");
  if (saved.by_family && saved.by_taps)
    compare.number("savings, the sum of the parts", saved.by_retuning.value_or(0.0) + *saved.by_family + *saved.by_taps,
                   again.savings->total, floor);
}

}  // namespace

ResultCheck verify_result(const DesignResult& result, const std::function<bool()>& stop) {
  ResultCheck report;
  if (check_infeasible(result, report, stop)) {
    check_certificate_words(result, report);
    report.accepted = report.reasons.empty();
    return report;
  }
  if (!result.has_design()) {
    report.reasons.push_back(fmt::format("the result is {}: there is no design to verify", to_string(result.status)));
    return report;
  }
  if (!result.filter || result.corners.size() != result.task.corners.size()) {
    report.reasons.push_back("the result has no filter, or not as many corners as its task");
    return report;
  }
  std::vector<int> delays;
  for (const CornerResult& corner : result.corners) {
    if (corner.delay < 0) {
      report.reasons.push_back(fmt::format("corner {}: delay {} is negative", corner.name, corner.delay));
      return report;
    }
    if (!(corner.feed_part > 0.0 && corner.feed_part <= 1.0)) {
      report.reasons.push_back(fmt::format("corner {}: {} is no part of the feed", corner.name, corner.feed_part));
      return report;
    }
    delays.push_back(corner.delay);
  }
  const DesignResult found = assess(result.task, *result.filter, delays, true, feed_parts(result));
  report.verification = found.verification;
  if (!found.verification.feasible) report.reasons.push_back("a limit is broken: " + found.verification.worst);
  compare_choice(result, report.reasons);
  compare_settings(result, report.reasons);
  compare_numbers(result, found, report.reasons);
  check_savings(result, report.reasons);
  check_proof(result, report, stop);
  check_certificate_words(result, report);
  report.accepted = report.reasons.empty();
  return report;
}

}  // namespace accdec
