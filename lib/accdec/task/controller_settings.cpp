#include <algorithm>
#include <cmath>

#include <accdec/task.hpp>

namespace accdec {

std::string_view to_string(SettingFamily family) {
  const auto* found = std::find_if(setting_families.begin(), setting_families.end(),
                                   [=](const SettingFamilyName& f) { return f.family == family; });
  return found->name;
}

std::optional<SettingFamily> setting_family_from_string(std::string_view name) {
  for (const SettingFamilyName& f : setting_families) {
    if (f.name == name) return f.family;
  }
  return std::nullopt;
}

std::string_view to_string(DelayKind kind) {
  const auto* found =
      std::find_if(delay_kinds.begin(), delay_kinds.end(), [=](const DelayKindName& k) { return k.kind == kind; });
  return found->name;
}

std::optional<DelayKind> delay_kind_from_string(std::string_view name) {
  for (const DelayKindName& k : delay_kinds) {
    if (k.name == name) return k.kind;
  }
  return std::nullopt;
}

bool ControllerSettings::names_family() const {
  return std::any_of(families.begin(), families.end(), [](SettingFamily f) { return f != SettingFamily::taps; });
}

bool ControllerSettings::names(DelayKind kind) const {
  return std::find(delays.begin(), delays.end(), kind) != delays.end();
}

bool ControlDelays::names(DelayKind kind) const {
  return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
}

double WidthInterval::middle() const {
  return std::isfinite(high) ? 0.5 * (low + high) : 2.0 * low;
}

}  // namespace accdec
