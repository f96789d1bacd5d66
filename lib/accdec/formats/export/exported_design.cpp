#include <algorithm>
#include <map>
#include <stdexcept>
#include <tuple>

#include <fmt/format.h>

#include <accdec/formats/export/exported_design.hpp>
#include <accdec/formats/manifest.hpp>
#include <accdec/machine/limit_unit.hpp>
#include <accdec/machine/limits.hpp>
#include <accdec/task/settings_text.hpp>

namespace accdec {
namespace {

/// The worst use of each limit by kind, axis and corner.
using Uses = std::map<std::tuple<LimitKind, std::string, std::string>, double>;

Uses worst_uses(const std::vector<LimitUse>& limits) {
  Uses uses;
  const auto note = [&](LimitKind kind, const std::string& axis, const std::string& corner, double used) {
    const auto [at, fresh] = uses.try_emplace({kind, axis, corner}, used);
    if (!fresh) at->second = std::max(at->second, used);
  };
  for (const LimitUse& use : limits) {
    // The limits of an axis are the same at every corner.
    const bool by_corner =
        use.kind == LimitKind::corner_error || use.kind == LimitKind::speed_min || use.kind == LimitKind::contour;
    if (use.kind != LimitKind::vibration) note(use.kind, use.axis, by_corner ? use.corner : "", use.utilisation);
  }
  return uses;
}

ExportedLimit limit_of(const Uses& uses, LimitKind kind, const std::string& axis, const std::string& corner,
                       double bound) {
  const LimitUnit unit = limit_unit(kind, axis);
  ExportedLimit limit{
      std::string(limit_word(kind, axis)), axis, corner, unit.per_si * bound, std::string(unit.name), {}, {}};
  if (const auto found = uses.find({kind, axis, corner}); found != uses.end()) limit.used = found->second;
  return limit;
}

std::vector<ExportedLimit> limits_of(const DesignResult& result) {
  const Task& task = result.task;
  const Uses uses = worst_uses(result.limits);
  std::vector<ExportedLimit> limits;
  for (const Axis& axis : task.machine.axes) {
    for (const AxisLimit& limit : axis_limits) {
      if (axis.*limit.bound < unlimited) limits.push_back(limit_of(uses, limit.kind, axis.name, "", axis.*limit.bound));
    }
  }
  for (const SupplyLimit& limit : supply_limits) {
    if (task.machine.*limit.bound < unlimited)
      limits.push_back(limit_of(uses, limit.kind, "", "", task.machine.*limit.bound));
  }
  // Vibrations have neither axis nor corner: a result lists them in the order of the task's modes.
  auto vibration = result.limits.begin();
  for (const Mode& mode : task.machine.modes) {
    ExportedLimit limit = mode.of_axis() ? limit_of(uses, LimitKind::residual,
                                                    task.machine.axes[static_cast<std::size_t>(mode.axis)].name, "",
                                                    mode.displacement_max)
                                         : limit_of(uses, LimitKind::vibration, "", "", mode.residual_max);
    limit.frequency.push_back(mode.frequency_low);
    if (mode.frequency_high > mode.frequency_low) limit.frequency.push_back(mode.frequency_high);
    if (mode.damping_high > 0.0) limit.damping.push_back(mode.damping_low);
    if (mode.damping_high > mode.damping_low) limit.damping.push_back(mode.damping_high);
    if (!mode.of_axis())
      vibration = std::find_if(vibration, result.limits.end(),
                               [](const LimitUse& use) { return use.kind == LimitKind::vibration; });
    if (!mode.of_axis() && vibration != result.limits.end()) limit.used = (vibration++)->utilisation;
    limits.push_back(std::move(limit));
  }
  for (const TaskCorner& corner : task.corners) {
    if (corner.error_max) limits.push_back(limit_of(uses, LimitKind::corner_error, "", corner.name, *corner.error_max));
    if (corner.contour_max) limits.push_back(limit_of(uses, LimitKind::contour, "", corner.name, *corner.contour_max));
    if (corner.speed_min > 0.0)
      limits.push_back(limit_of(uses, LimitKind::speed_min, "", corner.name, corner.speed_min));
  }
  if (task.program_error_max)
    limits.push_back(limit_of(uses, LimitKind::corner_error, "", "", *task.program_error_max));
  return limits;
}

/// The code point that begins at `at`, which moves past it; bytes that are no UTF-8 count one by one.
unsigned code_point(std::string_view text, std::size_t& at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(i < text.size() ? text[i] : '\0'); };
  const unsigned first = byte(at++);
  const int more = first >= 0xF0 ? 3 : first >= 0xE0 ? 2 : first >= 0xC0 ? 1 : 0;
  unsigned code = first & (0x7Fu >> (more == 0 ? 0 : more + 1));
  for (int i = 0; i < more; ++i) {
    if ((byte(at + static_cast<std::size_t>(i)) & 0xC0) != 0x80) return first;
    code = code << 6 | (byte(at + static_cast<std::size_t>(i)) & 0x3Fu);
  }
  if (more == 0) return first;
  at += static_cast<std::size_t>(more);
  return code;
}

}  // namespace

