#include <stdexcept>

#include <fmt/format.h>

#include <accdec/design/quantise.hpp>
#include <accdec/formats/export/exported_c.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/machine/response.hpp>
#include <accdec/verify.hpp>

namespace accdec {
namespace {

/// Whole taps, and how they came about.
struct WholeTaps {
  Coefficients coefficients;
  const char* origin;
};

/// Free taps at their limits have no room for a rounding. Other ones of this order and these delays mostly have it.
std::optional<Coefficients> designed_whole(Task task, int order, const std::vector<int>& delays, int bits) {
  const bool family = task.settings && task.settings->names_family();
  const bool free = !task.filter && !family && !limits_supply(task.machine);
  if (!free || !Response(task.machine, task.sample_period).ideal()) return std::nullopt;
  task.settings.reset();  // the delays are given
  task.design.coefficient_bits = bits;
  task.design.order_min = task.design.order_max = order;
  for (std::size_t j = 0; j < delays.size(); ++j) task.corners[j].delay = delays[j];
  DesignOptions options;
  options.time_limit = 10.0;
  const DesignResult whole = design_task(task, options);
  return whole.has_design() ? std::optional(whole.quantisation->coefficients) : std::nullopt;
}

std::vector<int> delays_of(const DesignResult& result) {
  std::vector<int> delays;
  for (const CornerResult& corner : result.corners) delays.push_back(corner.delay);
  return delays;
}

/// Taps that are no multiples of 2^-bits, made whole: only if all limits can be checked, and hold.
WholeTaps made_whole(const ExportedDesign& design, int bits) {
  const DesignResult& result = design.result;
  const auto refuse = [&](std::string_view why) {
    throw std::invalid_argument(fmt::format(
        "these taps are no whole numbers over 2^{0}, and {1}; write `coefficient_bits = {0}` below [design] in the "
        "task, run accdec design TASK --json RESULT, and export that result",
        bits, why));
  };
  if (result.task.corners.empty() || result.task.corners.size() != result.corners.size())
    refuse("the limits of a program cannot be checked here");
  if (!result.has_design()) refuse("the result does not hold all limits");
  if (std::any_of(result.corners.begin(), result.corners.end(), [](const auto& c) { return c.feed_part < 1.0; }))
    refuse("limits of corners at a part of the feed cannot be checked here");
  const std::vector<int> delays = delays_of(result);
  // A minute of exchanges is more than a user waits for a file.
  long left = 20'000;
  const auto rounded = round_under_limits(result.task, design.filter, delays, bits, [&] { return --left < 0; });
  if (rounded)
    return {*rounded, "Rounded by this export, not by the design; all limits were verified with these taps."};
  const auto designed = designed_whole(result.task, design.filter.order(), delays, bits);
  if (!designed) refuse("no whole numbers were found that hold all limits at these delays");
  return {*designed,
          "Designed again by this export, as rounding broke a limit: the same order and delays, other taps; all limits "
          "were verified with these."};
}

std::string fixed_point(const ExportedDesign& given, int bits) {
  const auto exact = exact_coefficients(given.filter, bits);
  const WholeTaps whole = exact ? WholeTaps{*exact, "The design's own taps, exactly."} : made_whole(given, bits);
  const Coefficients& c = whole.coefficients;
  // The head names the limits as the taps below it use them.
  DesignResult result = given.result;
  if (!exact) result.limits = assess(result.task, filter_of_coefficients(c), delays_of(result), false).limits;
  const ExportedDesign design = exported_design(result);
  for (const std::int64_t unit : c) {
    if (unit >= std::int64_t{1} << bits)
      throw std::invalid_argument(
          fmt::format("a filter of a single tap 1 has no Q{0} form, whose largest is 1 - 2^-{0}", bits));
  }
  std::string text = c_head(design, fmt::format("ACCDEC_TAPS_Q{}_H", bits),
                            fmt::format("Acc/Dec filter designed by accdec: v_out[k] = sum_i accdec_taps_q{0}[i] * "
                                        "v_in[k - i] / 2^{0}; the taps sum to 2^{0}.",
                                        bits));
  text += fmt::format("/* {} */\n", whole.origin);
  text += fmt::format("#include <stdint.h>\n\nstatic const int{}_t accdec_taps_q{}[ACCDEC_ORDER + 1] = {{\n", bits + 1,
                      bits);
  for (std::size_t i = 0; i < c.size(); ++i) text += fmt::format("    {}{}\n", c[i], i + 1 == c.size() ? "" : ",");
  return text + "};\n\n" + c_tail(design);
}

}  // namespace

std::string q15_export(const ExportedDesign& design) {
  return fixed_point(design, 15);
}
std::string q31_export(const ExportedDesign& design) {
  return fixed_point(design, 31);
}

}  // namespace accdec
