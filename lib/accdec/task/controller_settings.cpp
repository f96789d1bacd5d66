#include <algorithm>
#include <cmath>

#include <accdec/files/words.hpp>
#include <accdec/task.hpp>

namespace accdec {

std::string_view to_string(SettingFamily family) {
  return word_of(setting_families, family);
}

std::optional<SettingFamily> setting_family_from_string(std::string_view name) {
  return value_of<SettingFamily>(setting_families, name);
}

std::string_view to_string(DelayKind kind) {
  return word_of(delay_kinds, kind);
}

std::optional<DelayKind> delay_kind_from_string(std::string_view name) {
  return value_of<DelayKind>(delay_kinds, name);
}

bool ControllerSettings::names_family() const {
  return std::any_of(families.begin(), families.end(), [](SettingFamily f) { return f != SettingFamily::taps; });
}

bool ControllerSettings::names(SettingFamily family) const {
  return std::find(families.begin(), families.end(), family) != families.end();
}

bool ControllerSettings::names(DelayKind kind) const {
  return std::find(delays.begin(), delays.end(), kind) != delays.end();
}

bool ControllerSettings::any_delay() const {
  return delays.empty() || names(DelayKind::dwell) || names(DelayKind::timed_axis);
}

bool ControllerSettings::may_be_given(int delay) const {
  if (any_delay()) return true;
  return !names_family() && (names(DelayKind::exact_stop) || delay == 0);
}

std::string_view ControllerSettings::word_of(DelayKind kind) const {
  const auto at = static_cast<std::size_t>(std::find(delays.begin(), delays.end(), kind) - delays.begin());
  return at < delay_words.size() ? std::string_view(delay_words[at]) : std::string_view();
}

double watched_speed(const ControllerSettings& settings, const Corner& corner) {
  return corner.feed_in * (settings.in_position_by_axis ? corner.direction_in.cwiseAbs().maxCoeff() : 1.0);
}

bool ControlDelays::names(DelayKind kind) const {
  return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
}

double WidthInterval::middle() const {
  return std::isfinite(high) ? 0.5 * (low + high) : 2.0 * low;
}

}  // namespace accdec