std::string ExportedLimit::text() const {
  std::string text = kind;
  if (!axis.empty()) text += " " + axis;
  if (!corner.empty()) text += " of corner " + corner;
  if (!frequency.empty())
    text += frequency.size() == 1 ? fmt::format(" at {:.10g} Hz", frequency.front())
                                  : fmt::format(" from {:.10g} to {:.10g} Hz", frequency.front(), frequency.back());
  if (!damping.empty())
    text += damping.size() == 1 ? fmt::format(", damping {:.10g}", damping.front())
                                : fmt::format(", damping {:.10g} to {:.10g}", damping.front(), damping.back());
  text += fmt::format(" {:.10g} {}", bound, unit);
  if (used) text += fmt::format(", {:.4g} % used", 100.0 * *used);
  return text;
}

std::string ExportedSetting::text() const {
  std::string text = name;
  if (!corner.empty()) text += " of corner " + corner;
  return fmt::format("{} = {}{}{}", text, value, unit.empty() ? "" : " ", unit);
}

std::vector<ExportedSetting> ExportedDesign::settings() const {
  const auto digits = [](double value) { return fmt::format("{:.10g}", value); };
  std::vector<ExportedSetting> all;
  if (result.settings) {
    all.push_back({"family", "", std::string(to_string(result.settings->family)), ""});
    int stage = 0;
    for (const Setting& setting : result.settings->values)
      all.push_back({setting.name.empty() ? fmt::format("stage {}", ++stage) : setting.name, "", digits(setting.value),
                     setting.unit});
    if (result.settings->width)
      all.push_back({"in-position width", "", digits(1e6 * result.settings->width->middle()), "um"});
  }
  const std::vector<DelayKind> kinds = chosen_delay_kinds(result);
  for (std::size_t j = 0; j < kinds.size(); ++j) {
    const CornerResult& corner = result.corners[j];
    all.push_back({"delay", corner.name, std::string(to_string(kinds[j])), ""});
    if (corner.feed_part < 1.0) all.push_back({"feed", corner.name, corner_feed_in_words(result, j), ""});
  }
  return all;
}

std::vector<std::string> ExportedDesign::facts() const {
  std::vector<std::string> all;
  if (!result.task.title.empty()) all.push_back("title: " + result.task.title);
  all.push_back(fmt::format("status: {}", to_string(result.status)));
  if (result.verification.performed && !result.verification.feasible)
    all.push_back("NOT all limits hold: " + result.verification.worst);
  all.push_back(fmt::format("filter: N + 1 = {} taps, sample period {:.10g} ms", filter.order() + 1, 1e3 * period));
  if (result.cycle_time > 0.0) all.push_back(fmt::format("cycle time: {:.10g} ms", 1e3 * result.cycle_time));
  if (result.quantisation)
    all.push_back(fmt::format("taps: whole numbers over 2^{}, free ones take {:.10g} ms", result.quantisation->bits,
                              1e3 * result.quantisation->unquantised));
  for (const ExportedSetting& setting : settings()) all.push_back("set: " + setting.text());
  for (const ExportedLimit& limit : limits) all.push_back("limit: " + limit.text());
  all.push_back("exported by accdec, commit " + commit);
  return all;
}

ExportedDesign exported_design(const DesignResult& result) {
  if (!result.filter)
    throw std::invalid_argument(fmt::format("the result is {} and has no filter to export", to_string(result.status)));
  return {result, *result.filter, result.task.sample_period, limits_of(result), source_commit()};
}

std::string ascii_line(std::string_view text) {
  std::string line;
  for (std::size_t at = 0; at < text.size();) {
    const unsigned code = code_point(text, at);
    if (code >= 0x10000)
      line += fmt::format("\\U{:08x}", code);
    else if (code >= 0x7F)
      line += fmt::format("\\u{:04x}", code);
    else if (code < 0x20)
      line += ' ';
    else if (!line.empty() && (code == '*' || code == '/' || code == '(' || code == ')') &&
             (line.back() == '*' || line.back() == '/' || line.back() == '('))
      (line += ' ') += static_cast<char>(code);
    else
      line += static_cast<char>(code);
  }
  return line;
}

std::string real_literal(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

}  // namespace accdec
